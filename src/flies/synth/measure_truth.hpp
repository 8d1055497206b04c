#pragma once

#include <vector>

#include "flies/synth/ray_scene.hpp"
#include "flies/synth/truth.hpp"

namespace flies::synth {

/// Casts one ray through the centre of every left pixel.
PixelTruth measure_pixels(const RayScene& rays, const StereoCamera& camera, const SceneOptions& options);

/// Measures every obstacle of which a part projects into the left image, nearest first.
std::vector<TruthObject> measure_objects(const RayScene& rays, const StereoCamera& camera, const SceneOptions& options,
                                         const PixelTruth& pixels);

}  // namespace flies::synth
