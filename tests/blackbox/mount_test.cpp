#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "flies/eval/dataset.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/road/find_mount.hpp"
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

// Some centimetres beside the true height the search for the road of each pair fails on bare asphalt, which then is an
// obstacle.
TEST(BlackBoxDrive, MountBesideTheTrueOneIsFoundWhereTheRoadIsBare) {
  const std::string name = "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync";
  const auto folder = find_data(name);
  if (!folder) GTEST_SKIP() << absence(name);
  for (const CameraMount& told :
       {CameraMount{1.55, 0, 0}, CameraMount{1.5, 0, 0}, CameraMount{1.8, radians(-1.6), 0}}) {
    DatasetRequest request;
    request.find_mount = true;
    request.camera_height_m = told.height_m;
    request.camera_pitch_rad = told.pitch_rad;
    const CameraMount found = open_dataset(*folder, request).load(0).camera.mount;
    EXPECT_NEAR(found.height_m, 1.65, kHeight_m) << told.height_m;
    EXPECT_NEAR(found.pitch_rad, 0.0, radians(0.5)) << told.height_m;
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

/// A pair and its camera, told to look 10 degrees up.
MountFinding find_in(const std::filesystem::path& left, const std::filesystem::path& right,
                     const std::filesystem::path& calib) {
  GrayPair images = load_pair(left.string(), right.string());
  StereoCamera camera = load_calibration(calib.string()).camera;
  camera.mount = {1.65, radians(-10), 0};
  return find_mount(std::vector{images.view()}, camera);
}

TEST(BlackBoxSinglePairs, MountIsFoundWhereLittleGroundIsSeen) {
  const auto folder = find_data("kitti_stereo2012");
  if (!folder) GTEST_SKIP() << absence("kitti_stereo2012");
  // Of 33 pairs those that show the least ground.
  for (const auto& [name, size] :
       {std::pair{"000037", "1242x375"}, std::pair{"000043", "1242x375"}, std::pair{"000073", "1226x370"},
        std::pair{"000145", "1242x375"}, std::pair{"000193", "1238x374"}}) {
    const std::string file = std::string(name) + "_10.png";
    const auto found = find_in(*folder / "image_0" / file, *folder / "image_1" / file,
                               *folder / ("calib_" + std::string(size) + ".yaml"));
    EXPECT_TRUE(found.is_replaced) << name;
    EXPECT_NEAR(found.mount.height_m, 1.65, 0.2) << name;
    EXPECT_NEAR(found.mount.pitch_rad, 0.0, radians(2.5)) << name;
  }
}

TEST(BlackBoxDrive, RoadOfDarkAsphaltIsWhereItWasToldInSinglePairs) {
  const std::string name = "kitti_raw/2011_09_26";
  const auto folder = find_data(name);
  if (!folder) GTEST_SKIP() << absence(name);
  CalibrationRequest gray;
  gray.cameras = {0, 1};
  StereoCamera camera = load_calibration((*folder / "calib_cam_to_cam.txt").string(), gray).camera;
  camera.mount = {1.65, 0, 0};
  const auto drive = *folder / "2011_09_26_drive_0005_sync";
  for (const std::string file : {"0000000000.png", "0000000001.png", "0000000007.png"}) {
    const GrayPair images =
        load_pair((drive / "image_00/data" / file).string(), (drive / "image_01/data" / file).string());
    EXPECT_TRUE(find_mount(std::vector{images.view()}, camera).is_confirmed) << file;
  }
}

TEST(BlackBoxSinglePairs, ImagesOnTheirHeadsAreToldFromARoomWithACeiling) {
  const auto folder = find_data("other/eth3d/electro_2l");
  if (!folder) GTEST_SKIP() << absence("other/eth3d/electro_2l");
  GrayPair images = load_pair((*folder / "im0.png").string(), (*folder / "im1.png").string());
  StereoCamera camera = load_calibration((*folder / "calib.txt").string()).camera;
  EXPECT_FALSE(find_mount(std::vector{images.view()}, camera).is_upside_down);

  std::reverse(images.left.pixels.begin(), images.left.pixels.end());
  std::reverse(images.right.pixels.begin(), images.right.pixels.end());
  std::swap(images.left, images.right);
  camera.cx_px = camera.width_px - 1 - camera.cx_px;
  camera.cx_right_px = camera.cx_px;
  camera.cy_px = camera.height_px - 1 - camera.cy_px;
  EXPECT_TRUE(find_mount(std::vector{images.view()}, camera).is_upside_down);
}

INSTANTIATE_TEST_SUITE_P(Folders, BlackBoxMount,
                         ::testing::Values(Case{"kitti_raw/2011_09_26/2011_09_26_drive_0005_sync", 1.65},
                                           Case{"kitti_object/training", 1.65}, Case{"kitti_stereo2012", 1.65},
                                           Case{"eth_bahnhof/rectified", 0.98}));

}  // namespace
}  // namespace flies::blackbox
