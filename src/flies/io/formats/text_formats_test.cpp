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

/// @param of_mode behind TY and TZ
std::string zed(const ToyRig& rig, const std::string& mode, const std::string& of_mode = "") {
  cv::Vec3d turn;
  cv::Rodrigues(rig.r, turn);
  const auto camera = [&](const char* side, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format("[{}_CAM_{}]\nfx={}\nfy={}\ncx={}\ncy={}\nk1={}\nk2={}\np1={}\np2={}\nk3={}\n\n", side, mode,
                       m(0, 0), m(1, 1), m(0, 2), m(1, 2), d[0], d[1], d[2], d[3], d[4]);
  };
  return camera("LEFT", rig.m1, rig.d1) + camera("RIGHT", rig.m2, rig.d2) +
         fmt::format("[STEREO]\nBaseline={}\nTY{of}={}\nTZ{of}={}\nCV_{m}={}\nRX_{m}={}\nRZ_{m}={}\n", -1e3 * rig.t[0],
                     -1e3 * rig.t[1], -1e3 * rig.t[2], turn[1], turn[0], turn[2], fmt::arg("m", mode),
                     fmt::arg("of", of_mode));
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
  const auto other = "TY=7\nTZ=9\n";  // of other modes
  expect_rectifies(load_calibration(folder.write("SN2.conf", zed(rig, "VGA", "_VGA") + other)), rig);
  CalibrationRequest request;
  request.width_px = 640;
  request.height_px = 480;
  EXPECT_THAT(error_of([&] { load_calibration(path, request); }),
              HasSubstr("none of the modes of this file: 672 x 376"));
}

/// As rs-enumerate-devices prints a stream, with its tabs.
std::string realsense_stream(const std::string& name, cv::Size size, const cv::Matx33d& m, const std::string& model,
                             const std::vector<double>& coefficients) {
  return fmt::format(" Intrinsic of \"{}\"\t  / {}x{} / {{Y8}}\n  Width:     \t{}\n  Height:    \t{}\n", name,
                     size.width, size.height, size.width, size.height) +
         fmt::format("  PPX:        \t{}\n  PPY:        \t{}\n  Fx:         \t{}\n  Fy:         \t{}\n", m(0, 2),
                     m(1, 2), m(0, 0), m(1, 1)) +
         fmt::format("  Distortion: \t{}\n  Coeffs:     \t{}  \n  FOV (deg):  \t89.97 x 58.99\n\n", model,
                     fmt::join(coefficients, "  \t"));
}

std::string realsense_pose(const std::string& from, const std::string& to, const cv::Matx33d& r, const cv::Vec3d& t) {
  std::string text = fmt::format("Extrinsic from \"{}\"\t  To\t  \"{}\" :\n Rotation Matrix:\n", from, to);
  for (int i = 0; i < 3; ++i) text += fmt::format("   {}        {}       {}    \n", r(i, 0), r(i, 1), r(i, 2));
  return text + fmt::format("\n Translation Vector: {}  {}  {}  \n\n", t[0], t[1], t[2]);
}

TEST(Formats, RealSenseTakesTheSizeOfTheImages) {
  const TemporaryFolder folder;
  const std::vector<double> none(5, 0.0);
  const auto streams = [&](cv::Size size, double focal_px) {
    const cv::Matx33d m(focal_px, 0, size.width / 2 - 2.5, 0, focal_px, size.height / 2 + 1.25, 0, 0, 1);
    return realsense_stream("Color", size, m * 1.5, "Inverse Brown Conrady", {0.1, 0.2, 0.0, 0.0, 0.1}) +
           realsense_stream("Infrared 1", size, m, "Brown Conrady", none) +
           realsense_stream("Infrared 2", size, m, "Brown Conrady", none);
  };
  const cv::Matx33d turned = cv::Matx33d::eye() * cv::Matx33d(1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8);
  const std::string text = "Device info: \n    Name                          : \tIntel RealSense D435\n\n" +
                           streams({848, 480}, 424.0) + streams({1280, 720}, 640.0) + streams({640, 480}, 384.0) +
                           "Extrinsic Parameters:\n" +
                           realsense_pose("Infrared 1", "Color", turned, {0.0148, 0.0, 0.0}) +
                           realsense_pose("Infrared 1", "Infrared 2", cv::Matx33d::eye(), {-0.0501, 0, 0}) +
                           realsense_pose("Infrared 2", "Infrared 1", cv::Matx33d::eye(), {0.0501, 0, 0});
  const auto path = folder.write("calib.txt", text);
  CalibrationRequest request;
  request.width_px = 848;
  request.height_px = 480;
  const auto calibration = load_calibration(path, request);
  EXPECT_EQ(calibration.format, "RealSense, rs-enumerate-devices -c");
  EXPECT_FALSE(calibration.rectifier);
  EXPECT_EQ(calibration.camera.fx_px, 424.0);
  EXPECT_EQ(calibration.camera.cx_px, 421.5);
  EXPECT_EQ(calibration.camera.cy_px, 241.25);
  EXPECT_EQ(calibration.camera.width_px, 848);
  EXPECT_DOUBLE_EQ(calibration.camera.baseline_m, 0.0501);
  EXPECT_EQ(load_calibration(path).camera.width_px, 1280) << "the largest where no size is asked for";
  request.width_px = 1000;
  EXPECT_THAT(error_of([&] { load_calibration(path, request); }), HasSubstr("1280 x 720, 848 x 480, 640 x 480"));
  request.width_px = 424;
  request.height_px = 240;
  EXPECT_NEAR(load_calibration(path, request).camera.fx_px, 212.0, 1e-9) << "half of 848 x 480";
  // Printed once more all the same, but not of another camera.
  EXPECT_EQ(load_calibration(folder.write("twice.txt", text + text)).camera.fx_px, 640.0);
  EXPECT_THAT(error_of([&] {
                load_calibration(folder.write("two.txt", text + streams({848, 480}, 430.0)));
              }),
              HasSubstr("stands in the file twice"));
  EXPECT_THAT(error_of([&] {
                load_calibration(
                    folder.write("color.txt", realsense_stream("Color", {640, 480}, cv::Matx33d::eye(), "None", none)));
              }),
              HasSubstr("of a stereo camera"));
}

TEST(Formats, RealSenseFisheyesAreRectified) {
  const TemporaryFolder folder;
  ToyRig rig = ToyRig::fisheye();
  const cv::Size size(640, 480);
  std::vector<double> left = rig.d1, right = rig.d2;
  left.push_back(0.0);
  right.push_back(0.0);
  const std::string streams = realsense_stream("Fisheye 1", size, rig.m1, "Kannala Brandt4", left) +
                              realsense_stream("Fisheye 2", size, rig.m2, "Kannala Brandt4", right);
  expect_rectifies(
      load_calibration(folder.write("t265.txt", streams + realsense_pose("Fisheye 1", "Fisheye 2", rig.r, rig.t))),
      rig);
  // The other way round alone.
  const cv::Matx33d back = rig.r.t();
  expect_rectifies(load_calibration(folder.write(
                       "back.txt", streams + realsense_pose("Fisheye 2", "Fisheye 1", back, -(back * rig.t)))),
                   rig);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("none.txt", streams)); }),
              HasSubstr("Extrinsic from \"Fisheye 1\" To \"Fisheye 2\".Rotation Matrix"));
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
