#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "flies/io/pair_source.hpp"

namespace flies {

/// What makes two images of two folders a pair.
enum class PairBy {
  automatic,  ///< by name where the names speak, else by time, else by number where those of the folders go together
              ///< and tell of lost images, else in order, with a note where numbers differ
  order,      ///< the first with the first, with a note where the names tell of other pairs
  name,       ///< names without extension that are equal, but for what tells the folders apart (`names_without_side`)
  time,       ///< names that tell times (`times_in_names`), nearest to each other
};

/// "auto", "order", "name" or "time". @returns nothing for other words
std::optional<PairBy> pair_by_of(const std::string& word);

struct MatchedPairs {
  std::vector<PairPaths> pairs;         ///< in the order of the left images
  std::vector<std::string> odd;         ///< images without a partner
  std::size_t odd_right = 0;            ///< how many of them are right ones
  std::vector<std::string> notes = {};  ///< sentences on what is doubtful
};

/// As `find_pairs`, but images without a partner are passed over and named. A folder that is given twice is that of
/// both cameras, and split by its names (`sides_in_names`).
/// @throws InputError as `find_pairs` does, when that folder's names do not all tell their side, when names ought to be
///         times and are none, when no two belong together, and when images are to be paired in order and their counts
///         differ
MatchedPairs match_pairs(const std::string& left, const std::string& right, PairBy by);

/// The same, automatic, for those who cannot pass over images. @throws InputError naming images without a partner too
MatchedPairs match_all(const std::string& left, const std::string& right);

}  // namespace flies
