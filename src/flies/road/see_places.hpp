#pragma once

#include "flies/core/gray_view.hpp"
#include "flies/road/ground_plane.hpp"

namespace flies {

/// Images are halved until they are no wider than this: the ground needs no finer disparities.
inline constexpr int kPlacesWidth_px = 1400;
/// Where five rows of soft ground show too little at that size, they show more at this one.
inline constexpr int kCoarsePlacesWidth_px = 960;

/// Matches a grid over the whole left image along its rows, over all disparities that a ground may have. Where the
/// ground comes near quickly from row to row, neighbourhoods match only when the right image is sheared as the ground
/// is; several shears are tried.
/// @param max_shear largest one, columns per row: the baseline over the height of the lowest camera that is looked for
/// @param max_width_px wider images are halved until they are no wider
SeenPlaces see_places(const RectifiedPair& pair, const StereoCamera& camera, double max_shear,
                      int max_width_px = kPlacesWidth_px);

}  // namespace flies
