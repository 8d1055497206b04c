#include "flies/synth/render.hpp"

#include <tbb/parallel_for.h>

#include <numbers>

#include "flies/synth/measure_truth.hpp"
#include "flies/synth/ray_scene.hpp"
#include "flies/synth/sensor.hpp"
#include "flies/synth/shade.hpp"

namespace flies {
namespace {

using synth::Vec3;

synth::LinearImage trace(const synth::RayScene& rays, const synth::PixelRays& pixel_rays, const StereoCamera& camera,
                         int samples_per_side) {
  synth::LinearImage image{camera.width_px, camera.height_px, {}};
  image.pixels.resize(static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px));
  const synth::Shader shader(rays, static_cast<float>(1.0 / camera.fx_px), samples_per_side);
  const float step = 1.0F / static_cast<float>(samples_per_side);
  tbb::parallel_for(0, camera.height_px, [&](int v) {
    for (int u = 0; u < camera.width_px; ++u) {
      Vec3 sum;
      for (int sample = 0; sample < samples_per_side * samples_per_side; ++sample) {
        const float du = (static_cast<float>(sample % samples_per_side) + 0.5F) * step - 0.5F;
        const float dv = (static_cast<float>(sample / samples_per_side) + 0.5F) * step - 0.5F;
        const Vec3 direction = pixel_rays.direction(static_cast<float>(u) + du, static_cast<float>(v) + dv);
        sum = sum + shader.light_along(pixel_rays.origin(), direction, sample);
      }
      image.at(u, v) = sum * (step * step);
    }
  });
  return image;
}

}  // namespace

RenderedPair render_pair(const SyntheticScene& scene, const StereoCamera& camera, const SceneOptions& options) {
  check_options(options, "scene options");
  check_camera(camera, "synthetic camera");
  const synth::RayScene rays(scene);
  RenderedPair pair;
  for (const bool is_right : {false, true}) {
    const synth::PixelRays pixel_rays(camera, options, is_right);
    const auto light = trace(rays, pixel_rays, camera, options.samples_per_side);
    (is_right ? pair.right : pair.left) = synth::expose(light, scene.lighting, options, is_right);
  }
  pair.left_gray = to_gray(pair.left);
  pair.right_gray = to_gray(pair.right);
  pair.pixels = synth::measure_pixels(rays, camera, options);
  pair.objects = synth::measure_objects(rays, camera, options, pair.pixels);
  return pair;
}

RenderedPair render_pair(const SceneOptions& options) {
  return render_pair(build_scene(options), synthetic_camera(options), options);
}

}  // namespace flies
