#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "flies/eval/dataset.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

/// The cameras' real heights are known to a few centimetres, and a car pitches by a degree.
constexpr double kHeight_m = 0.06;
constexpr double kTilt_rad = radians(2.0);

struct Case {
  std::string folder;
  double height_m;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.folder; }

class BlackBoxMount : public ::testing::TestWithParam<Case> {};

TEST_P(BlackBoxMount, IsFoundWhateverWasTold) {
  const auto& [name, height_m] = GetParam();
  const auto folder = find_data(name);
  if (!folder) GTEST_SKIP() << absence(name);
  const CameraMount told[] = {
      {1.65, radians(-15), 0}, {1.65, radians(25), 0}, {0.2, 0, 0}, {3.0, 0, 0}, {1.65, 0, radians(10)}};
  for (const auto& mount : told) {
    DatasetRequest request;
    request.find_mount = true;
    request.camera_height_m = mount.height_m;
    request.camera_pitch_rad = mount.pitch_rad;
    request.camera_roll_rad = mount.roll_rad;
    const CameraMount found = open_dataset(*folder, request).load(0).camera.mount;
    EXPECT_NEAR(found.height_m, height_m, kHeight_m) << name << " told " << mount.height_m;
    EXPECT_NEAR(found.pitch_rad, 0.0, kTilt_rad) << name << " told " << degrees(mount.pitch_rad);
    EXPECT_NEAR(found.roll_rad, 0.0, kTilt_rad) << name << " told " << degrees(mount.roll_rad);
  }
}

TEST_P(BlackBoxMount, StaysWhereItIsRight) {
  const auto& [name, height_m] = GetParam();
  const auto folder = find_data(name);
  if (!folder) GTEST_SKIP() << absence(name);
  DatasetRequest request;
  request.find_mount = true;
  request.camera_height_m = height_m;
  const CameraMount kept = open_dataset(*folder, request).load(0).camera.mount;
  EXPECT_EQ(kept.height_m, height_m);
  EXPECT_EQ(kept.pitch_rad, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Folders, BlackBoxMount,
                         ::testing::Values(Case{"kitti_raw/2011_09_26/2011_09_26_drive_0005_sync", 1.65},
                                           Case{"kitti_object/training", 1.65}, Case{"kitti_stereo2012", 1.65},
                                           Case{"eth_bahnhof/rectified", 0.98}));

}  // namespace
}  // namespace flies::blackbox
