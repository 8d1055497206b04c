// Formats of plain lines, of raw cameras and of rectified ones, and files as people have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::body_from_left;
using flies::testing::body_from_right;
using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::kWritten_m;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::rectified;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::HasSubstr;

std::string zed(const ToyRig& rig, const std::string& mode) {
  cv::Vec3d turn;
  cv::Rodrigues(rig.r, turn);
  const auto camera = [&](const char* side, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format("[{}_CAM_{}]\nfx={}\nfy={}\ncx={}\ncy={}\nk1={}\nk2={}\np1={}\np2={}\nk3={}\n\n", side, mode,
                       m(0, 0), m(1, 1), m(0, 2), m(1, 2), d[0], d[1], d[2], d[3], d[4]);
  };
  return camera("LEFT", rig.m1, rig.d1) + camera("RIGHT", rig.m2, rig.d2) +
         fmt::format("[STEREO]\nBaseline={}\nTY={}\nTZ={}\nCV_{m}={}\nRX_{m}={}\nRZ_{m}={}\n", -1e3 * rig.t[0],
                     1e3 * rig.t[1], 1e3 * rig.t[2], turn[1], turn[0], turn[2], fmt::arg("m", mode));
}

TEST(Formats, ZedTakesTheModeOfTheImagesAndRectifies) {
  const TemporaryFolder folder;
  ToyRig rig;
  rig.m1(0, 2) += 16;  // VGA is 672 x 376
  rig.m2(0, 2) += 16;
  rig.m1(1, 2) -= 52;
  rig.m2(1, 2) -= 52;
  const auto path = folder.write("SN1010.conf", zed(rig, "VGA"));
  const auto calibration = load_calibration(path);
  EXPECT_EQ(calibration.format, "ZED SN.conf");
  EXPECT_EQ(calibration.camera.width_px, 672);
  expect_rectifies(calibration, rig);
  CalibrationRequest request;
  request.width_px = 640;
  request.height_px = 480;
  EXPECT_THAT(error_of([&] { load_calibration(path, request); }),
              HasSubstr("none of the modes of this file: 672 x 376"));
}

TEST(Formats, KittiRawBeforeRectification) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto line = [](const std::string& key, const std::vector<double>& values) {
    return fmt::format("{}: {}\n", key, fmt::join(values, " "));
  };
  const cv::Mat first = body_from_left().inv(), second = body_from_right(rig).inv();
  const auto camera = [&](const char* n, const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& pose,
                          const cv::Mat& p) {
    const std::string s = n;
    return line("S_" + s, {640, 480}) + line("K_" + s, numbers(cv::Mat(m))) + line("D_" + s, d) +
           line("R_" + s, numbers(pose(cv::Rect(0, 0, 3, 3)))) + line("T_" + s, numbers(pose(cv::Rect(3, 0, 1, 3)))) +
           line("S_rect_" + s, {640, 480}) + line("P_rect_" + s, numbers(p));
  };
  const auto path =
      folder.write("c", camera("02", rig.m1, rig.d1, first, to.p1) + camera("03", rig.m2, rig.d2, second, to.p2));
  expect_rectifies(load_calibration(path, of_raw_images()), rig);
}

TEST(Formats, OrbSlam2OfRectifiedImages) {
  const TemporaryFolder folder;
  const auto calibration = load_calibration(
      folder.write("c",
                   "%YAML:1.0\nCamera.fx: 718.856\nCamera.fy: 718.856\nCamera.cx: 607.1928\nCamera.cy: 185.2157\n"
                   "Camera.k1: 0.0\nCamera.k2: 0.0\nCamera.p1: 0.0\nCamera.p2: 0.0\nCamera.width: 1241\n"
                   "Camera.height: 376\nCamera.fps: 10.0\nCamera.bf: 386.1448\nCamera.RGB: 1\nThDepth: 35\n"));
  EXPECT_FALSE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, 0.537165719, kWritten_m);
  EXPECT_EQ(calibration.camera.width_px, 1241);
}

TEST(Formats, FilesOfRectifiedImagesRefuseRawOnes) {
  const TemporaryFolder folder;
  const auto path = folder.write("K.txt", "754.668 0.0 489.379 0.0 754.668 265.16 0.0 0.0 1.0\n0.063\n");
  EXPECT_THAT(error_of([&] { load_calibration(path, of_raw_images()); }), HasSubstr("raw images"));
}

TEST(Formats, FoundationStereoHasTheBaselineInItsSecondRow) {
  const TemporaryFolder folder;
  const auto calibration =
      load_calibration(folder.write("K.txt", "754.668 0.0 489.379 0.0 754.668 265.16 0.0 0.0 1.0\n0.063\n"));
  EXPECT_EQ(calibration.format, "FoundationStereo K.txt");
  EXPECT_EQ(calibration.camera.fx_px, 754.668);
  EXPECT_EQ(calibration.camera.cy_px, 265.16);
  EXPECT_EQ(calibration.camera.baseline_m, 0.063);
}

