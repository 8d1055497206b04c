#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "flies/core/quantile.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/eval/kitti_motion.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

constexpr double kMaxSpeedError = 0.015;        // median; what remains is the disparity's, see docs/dynamic.md
constexpr double kMaxYawRateError_rps = 0.005;  // median
constexpr const char* kDay = "kitti_raw/2011_09_26";
constexpr const char* kDrive = "2011_09_26_drive_0005_sync";

TEST(BlackBoxKittiEgo, KeepsToTheGpsAndImu) {
  const auto day = find_data(kDay);
  if (!day) GTEST_SKIP() << absence(kDay);
  const auto drive = *day / kDrive;
  CalibrationRequest request;
  request.cameras = {0, 1};
  EgoEstimator estimator(load_calibration((*day / "calib_cam_to_cam.txt").string(), request).camera);
  const auto truth = read_kitti_motion(drive);
  ASSERT_GE(truth.size(), 60U);
  // The laser triggers the cameras evenly; the GPS/IMU's own times step by 10 ms, a tenth of the interval, because it
  // works at 100 Hz. Over all pairs both keep the same time.
  const double interval_s = truth[59].time_s / 59.0;
  std::vector<double> speed_errors, yaw_rate_errors;
  for (std::size_t i = 0; i < 60; ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "%010zu.png", i);
    const GrayPair images =
        load_pair((drive / "image_00/data" / name).string(), (drive / "image_01/data" / name).string());
    const EgoMotion ego = estimator.follow(images.view(), static_cast<double>(i) * interval_s);
    EXPECT_EQ(ego.is_known, i > 0) << name;
    if (!ego.is_known) continue;
    const auto& before = truth[i - 1];  // a pair's motion is the mean since the one before
    const double speed_mps =
        (std::hypot(before.vx_mps, before.vy_mps) + std::hypot(truth[i].vx_mps, truth[i].vy_mps)) / 2;
    speed_errors.push_back(std::abs(std::hypot(ego.vx_mps, ego.vy_mps) / speed_mps - 1));
    yaw_rate_errors.push_back(std::abs(ego.yaw_rate_rps - (before.yaw_rate_rps + truth[i].yaw_rate_rps) / 2));
  }
  std::printf("drive 0005: speed off by a median %.2f %%, yaw rate by %.4f rad/s\n", 100 * upper_median(speed_errors),
              upper_median(yaw_rate_errors));
  EXPECT_LE(upper_median(speed_errors), kMaxSpeedError);
  EXPECT_LE(upper_median(yaw_rate_errors), kMaxYawRateError_rps);
}

}  // namespace
}  // namespace flies::blackbox
