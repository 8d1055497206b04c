#pragma once

#include "flies/concentrate/concentrate_result.hpp"
#include "flies/core/field.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies::detail {

/// The field that flies live in: the one that is reported, and where its far end lies at a disparity of so few pixels
/// that ranges there are hardly known, as much farther as makes 1.5 px less. What stands behind the far end matches at
/// it otherwise, for want of a better place.
FieldOptions lived_in(const FieldOptions& reported, const StereoCamera& camera);

/// Takes obstacles beyond the far end from what was found.
void drop_beyond(double x_max_m, ConcentrateResult& found);

}  // namespace flies::detail
