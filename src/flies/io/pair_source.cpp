#include "flies/io/pair_source.hpp"

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
  return match_all(left, right).pairs;
}

}  // namespace flies
