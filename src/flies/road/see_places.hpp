#pragma once

#include "flies/core/gray_view.hpp"
#include "flies/road/ground_plane.hpp"

namespace flies {

/// Matches a grid over the whole left image along its rows, over all disparities that a ground may have. Where the
/// ground comes near quickly from row to row, neighbourhoods match only when the right image is sheared as the ground
/// is; several shears are tried.
/// @param max_shear largest one, columns per row: the baseline over the height of the lowest camera that is looked for
SeenPlaces see_places(const RectifiedPair& pair, const StereoCamera& camera, double max_shear);

}  // namespace flies
