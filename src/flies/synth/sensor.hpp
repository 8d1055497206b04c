#pragma once

#include <cstddef>
#include <vector>

#include "flies/synth/image.hpp"
#include "flies/synth/scene.hpp"
#include "flies/synth/scene_options.hpp"

namespace flies::synth {

/// Light that falls on the sensor, linear colour per pixel, row-major.
struct LinearImage {
  int width_px = 0;
  int height_px = 0;
  std::vector<Vec3> pixels;

  Vec3& at(int u, int v) { return pixels[index(u, v)]; }
  const Vec3& at(int u, int v) const { return pixels[index(u, v)]; }

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u);
  }
};

/// What the camera makes of the light: lens blur, exposure for the scene's lighting, tone curve, gain, noise and
/// rounding to 8 bits. Noise is the same in all three channels, so the grey image has exactly `noise_gray` of it.
ColorImage expose(const LinearImage& light, const Lighting& lighting, const SceneOptions& options, bool is_right);

}  // namespace flies::synth
