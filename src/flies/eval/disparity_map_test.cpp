#include "flies/eval/disparity_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

StereoCamera camera() {
  StereoCamera c;
  c.fx_px = c.fy_px = 200;
  c.cx_px = c.cx_right_px = 100;
  c.cy_px = 50;
  c.baseline_m = 0.5;
  c.width_px = 200;
  c.height_px = 100;
  return c;
}

/// The road at its nominal place, before it a board 10 m ahead between columns 80 and 120, sky above.
cv::Mat street_map() {
  const StereoCamera c = camera();
  cv::Mat map(c.height_px, c.width_px, CV_16UC1, cv::Scalar(0));
  for (int v = 0; v < map.rows; ++v) {
    for (int u = 0; u < map.cols; ++u) {
      const double of_road_px = (v - c.cy_px) * c.baseline_m / c.mount.height_m, of_board_px = 10.0;
      const bool on_board = u >= 80 && u < 120 && v >= 45;
      const double disparity_px = on_board ? std::max(of_board_px, of_road_px) : std::max(0.0, of_road_px);
      map.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(std::lround(disparity_px * 256.0));
    }
  }
  return map;
}

TEST(ReadDisparityMap, GivesPointsOverTheRoad) {
  const TemporaryFolder folder;
  write_png(folder.file("m.png"), street_map());
  const auto points = read_disparity_map(folder.file("m.png"), camera());
  ASSERT_GT(points.size(), 5000u);
  int on_board = 0;
  for (const auto& [point, above_road_m] : points) {
    EXPECT_LT(point.x_m, 60.0);
    const bool at_board = std::abs(point.x_m - 10.0) < 0.01 && point.z_m > 0.3;
    on_board += at_board;
    EXPECT_NEAR(above_road_m, at_board ? point.z_m : 0.0, at_board ? 0.1 : 0.35) << point.x_m << " " << point.z_m;
  }
  EXPECT_GT(on_board, 500);
}

TEST(ReadDisparityMap, RefusesWhatIsNoMapOfTheCamera) {
  const TemporaryFolder folder;
  const auto complaint = [&] { return error_of([&] { read_disparity_map(folder.file("m.png"), camera()); }); };
  EXPECT_THAT(complaint(), HasSubstr("cannot be read"));
  folder.write("m.png", "no picture");
  EXPECT_THAT(complaint(), HasSubstr("m.png"));
  cv::Mat grey;
  street_map().convertTo(grey, CV_8U, 1.0 / 256.0);
  write_png(folder.file("m.png"), grey);
  EXPECT_THAT(complaint(), HasSubstr("16-bit grey"));
  write_png(folder.file("m.png"), street_map().colRange(0, 150));
  EXPECT_THAT(complaint(), HasSubstr("150"));
}

}  // namespace
}  // namespace flies
