#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace flies {

/// Union-find over the indices 0 .. count - 1.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    // The lower index leads, so that groups come out in order of their first member.
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

  std::size_t find(std::size_t i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }

  /// The members of every set, ascending; sets in order of their first member.
  std::vector<std::vector<std::size_t>> groups() const {
    std::vector<std::vector<std::size_t>> by_root(parent_.size()), result;
    for (std::size_t i = 0; i < parent_.size(); ++i) by_root[find(i)].push_back(i);
    for (auto& group : by_root)
      if (!group.empty()) result.push_back(std::move(group));
    return result;
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace flies
