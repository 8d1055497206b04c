#pragma once

#include <functional>

#include "flies/concentrate/concentrate_result.hpp"
#include "flies/core/field.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies::detail {

/// What keeps obstacles from being reported where nothing stands.

/// The field that flies live in: the one that is reported, and where its far end lies at a disparity of so few pixels
/// that ranges there are hardly known, as much farther as makes 1.5 px less. What stands behind the far end matches at
/// it otherwise, for want of a better place.
FieldOptions lived_in(const FieldOptions& reported, const StereoCamera& camera);

/// How many flies live in `lived` when `flies` are wanted in `reported`: as many for each piece of the logarithm of the
/// range, in which they are spread evenly, but four times as many at most.
int flies_in(const FieldOptions& lived, const FieldOptions& reported, int flies);

/// Whether the scan sees the ground go on far behind an obstacle that is taller than 1 m, in all directions in which it
/// stands. Before a camera that looks for small things from 0.3 m on, textures of houses and markings that match by
/// chance make such posts a few centimetres wide.
bool is_seen_through(const Obstacle& obstacle, const Scan& scan);

/// Takes obstacles from what was found.
void drop(const std::function<bool(const Obstacle&)>& is_dropped, ConcentrateResult& found);

}  // namespace flies::detail
