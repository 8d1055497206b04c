#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/random.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// For tests: smooth noise anchored to the road, 0..1: the value at a grid, interpolated.
inline double road_texture(double x_m, double y_m, double grid_m = 0.06) {
  const double x = x_m / grid_m, y = y_m / grid_m;
  const auto node = [](double i, double j) {
    return FlyRandom(3, 0, static_cast<std::uint32_t>(static_cast<std::int32_t>(i)),
                     static_cast<std::uint32_t>(static_cast<std::int32_t>(j)))
        .uniform();
  };
  const double i = std::floor(x), j = std::floor(y), fx = x - i, fy = y - j;
  return std::lerp(std::lerp(node(i, j), node(i + 1, j), fx), std::lerp(node(i, j + 1), node(i + 1, j + 1), fx), fy);
}

/// For tests: two images that own their pixels.
struct OwnPair {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> left, right;

  RectifiedPair view() const {
    return {{left.data(), width_px, height_px, width_px}, {right.data(), width_px, height_px, width_px}};
  }
};

/// For tests: a textured ground under a camera with any mount, below a uniform sky.
/// @param grain of the texture, as a share of the camera's height
inline OwnPair render_ground(const StereoCamera& camera, double grain = 0.04) {
  const Projection projection(camera);
  OwnPair pair{camera.width_px, camera.height_px, {}, {}};
  const auto shade = [&](double u_px, double v_px) {
    const Point3 p = projection.meet_road(u_px, v_px, {});
    if (!(p.x_m > 0.0 && p.x_m < 40.0 * camera.mount.height_m)) return std::uint8_t{128};
    return static_cast<std::uint8_t>(60 + 120 * road_texture(p.x_m, p.y_m, grain * camera.mount.height_m));
  };
  for (int v = 0; v < camera.height_px; ++v)
    for (int u = 0; u < camera.width_px; ++u) {
      // The left pixel that shows the same place of the ground: u_left - parallax(u_left) = u, parallax being linear.
      const double at_0 = projection.road_parallax_px(0, v, {}), per_px = projection.road_parallax_px(1, v, {}) - at_0;
      pair.left.push_back(shade(u, v));
      pair.right.push_back(shade((u + at_0) / (1.0 - per_px), v));
    }
  return pair;
}

}  // namespace flies