TEST(Formats, KittiOdometryMayLackItsNames) {
  const TemporaryFolder folder;
  const auto two =
      load_calibration(folder.write("c", "718 0 607 0 0 718 185 0 0 0 1 0\n718 0 607 -386 0 718 185 0 0 0 1 0\n"));
  EXPECT_EQ(two.format, "KITTI odometry calib.txt");
  EXPECT_NEAR(two.camera.baseline_m, 386.0 / 718.0, kWritten_m);
}

TEST(Formats, TextsMayHaveCommentsBlanksAndNestedLists) {
  const TemporaryFolder folder;
  const auto nested = load_calibration(
      folder.write("c",
                   "P1:\n- - 500.0\n  - 0.0\n  - 320.0\n  - 0.0\n- [0.0, 500.0, 240.0, 0.0]\n- [0, 0, 1, 0]\n"
                   "P2: [[500.0, 0.0, 320.0, -150.0],\n  [0.0, 500.0, 240.0, 0.0],\n  [0.0, 0.0, 1.0, 0.0]]\n"));
  EXPECT_NEAR(nested.camera.baseline_m, 0.3, kWritten_m);
  const auto kitti = load_calibration(
      folder.write("c",
                   "\xEF\xBB\xBF# the rig of May\r\n\r\n  P2: 700 0 600 0 0 700 170 0 0 0 1 0  # left\r\n"
                   "\tP3 :  700 0 600 -280\r\n 0 700 170 0 0 0 1 0\r\n"));
  EXPECT_NEAR(kitti.camera.baseline_m, 0.4, kWritten_m);
  const auto middlebury = load_calibration(
      folder.write("c",
                   "# m\n cam0 = [700 0 600; 0 700 170; 0 0 1]\ncam1= [700 0 600; 0 700 170; 0 0 1]\n\ndoffs = 0\n"
                   "baseline = 100\nwidth = 1242\nheight = 375\n"));
  EXPECT_NEAR(middlebury.camera.baseline_m, 0.1, kWritten_m);
}

TEST(Formats, ReadsFilesAsPeopleHaveThem) {
  const auto formats = flies::testing::find_data("other/formats");
  if (!formats) GTEST_SKIP() << flies::testing::absence("other/formats");
  const auto data = formats->parent_path().parent_path();
  const auto read = [&](const char* file) { return load_calibration((data / "other" / file).string()); };
  EXPECT_NEAR(read("formats/basalt_euroc_ds_calib.json").camera.baseline_m, 0.11023, 1e-5);
  EXPECT_NEAR(read("formats/stereodemo_calibration.json").camera.baseline_m, 0.075, kWritten_m);
  EXPECT_NEAR(read("formats/stixel-camera.xml").camera.mount.height_m, 1.17, kWritten_m);
  EXPECT_NEAR(read("zed/zed-cam-sn-1010.conf").camera.baseline_m, 0.12, 1e-4);
  const auto rows = read("karlsruhe2010/calib.txt");
  EXPECT_NEAR(rows.camera.cx_px, 635.9587, 1e-3);
  EXPECT_EQ(rows.camera.height_px, 372);
  // The sensors as they came and the file of OpenCV made from them are one camera.
  const auto sensors = read("mynteye-fisheye/left_sensor.yaml"), opencv = read("mynteye-fisheye/opencv-fisheye.yaml");
  EXPECT_NEAR(sensors.camera.fx_px, opencv.camera.fx_px, 1e-3);
  EXPECT_NEAR(sensors.camera.baseline_m, opencv.camera.baseline_m, 1e-6);
  EXPECT_NEAR(sensors.camera.cy_px, 227.51, 1e-2);
}

TEST(Formats, DrivingStereoHasNumbersOfItsOwn) {
  const TemporaryFolder folder;
  const auto calibration = load_calibration(
      folder.write("2018-07-09-16-11-56.txt",
                   "calib_time: 2018-07-09\nS_101: 1920 1200\nK_101: 2063 0 978 0 2063 584 0 0 1\nS_rect_101: 881 400\n"
                   "P_rect_101: 1003.56 0 460.25 0 0 1003.56 193.02 0 0 0 1 0\nS_103: 1920 1200\n"
                   "S_rect_103: 881 400\nP_rect_103: 1003.56 0 460.25 -543.93 0 1003.56 193.02 0 0 0 1 0\n"));
  EXPECT_EQ(calibration.format, "KITTI raw calib_cam_to_cam.txt");
  EXPECT_EQ(calibration.left_name, "P_rect_101");
  EXPECT_EQ(calibration.camera.width_px, 881);
  EXPECT_NEAR(calibration.camera.baseline_m, 0.542, 1e-3);
}

}  // namespace
}  // namespace flies
