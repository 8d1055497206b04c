#include "flies/io/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/formats/toy_rig.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::TemporaryFolder;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kExact = 1e-9;           // the same decimal read twice
constexpr double kFileRounding_m = 1e-6;  // numbers in these files have seven digits

/// Cameras 0 and 1 are 0.5 m apart, 2 and 3 are 0.4 m apart with 3 mm between their rows.
const std::string kKittiMatrices =
    "P0: 700 0 600 0 0 700 170 0 0 0 1 0\n"
    "P1: 700 0 600 -350 0 700 170 0 0 0 1 0\n"
    "P2: 700 0 600 42 0 700 170 0 0 0 1 0\n"
    "P3: 700 0 600 -238 0 700 170 2.1 0 0 1 0\n";

TEST(LoadCalibration, ReadsKittiObject) {
  const TemporaryFolder folder;
  const auto path = folder.write("anything.dat", kKittiMatrices + "R0_rect: 1 0 0 0 1 0 0 0 1\n");
  const auto calibration = load_calibration(path);
  EXPECT_EQ(calibration.format, "KITTI object calib.txt");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.4, kExact);
  EXPECT_EQ(calibration.camera.fx_px, 700);
  EXPECT_EQ(calibration.camera.cx_px, 600);
  EXPECT_EQ(calibration.camera.cy_px, 170);
  EXPECT_EQ(calibration.camera.width_px, 0);
  EXPECT_FALSE(calibration.has_height);
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("vertical offset of 0.0030 m between P2 and P3")));
}

TEST(LoadCalibration, ReadsTheRequestedKittiCameras) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.cameras = {0, 1};
  const auto calibration = load_calibration(folder.write("c", kKittiMatrices), request);
  EXPECT_EQ(calibration.format, "KITTI odometry calib.txt");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.5, kExact);
  EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("offset"))));
}

TEST(LoadCalibration, ReadsKittiRawWithItsImageSize) {
  const TemporaryFolder folder;
  const auto path = folder.write("c",
                                 "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
                                 "S_rect_00: 1242 375\nP_rect_00: 700 0 600 0 0 700 170 0 0 0 1 0\n"
                                 "S_rect_02: 1.242e+03 3.75e+02\nP_rect_02: 700 0 600 42 0 700 170 0 0 0 1 0\n"
                                 "P_rect_03: 700 0 600 -238 0 700 170 0 0 0 1 0\n");
  const auto calibration = load_calibration(path);
  EXPECT_EQ(calibration.format, "KITTI raw calib_cam_to_cam.txt");
  EXPECT_EQ(calibration.camera.width_px, 1242);
  EXPECT_EQ(calibration.camera.height_px, 375);
  EXPECT_NEAR(calibration.camera.baseline_m, 0.4, kExact);
}

TEST(LoadCalibration, UndoesTheCameraMatrixWhenCamerasStandAhead) {
  // A camera 0.1 m ahead has cx * 0.1 and cy * 0.1 added to its last column: no baseline comes from that.
  const TemporaryFolder folder;
  const auto path = folder.write("c",
                                 "P0: 700 0 600 0 0 700 170 0 0 0 1 0\nP1: 1 0 0 0 0 1 0 0 0 0 1 0\n"
                                 "P2: 700 0 600 60 0 700 170 17 0 0 1 0.1\nP3: 700 0 600 -280 0 700 170 0 0 0 1 0\n");
  const auto calibration = load_calibration(path);
  EXPECT_NEAR(calibration.camera.baseline_m, 0.4, kExact);
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("forward offset of -0.1000 m")));
  EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("vertical"))));
}

TEST(LoadCalibration, ReadsMiddleburyInMillimetres) {
  const TemporaryFolder folder;
  const auto calibration = load_calibration(folder.write(
      "c",
      "cam0=[3979.911 0 1244.772; 0 3979.911 1019.507; 0 0 1]\ncam1=[3979.911 0 1369.115; 0 3979.911 1019.507; 0 0 1]\n"
      "doffs=124.343\nbaseline=193.001\nwidth=2964\nheight=1988\nndisp=270\nisint=0\nvmin=23\nvmax=245\n"));
  EXPECT_EQ(calibration.format, "Middlebury calib.txt");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.193001, kExact);
  EXPECT_NEAR(calibration.camera.cx_right_px - calibration.camera.cx_px, 124.343, kExact);
  EXPECT_EQ(calibration.camera.width_px, 2964);
  EXPECT_EQ(calibration.camera.height_px, 1988);
}

