#include "street_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

#include "flies/core/random.hpp"
#include "run_flies.hpp"

namespace flies::testing {
namespace {

/// Smooth random grey levels: bilinear between random values on a grid.
double texture(double a, double b, double cell, std::uint32_t surface) {
  const double column = std::floor(a / cell), row = std::floor(b / cell);
  const auto at = [&](double i, double j) {
    const auto word = [](double k) { return static_cast<std::uint32_t>(static_cast<std::int64_t>(k)); };
    return philox({word(column + i), word(row + j), surface, 0}, 7)[0] * 0x1p-32;
  };
  const double s = a / cell - column, t = b / cell - row;
  const double low = at(0, 0) * (1 - s) + at(1, 0) * s, high = at(0, 1) * (1 - s) + at(1, 1) * s;
  return 30.0 + 200.0 * (low * (1 - t) + high * t);
}

/// What the camera at lateral position `eye_y_m` sees in the direction (1, left, up).
double grey_along_ray(double eye_y_m, double eye_z_m, double left, double up) {
  constexpr double kWallX_m = 28.0, kWallHeight_m = 6.0;
  const double ground_x_m = up < 0.0 ? -eye_z_m / up : 1e9;
  const double box_y_m = eye_y_m + kBoxX_m * left, box_z_m = eye_z_m + kBoxX_m * up;
  if (ground_x_m > kBoxX_m && std::abs(box_y_m - kBoxY_m) < 0.8 && box_z_m < 1.8)
    return texture(box_y_m, box_z_m, 0.12, 1);
  if (ground_x_m < kWallX_m) return 60.0 + 0.3 * texture(ground_x_m, eye_y_m + ground_x_m * left, 0.25, 2);
  const double wall_z_m = eye_z_m + kWallX_m * up;
  if (wall_z_m < kWallHeight_m) return texture(eye_y_m + kWallX_m * left, wall_z_m, 0.4, 3);
  return 235.0;
}

cv::Mat render(const StereoCamera& camera, double eye_y_m) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC1);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(grey_along_ray(
          eye_y_m, camera.mount.height_m, (camera.cx_px - u) / camera.fx_px, (camera.cy_px - v) / camera.fy_px));
  return image;
}

}  // namespace

StereoCamera street_camera() {
  return {.fx_px = 300,
          .fy_px = 300,
          .cx_px = 160,
          .cx_right_px = 160,
          .cy_px = 110,
          .baseline_m = 0.5,
          .width_px = 320,
          .height_px = 240,
          .mount = {}};
}

const StreetPair& street_pair() {
  static const StreetPair pair{render(street_camera(), 0.0), render(street_camera(), -street_camera().baseline_m)};
  return pair;
}

cv::Mat unrelated_picture() {
  cv::Mat image(240, 320, CV_8UC1);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(texture(u, v, 5.0, 4));
  return image;
}

std::string kitti_calibration(double focal_px, double centre_u_px, double baseline_m) {
  const auto line = [&](int camera, double offset) {
    return fmt::format("P{}: {} 0 {} {} 0 {} {} 0 0 0 1 0\n", camera, focal_px, centre_u_px, offset, focal_px,
                       street_camera().cy_px);
  };
  return line(0, 0) + line(1, -focal_px * baseline_m) + line(2, 0) + line(3, -focal_px * baseline_m) +
         "R0_rect: 1 0 0 0 1 0 0 0 1\n";
}

std::string kitti_calibration() {
  const StereoCamera camera = street_camera();
  return kitti_calibration(camera.fx_px, camera.cx_px, camera.baseline_m);
}

void write_street(const std::filesystem::path& folder) {
  cv::imwrite((folder / "left.png").string(), street_pair().left);
  cv::imwrite((folder / "right.png").string(), street_pair().right);
  write_text(folder / "calib.txt", kitti_calibration());
}

}  // namespace flies::testing
