#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/classify/checked_looks.hpp"
#include "flies/classify/classify.hpp"
#include "flies/propose/propose.hpp"

namespace flies {

/// Share of the smaller box that the other one covers.
double covered_share(const ImageBox& a, const ImageBox& b);

/// Those above the threshold, the surest first.
std::vector<std::size_t> surest_first(std::span<const double> probabilities, double threshold);

/// The last word.
struct Verdicts {
  std::vector<Roi> boxes;           ///< those that were proposed, in their order, and finer ones after them
  std::vector<double> of_boxes;     ///< one a box, 0 for those that were not looked at
  std::vector<double> of_places;    ///< in their order
  std::vector<std::size_t> surest;  ///< box of each place
};

/// Of a classifier of one stage, whose first look is its last.
/// @param places   the surest box of each
/// @param screened one a box
Verdicts verdicts_of_one_look(std::span<const Roi> rois, std::span<const std::size_t> places,
                              std::span<const double> screened);

/// The second look, at a few boxes of every place: the surest, the others where that is not hopeless, and where a
/// person seems to be, finer ones between them. A person looks like one in the boxes beside the best one too; what only
/// resembles a person does so in a box or two.
/// @param places          the surest box of each
/// @param screened        by the first look, one a box
/// @param first_threshold that lets boxes through
Verdicts look_again(CheckedLooks& looks, std::span<const Roi> rois, std::span<const std::size_t> places,
                    std::span<const double> screened, double first_threshold, const ClassifyOptions& options);

}  // namespace flies
