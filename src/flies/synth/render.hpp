#pragma once

#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/synth/image.hpp"
#include "flies/synth/scene.hpp"
#include "flies/synth/scene_options.hpp"
#include "flies/synth/truth.hpp"

namespace flies {

/// A synthetic pair and all that is known about it.
struct RenderedPair {
  ColorImage left, right;
  GrayImage left_gray, right_gray;  ///< the same pictures in grey
  PixelTruth pixels;                ///< of the left image
  std::vector<TruthObject> objects;

  RectifiedPair gray_pair() const { return {left_gray.view(), right_gray.view()}; }
};

/// Renders both images and measures the truth.
/// @param camera  where the images are taken from; needs an image size
/// @param options seed of the noise, quality and the sensor's faults; the scene's own options are not read
/// @throws InputError when the camera or an option is out of range
/// Threads: runs on oneTBB's current arena; results do not depend on the number of threads.
RenderedPair render_pair(const SyntheticScene& scene, const StereoCamera& camera, const SceneOptions& options);

/// The three steps in one: build the scene, take the camera the options describe, render.
RenderedPair render_pair(const SceneOptions& options);

}  // namespace flies
