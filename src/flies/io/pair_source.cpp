#include "flies/io/pair_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "flies/core/error.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/pair_matching.hpp"

namespace flies {

std::vector<PairPaths> find_joined_pairs(const std::string& path) {
  if (!detail::is_folder(path)) return {{path, path}};
  std::vector<PairPaths> pairs;
  for (const auto& image : detail::images_of(path)) pairs.push_back({image, image});
  return pairs;
}

std::vector<PairPaths> find_pairs(const std::string& left, const std::string& right) {
  auto found = match_pairs(left, right, PairBy::automatic);
  if (found.odd.empty()) return std::move(found.pairs);
  throw InputError(
      right, "",
      fmt::format("holds {} images, expected {} as in {}: no partner has {}", found.pairs.size() + found.odd_right,
                  found.pairs.size() + found.odd.size() - found.odd_right, left, fmt::join(found.odd, ", ")));
}

}  // namespace flies
