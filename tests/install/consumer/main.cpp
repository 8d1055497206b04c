// A program outside the repository: paints a stereo pair of one textured box on a textured road and asks the
// installed library where the box is. Exits with 0 when it is found at its range.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <vector>

#include "flies/flies.hpp"

namespace {

constexpr double kBoxRange_m = 12.0;
constexpr double kBoxLeft_m = 0.5;
constexpr double kBoxHalfWidth_m = 0.6;
constexpr double kBoxHeight_m = 1.7;
// Half the view-angles' interval in range, and some: this test is about the package, not about accuracy.
constexpr double kRangeTolerance_m = 0.8;

/// Grey level of a random lattice of 6 cm at (a, b), interpolated, so that both cameras see the same texture.
double texture(double a_m, double b_m, std::uint32_t salt) {
  const double a = a_m / 0.06, b = b_m / 0.06;
  const double a0 = std::floor(a), b0 = std::floor(b);
  const auto node = [&](double i, double j) {
    auto hash = static_cast<std::uint32_t>(static_cast<int>(i)) * 0x9E3779B1u ^
                static_cast<std::uint32_t>(static_cast<int>(j)) * 0x85EBCA77u ^ salt;
    hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
    hash = (hash ^ hash >> 13) * 0x297A2D39u;
    return static_cast<double>((hash ^ hash >> 16) & 0xFFu);
  };
  const double s = a - a0, t = b - b0;
  return (node(a0, b0) * (1 - s) + node(a0 + 1, b0) * s) * (1 - t) +
         (node(a0, b0 + 1) * (1 - s) + node(a0 + 1, b0 + 1) * s) * t;
}

/// What a level camera standing `camera_left_m` to the left of the origin sees.
std::vector<std::uint8_t> paint(const flies::StereoCamera& camera, double camera_left_m, double cx_px) {
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const double left_per_m = (cx_px - u) / camera.fx_px;
      const double up_per_m = (camera.cy_px - v) / camera.fy_px;
      const double box_y_m = camera_left_m + kBoxRange_m * left_per_m;
      const double box_z_m = camera.mount.height_m + kBoxRange_m * up_per_m;
      double gray = 180.0;
      if (std::abs(box_y_m - kBoxLeft_m) < kBoxHalfWidth_m && box_z_m > 0 && box_z_m < kBoxHeight_m) {
        gray = texture(box_y_m, box_z_m, 1);
      } else if (up_per_m < 0) {
        const double road_x_m = camera.mount.height_m / -up_per_m;
        gray = 90 + 0.2 * texture(road_x_m, camera_left_m + road_x_m * left_per_m, 2);
      }
      pixels.push_back(static_cast<std::uint8_t>(gray));
    }
  }
  return pixels;
}

}  // namespace

int main() {
  flies::StereoCamera camera;
  camera.width_px = 480;
  camera.height_px = 240;
  camera.fx_px = camera.fy_px = 400.0;
  camera.cx_px = camera.cx_right_px = 240.0;
  camera.cy_px = 110.0;
  camera.baseline_m = 0.5;

  const auto left = paint(camera, 0.0, camera.cx_px);
  const auto right = paint(camera, -camera.baseline_m, camera.cx_right_px);
  const auto view = [&](const std::vector<std::uint8_t>& pixels) {
    return flies::GrayView{pixels.data(), camera.width_px, camera.height_px, camera.width_px};
  };

  const auto detection = flies::Detector(camera).process({view(left), view(right)});
  for (const auto& obstacle : detection.obstacles) {
    std::cout << "obstacle at " << obstacle.x_m << ", " << obstacle.y_m << " m\n";
  }
  for (const auto& obstacle : detection.obstacles) {
    if (std::hypot(obstacle.x_m - kBoxRange_m, obstacle.y_m - kBoxLeft_m) < kRangeTolerance_m) return 0;
  }
  std::cerr << "the box at " << kBoxRange_m << " m was not found\n";
  return 1;
}