TEST(LoadCalibration, ReadsOwnYamlBackToTheSameCamera) {
  const TemporaryFolder folder;
  StereoCamera camera{721.5377, 720.25, 609.5593, 611.0, 172.854, 0.53715, 1242, 375, {1.23, 0.02, -0.01}};
  const auto calibration = load_calibration(folder.write("c", calibration_yaml(camera)));
  EXPECT_EQ(calibration.format, "flies YAML");
  EXPECT_EQ(calibration.camera.fx_px, camera.fx_px);
  EXPECT_EQ(calibration.camera.fy_px, camera.fy_px);
  EXPECT_EQ(calibration.camera.cx_px, camera.cx_px);
  EXPECT_EQ(calibration.camera.cx_right_px, camera.cx_right_px);
  EXPECT_EQ(calibration.camera.cy_px, camera.cy_px);
  EXPECT_EQ(calibration.camera.baseline_m, camera.baseline_m);
  EXPECT_EQ(calibration.camera.width_px, camera.width_px);
  EXPECT_EQ(calibration.camera.height_px, camera.height_px);
  EXPECT_EQ(calibration.camera.mount.height_m, camera.mount.height_m);
  EXPECT_NEAR(calibration.camera.mount.pitch_rad, camera.mount.pitch_rad, kExact);
  EXPECT_NEAR(calibration.camera.mount.roll_rad, camera.mount.roll_rad, kExact);
  EXPECT_TRUE(calibration.has_height);
  EXPECT_TRUE(calibration.has_pitch);
  EXPECT_THAT(texts(calibration.notes), IsEmpty());
}

TEST(LoadCalibration, LetsTheRequestOverruleTheMount) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.camera_height_m = 0.98;
  request.camera_pitch_rad = 0.05;
  const auto calibration = load_calibration(folder.write("c", kKittiMatrices), request);
  EXPECT_EQ(calibration.camera.mount.height_m, 0.98);
  EXPECT_EQ(calibration.camera.mount.pitch_rad, 0.05);
  EXPECT_TRUE(calibration.has_height);
  EXPECT_TRUE(calibration.has_pitch);
  EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("assumed"))));
}

/// A raw stereo camera as OpenCV would write it; the right camera is turned by a few degrees.
struct RawCamera {
  cv::Mat m1 = (cv::Mat_<double>(3, 3) << 500, 0, 320, 0, 505, 240, 0, 0, 1);
  cv::Mat m2 = (cv::Mat_<double>(3, 3) << 510, 0, 315, 0, 512, 236, 0, 0, 1);
  cv::Mat d1 = (cv::Mat_<double>(1, 5) << -0.2, 0.05, 0.001, -0.001, 0.0);
  cv::Mat d2 = (cv::Mat_<double>(1, 5) << -0.18, 0.04, -0.001, 0.001, 0.0);
  cv::Mat r, t = (cv::Mat_<double>(3, 1) << -0.3, 0.004, 0.002);
  RawCamera() { cv::Rodrigues(cv::Vec3d(0.01, -0.03, 0.008), r); }

  std::string text(const char* extension, bool with_size = true) const {
    cv::FileStorage file(extension, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    if (with_size) file << "imageSize" << cv::Size(640, 480);
    file << "M1" << m1 << "D1" << d1 << "M2" << m2 << "D2" << d2 << "R" << r << "T" << t;
    return file.releaseAndGetString();
  }
};

TEST(LoadCalibration, RectifiesRawOpenCvCamerasAlikeFromYamlAndXml) {
  const TemporaryFolder folder;
  const RawCamera raw;
  for (const char* extension : {".yml", ".xml"}) {
    const auto calibration = load_calibration(folder.write("c", raw.text(extension)));
    EXPECT_EQ(calibration.format, "OpenCV stereo") << extension;
    ASSERT_TRUE(calibration.rectifier.has_value()) << extension;
    EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(raw.t), kFileRounding_m) << extension;
    EXPECT_EQ(calibration.camera.width_px, 640);
    EXPECT_EQ(calibration.camera.height_px, 480);
    EXPECT_EQ(calibration.camera.cx_px, calibration.camera.cx_right_px);
  }
}

TEST(LoadCalibration, TakesTheImageSizeOfRawCamerasFromTheRequest) {
  const TemporaryFolder folder;
  const auto path = folder.write("c", RawCamera().text(".yml", false));
  CalibrationRequest request;
  request.width_px = 640;
  request.height_px = 480;
  EXPECT_EQ(load_calibration(path, request).camera.width_px, 640);
  EXPECT_THAT(flies::testing::error_of([&] { load_calibration(path); }), HasSubstr("image_width"));
}

