#pragma once

#include <algorithm>

#include "tbb/stand_in.hpp"

namespace tbb {

/// Sets how many threads the loops inside it may use.
class task_arena {
 public:
  static constexpr int automatic = -1;

  explicit task_arena(int threads = automatic) : threads_(threads == automatic ? stand_in::kThreads : threads) {}

  template <class Work>
  auto execute(const Work& work) -> decltype(work()) {
    const Allowance allowance(threads_);
    return work();
  }

 private:
  struct Allowance {
    explicit Allowance(int threads) : before(stand_in::allowed_threads()) { stand_in::allowed_threads() = threads; }
    ~Allowance() { stand_in::allowed_threads() = before; }
    int before;
  };

  int threads_;
};

namespace this_task_arena {

inline int max_concurrency() { return std::max(1, stand_in::allowed_threads()); }

/// Nobody here takes up a task of others while waiting.
template <class Work>
auto isolate(const Work& work) -> decltype(work()) {
  return work();
}

}  // namespace this_task_arena

}  // namespace tbb