TEST(Rectifier, SaysThatItWasMovedFrom) {
  const TemporaryFolder folder;
  auto calibration = load_calibration(folder.write("c", RawCamera().text(".yml")));
  const GrayImage gray{640, 480, std::vector<std::uint8_t>(640 * 480, 90)};
  const Rectifier other = std::move(*calibration.rectifier);
  EXPECT_EQ(other.rectify({gray, gray, 8}).left.width_px, 640);
  EXPECT_THROW(calibration.rectifier->rectify({gray, gray, 8}), std::logic_error);  // NOLINT(bugprone-use-after-move)
}

TEST(Rectifier, PutsTheSamePointOnTheSameRowWhereTheCameraSays) {
  // White dots at known points of space, seen by the raw cameras, must appear in the rectified images on one row and at
  // the disparity of their depth.
  const TemporaryFolder folder;
  const RawCamera raw;
  const auto calibration = load_calibration(folder.write("c", raw.text(".yml")));
  for (const cv::Point3d point : {cv::Point3d(0, 0, 4), cv::Point3d(0.8, -0.5, 3), cv::Point3d(-0.7, 0.6, 5)}) {
    const auto image_of = [&](const cv::Mat& m, const cv::Mat& d, const cv::Mat& rotation, const cv::Mat& translation) {
      std::vector<cv::Point2d> pixel;
      cv::projectPoints(std::vector<cv::Point3d>{point}, rotation, translation, m, d, pixel);
      GrayImage image{640, 480, std::vector<std::uint8_t>(640 * 480, 0)};
      constexpr double kBlobRadius_px = 4.0;
      for (int v = 0; v < 480; ++v)
        for (int u = 0; u < 640; ++u)
          image.pixels[static_cast<std::size_t>(v * 640 + u)] = static_cast<std::uint8_t>(
              255 * std::exp(-(std::pow(u - pixel[0].x, 2) + std::pow(v - pixel[0].y, 2)) / (2 * kBlobRadius_px)));
      return image;
    };
    const cv::Mat none = cv::Mat::zeros(3, 1, CV_64F), upright = cv::Mat::eye(3, 3, CV_64F);
    const auto pair = calibration.rectifier->rectify(
        {image_of(raw.m1, raw.d1, upright, none), image_of(raw.m2, raw.d2, raw.r, raw.t), 8});
    const auto left = testing::centre_of_dot(pair.left), right = testing::centre_of_dot(pair.right);
    constexpr double kInterpolation_px = 0.15;  // remapping quantises to 1/32 px and the blob to 8 bits
    EXPECT_NEAR(left.y, right.y, kInterpolation_px);
    // The rectified left camera is turned against the raw one, so the depth differs a little from point.z.
    const double depth_m = calibration.camera.fx_px * calibration.camera.baseline_m / (left.x - right.x);
    const double range_m = depth_m * std::hypot((left.x - calibration.camera.cx_px) / calibration.camera.fx_px,
                                                (left.y - calibration.camera.cy_px) / calibration.camera.fy_px, 1.0);
    constexpr double kRangeShare = 0.01;
    EXPECT_NEAR(range_m, cv::norm(point), kRangeShare * cv::norm(point));
  }
}

TEST(LoadCalibration, TakesOpenCvProjectionsAsRectified) {
  const TemporaryFolder folder;
  const std::string text =
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
      "P1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 500., 0., 320., 0., 0., 500., 240., 0., 0., "
      "0., "
      "1., 0. ]\n"
      "P2: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 500., 0., 322., -150., 0., 500., 240., 0., "
      "0., "
      "0., 1., 0. ]\n";
  const auto calibration = load_calibration(folder.write("c", text));
  EXPECT_FALSE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, 0.3, kExact);
  EXPECT_EQ(calibration.camera.cx_right_px, 322);
  EXPECT_EQ(calibration.camera.width_px, 640);
}

TEST(LoadCalibration, RectifiesWhenIntrinsicsComeAsASecondFile) {
  const TemporaryFolder folder;
  const RawCamera raw;
  cv::FileStorage intrinsics(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  intrinsics << "M1" << raw.m1 << "D1" << raw.d1 << "M2" << raw.m2 << "D2" << raw.d2;
  cv::FileStorage extrinsics(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::Mat p = (cv::Mat_<double>(3, 4) << 500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0);
  extrinsics << "R" << raw.r << "T" << raw.t << "P1" << p << "P2" << p;
  CalibrationRequest request;
  request.right_path = folder.write("intrinsics.yml", intrinsics.releaseAndGetString());
  request.width_px = 640;
  request.height_px = 480;
  const auto calibration = load_calibration(folder.write("extrinsics.yml", extrinsics.releaseAndGetString()), request);
  EXPECT_TRUE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(raw.t), kFileRounding_m);
}

std::string ros_camera(double translation_px, const std::string& indent = "") {
  return indent + "image_width: 640\n" + indent + "image_height: 480\n" + indent + "camera_name: narrow_stereo\n" +
         indent + "distortion_model: plumb_bob\n" + indent + "distortion_coefficients:\n" + indent + "  rows: 1\n" +
         indent + "  cols: 5\n" + indent + "  data: [-0.1, 0.2, 0, 0, 0]\n" + indent + "projection_matrix:\n" + indent +
         "  rows: 3\n" + indent + "  cols: 4\n" + indent + "  data: [400, 0, 320, " + std::to_string(translation_px) +
         ", 0, 400, 240, 0, 0, 0, 1, 0]\n";
}

TEST(LoadCalibration, FindsTheRightRosFileBesideTheLeft) {
  const TemporaryFolder folder;
  folder.write("my_right_camera.yaml", ros_camera(-48));
  const auto calibration = load_calibration(folder.write("my_left_camera.yaml", ros_camera(0)));
  EXPECT_EQ(calibration.format, "ROS camera_info pair");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.12, kExact);
  EXPECT_EQ(calibration.camera.width_px, 640);
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("image_rect")));
}

TEST(LoadCalibration, TakesTheRightRosFileAsGiven) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.right_path = folder.write("b.yaml", ros_camera(-48));
  EXPECT_NEAR(load_calibration(folder.write("a.yaml", ros_camera(0)), request).camera.baseline_m, 0.12, kExact);
}

TEST(LoadCalibration, ReadsRosPairFromOneFile) {
  const TemporaryFolder folder;
  const auto path = folder.write("c", "left:\n" + ros_camera(0, "  ") + "right:\n" + ros_camera(-48, "  "));
  EXPECT_NEAR(load_calibration(path).camera.baseline_m, 0.12, kExact);
}

TEST(LoadCalibration, ReadsRosMessages) {
  const TemporaryFolder folder;
  const std::string message =
      "height: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: [0.0, 0.0]\n"
      "K: [400, 0, 320, 0, 400, 240, 0, 0, 1]\nP: [400, 0, 320, ";
  CalibrationRequest request;
  request.right_path = folder.write("r", message + "-48, 0, 400, 240, 0, 0, 0, 1, 0]\n");
  EXPECT_NEAR(
      load_calibration(folder.write("l", message + "0, 0, 400, 240, 0, 0, 0, 1, 0]\n"), request).camera.baseline_m,
      0.12, kExact);
}

TEST(KittiCamerasFromPaths, ReadsFolderNames) {
  using Cameras = std::array<int, 2>;
  EXPECT_EQ(kitti_cameras_from_paths("d/image_00/data/0000000001.png", "d/image_01/data/0000000001.png"),
            (Cameras{0, 1}));
  EXPECT_EQ(kitti_cameras_from_paths("training/image_2", "training/image_3/"), (Cameras{2, 3}));
  EXPECT_EQ(kitti_cameras_from_paths("image_1", "image_0"), (Cameras{1, 0}));
  EXPECT_EQ(kitti_cameras_from_paths("IMAGE_00/a.png", "Image_01/a.png"), (Cameras{0, 1}));
  EXPECT_EQ(kitti_cameras_from_paths("left.png", "image_1/x.png"), std::nullopt);
  EXPECT_EQ(kitti_cameras_from_paths("image_00000004_0.png", "image_00000004_1.png"), std::nullopt);
  EXPECT_EQ(kitti_cameras_from_paths("s/image_2/a.png", "s/image_2/b.png"), std::nullopt);
}

TEST(LoadCalibration, ReadsTheRealFiles) {
  const auto kitti = testing::find_data("kitti_raw");
  if (!kitti) GTEST_SKIP() << testing::absence("kitti_raw");
  const auto data = kitti->parent_path();
  CalibrationRequest gray;
  gray.cameras = {0, 1};
  const auto raw = load_calibration((data / "kitti_raw/2011_09_26/calib_cam_to_cam.txt").string(), gray);
  EXPECT_NEAR(raw.camera.baseline_m, 0.5372, 1e-4);
  EXPECT_EQ(raw.camera.width_px, 1242);
  for (const auto& file : std::filesystem::directory_iterator(data / "kitti_object/training/calib")) {
    const auto object = load_calibration(file.path().string());
    EXPECT_EQ(object.format, "KITTI object calib.txt");
    EXPECT_NEAR(object.camera.baseline_m, 0.5325, 1e-3) << file.path();
  }
  const auto eth = load_calibration((data / "eth_bahnhof/rectified/extrinsics.yml").string());
  EXPECT_NEAR(eth.camera.baseline_m, 0.4006, 1e-4);
  EXPECT_EQ(eth.camera.height_px, 480);
}

}  // namespace
}  // namespace flies
