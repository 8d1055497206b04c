// Calibrations as they lie in public repositories: formats of programs that hand on what others wrote, older and looser
// forms of the formats beside, and lenses at the limits of what is rectified.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <tuple>

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
using flies::testing::focal_and_centre;
using flies::testing::kWritten_m;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::opencv_matrix;
using flies::testing::rectified;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<double> four_of(const std::vector<double>& coefficients) {
  return {coefficients.begin(), coefficients.begin() + 4};
}

/// ORB-SLAM2's settings of raw images.
/// @param after what stands after the key of a matrix's numbers, and of its last line
std::string orb_slam2(const ToyRig& rig, const char* after, double bf, bool has_baseline_in_p) {
  auto to = rectified(rig);
  if (!has_baseline_in_p) to.p2.at<double>(0, 3) = 0.0;
  const auto side = [&](const std::string& name, const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r,
                        const cv::Mat& p) {
    return name + ".height: 480\n" + name + ".width: 640\n" + opencv_matrix(name + ".D", cv::Mat(d).t(), after) +
           opencv_matrix(name + ".K", cv::Mat(m), after) + opencv_matrix(name + ".R", r, after) +
           opencv_matrix(name + ".P", p, after);
  };
  return fmt::format("%YAML:1.0\nCamera.fx: {}\nCamera.bf: {}\n", to.p1.at<double>(0, 0), bf) +
         side("LEFT", rig.m1, rig.d1, to.r1, to.p1) + side("RIGHT", rig.m2, rig.d2, to.r2, to.p2) + "Viewer.PointSize" +
         after + "2\n";
}

// As in ORB-SLAM2's own EuRoC.yaml.
TEST(FoundFormats, OpenCvsYamlNeedsNoBlankBehindColons) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const double bf = rectified(rig).p1.at<double>(0, 0) * cv::norm(rig.t);
  const auto calibration = load_calibration(folder.write("c", orb_slam2(rig, ":", bf, true)));
  expect_rectifies(calibration, rig);
  EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("Camera.bf"))));
}

TEST(FoundFormats, OrbSlam2TakesTheBaselineFromBfWhereItIsNotInP) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const double bf = rectified(rig).p1.at<double>(0, 0) * cv::norm(rig.t);
  expect_rectifies(load_calibration(folder.write("c", orb_slam2(rig, ": ", bf, false))), rig);
  EXPECT_THAT(texts(load_calibration(folder.write("c", orb_slam2(rig, ": ", 2.0 * bf, true))).notes),
              Contains(HasSubstr("Camera.bf gives a baseline of 0.24")));
  EXPECT_THAT(error_of([&] {
                load_calibration(
                    folder.write("c", orb_slam2(rig, ": ", bf, true) + "Camera.width: 1280\nCamera.height: 720\n"));
              }),
              HasSubstr("found 640 x 480 px, and Camera.width, Camera.height say 1280 x 720"));
}

// Lenses that see more than a hemisphere: what a rectified image can show of them stays.
TEST(FoundFormats, WideFisheyesKeepTheirMiddle) {
  const TemporaryFolder folder;
  ToyRig rig = ToyRig::fisheye();
  rig.d1 = rig.d2 = {-0.0088, 0.0463, -0.0441, 0.0083};
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) (*m)(0, 0) = (*m)(1, 1) = 200.0;
  const auto camera = [&](const cv::Matx33d& m) {
    return "  camera_model: pinhole\n  distortion_model: equidistant\n  distortion_coeffs: " + list(rig.d1) +
           "\n  intrinsics: " + focal_and_centre(m) + "\n  resolution: [640, 480]\n";
  };
  const auto calibration = load_calibration(folder.write(
      "c", "cam0:\n" + camera(rig.m1) + "cam1:\n  T_cn_cnm1: " + rows(right_from_left(rig)) + "\n" + camera(rig.m2)));
  EXPECT_NEAR(calibration.camera.fx_px, kWidestRectified * 640, 1.0);
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("the lenses see farther to the side")));
  expect_rectifies(calibration, rig);
}

// The coefficients of an OAK-D, whose numerator and denominator nearly cancel: its pole lies within the image, and the
// way back from pixels to rays ends anywhere near it.
TEST(FoundFormats, RationalLensesWithAPoleKeepTheirView) {
  const TemporaryFolder folder;
  const std::string d1 = "[-5.44174, 17.0929, 0.0027160, 0.00038628, -17.89192, -5.490628, 17.30108, -18.10564]";
  const std::string d2 = "[-5.452312, 17.91807, 0.0013283, 0.00023385, -19.15149, -5.501633, 18.12929, -19.36841]";
  for (const double cx_px : {636.0, 637.0, 637.51, 638.0, 638.5, 639.0}) {
    const auto camera =
        load_calibration(
            folder.write("c.yml",
                         fmt::format("image_width: 1280\nimage_height: 800\n"
                                     "M1: [860.19, 0, 645.365, 0, 861.012, 398.675, 0, 0, 1]\nD1: {}\n"
                                     "M2: [861.689, 0, {}, 0, 862.326, 393.494, 0, 0, 1]\nD2: {}\n"
                                     "R: [0.99997908, -0.00243729, 0.00599561, 0.00236053, 0.9999156, 0.01277546, "
                                     "-0.00602625, -0.01276104, 0.9999004]\nT: [-0.0744580, -0.0011005, 0.0005362]\n",
                                     d1, cx_px, d2)))
            .camera;
    EXPECT_GT(camera.fx_px, 860.0) << cx_px;
    EXPECT_LT(camera.fx_px, 920.0) << cx_px;
  }
}

TEST(FoundFormats, BothCamerasHaveOneSize) {
  const TemporaryFolder folder;
  const std::string camera =
      R"(, {"cameraType": 0, "distortionCoeff": [0, 0, 0, 0, 0], "intrinsicMatrix": [[800, 0, 640], [0, 800, 400], )"
      R"([0, 0, 1]], "width": 1280, "height": )";
  const std::string pose =
      R"(, "extrinsics": {"rotationMatrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "toCameraSocket": 2, "translation": )"
      R"({"x": -7.5, "y": 0, "z": 0}}}])";
  EXPECT_THAT(error_of([&] {
                load_calibration(folder.write(
                    "c.json", R"({"cameraData": [[1)" + camera + "800" + pose + ", [2" + camera + "720" + "}]]}"));
              }),
              HasSubstr("cameraData.1.1.width, height: found 1280 x 720 px, expected 1280 x 800 px"));
  EXPECT_THAT(error_of([&] {
                load_calibration(folder.write("c.txt",
                                              "S_rect_02: 1242 375\nP_rect_02: 700 0 600 0 0 700 170 0 0 0 1 0\n"
                                              "S_rect_03: 1238 374\nP_rect_03: 700 0 600 -378 0 700 170 0 0 0 1 0\n"));
              }),
              HasSubstr("S_rect_03: found 1238 x 374 px, expected 1242 x 375 px"));
}

// As firmware of 2016 wrote it.
TEST(FoundFormats, ZedOfEarlyYearsHasRadialCoefficientsAlone) {
  const TemporaryFolder folder;
  const std::string camera = "cx=640\ncy=360\nfx=700\nfy=700\nk1=-0.17\nk2=0.024\n";
  const auto calibration =
      load_calibration(folder.write("SN1.conf", "[LEFT_CAM_HD]\n" + camera + "[RIGHT_CAM_HD]\n" + camera +
                                                    "[STEREO]\nBaseLine=120\nCV_HD=0.02\nRX_HD=0.004\nRZ_HD=-0.001\n"));
  EXPECT_EQ(calibration.format, "ZED SN.conf");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.12, kWritten_m);
}

TEST(FoundFormats, MatricesBesideABaselineAreOpenCvs) {
  const TemporaryFolder folder;
  const auto calibration = load_calibration(
      folder.write("c",
                   "image_width: 640\nimage_height: 480\nP1: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n"
                   "P2: [400, 0, 320, -48, 0, 400, 240, 0, 0, 0, 1, 0]\nbaseline_m: 0.12\n"));
  EXPECT_EQ(calibration.format, "OpenCV stereo");
  EXPECT_NEAR(calibration.camera.baseline_m, 0.12, kWritten_m);
}

TEST(FoundFormats, OmnidirectionalFilesOfOpenCvNameTheirMirrors) {
  const TemporaryFolder folder;
  const ToyRig rig = ToyRig::of(Lens::mei, {1.5, -0.1, 0.05, 0.001, -0.001}, 1000);
  const std::vector<double> bent(rig.d1.begin() + 1, rig.d1.end());
  const std::string text =
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n" + opencv_matrix("camera_matrix_1", cv::Mat(rig.m1)) +
      opencv_matrix("distortion_coefficients_1", cv::Mat(bent).t()) +
      opencv_matrix("xi_1", cv::Mat_<double>(1, 1) << 1.5) + opencv_matrix("camera_matrix_2", cv::Mat(rig.m2)) +
      opencv_matrix("distortion_coefficients_2", cv::Mat(bent).t()) +
      opencv_matrix("xi_2", cv::Mat_<double>(1, 1) << 1.5) + opencv_matrix("R", cv::Mat(rig.r)) +
      opencv_matrix("T", cv::Mat(rig.t));
  expect_rectifies(load_calibration(folder.write("c", text)), rig);
  const std::string model = "camera_model: omni\ndistortion_model: radtan\n";
  expect_rectifies(load_calibration(folder.write("c", text + model)), rig);
}

TEST(FoundFormats, LensesWithoutCoefficientsAreTakenAsFreeOfDistortion) {
  const TemporaryFolder folder;
  ToyRig rig;
  rig.d1 = rig.d2 = {0.0, 0.0, 0.0, 0.0, 0.0};
  const auto calibration = load_calibration(folder.write(
      "c.json",
      fmt::format("{{\"width\": 640, \"height\": 480, \"left_intrinsics\": {}, \"right_intrinsics\": {}, "
                  "\"rotation_left_to_right\": {}, \"translation_left_to_right\": {}}}",
                  rows(cv::Mat(rig.m1)), rows(cv::Mat(rig.m2)), rows(cv::Mat(rig.r)), list(numbers(cv::Mat(rig.t))))));
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("no distortion coefficients")));
  expect_rectifies(calibration, rig);
}

TEST(FoundFormats, StellaVslamOfRectifiedAndOfRawImages) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const std::string camera = fmt::format(
      "Camera:\n  name: \"x\"\n  setup: \"stereo\"\n  model: \"perspective\"\n  fx: {0}\n  fy: {0}\n  cx: {1}\n"
      "  cy: {2}\n  cols: 640\n  rows: 480\n  focal_x_baseline: {3}\n",
      to.p1.at<double>(0, 0), to.p1.at<double>(0, 2), to.p1.at<double>(1, 2), -to.p2.at<double>(0, 3));
  const auto plain = load_calibration(folder.write("c", camera));
  EXPECT_EQ(plain.format, "stella_vslam settings");
  EXPECT_FALSE(plain.rectifier.has_value());
  EXPECT_NEAR(plain.camera.baseline_m, cv::norm(rig.t), kWritten_m);
  const auto raw = load_calibration(folder.write(
      "c", camera + "StereoRectifier:\n  K_left: " + list(numbers(cv::Mat(rig.m1))) + "\n  D_left: " + list(rig.d1) +
               "\n  R_left: " + list(numbers(to.r1)) + "\n  K_right: " + list(numbers(cv::Mat(rig.m2))) +
               "\n  D_right: " + list(rig.d2) + "\n  R_right: " + list(numbers(to.r2)) + "\n"));
  expect_rectifies(raw, rig);
}

TEST(FoundFormats, PosesInTheFrameOfABody) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto okvis = [&](const cv::Mat& pose, const cv::Matx33d& m, const std::vector<double>& d) {
    return "     - {T_SC:\n        " + list(numbers(pose)) +
           ",\n        image_dimension: [640, 480],\n        distortion_coefficients: " + list(four_of(d)) +
           ",\n        distortion_type: radialtangential,\n        focal_length: " + list({m(0, 0), m(1, 1)}) +
           ",\n        principal_point: " + list({m(0, 2), m(1, 2)}) + "}\n\n";
  };
  const auto ov2slam = [&](const char* side, char end, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format(
        "Camera.model_{0}: pinhole\nCamera.{0}_nwidth: 640\nCamera.{0}_nheight: 480\nCamera.fx{1}: "
        "{2}\nCamera.fy{1}: {3}\nCamera.cx{1}: {4}\nCamera.cy{1}: {5}\nCamera.k1{1}: {6}\n"
        "Camera.k2{1}: {7}\nCamera.p1{1}: {8}\nCamera.p2{1}: {9}\n",
        side, end, m(0, 0), m(1, 1), m(0, 2), m(1, 2), d[0], d[1], d[2], d[3]);
  };
  const auto kimera = [&](const std::string& side, const cv::Mat& pose, const cv::Matx33d& m,
                          const std::vector<double>& d) {
    return side + "_camera_intrinsics: " + focal_and_centre(m) + "\n" + side +
           "_camera_distortion_coefficients: " + list(four_of(d)) + "\n" + side +
           "_camera_extrinsics: " + list(numbers(pose)) + "\n";
  };
  const auto maplab = [&](const cv::Mat& pose, const cv::Matx33d& m, const std::vector<double>& d) {
    return "- camera:\n    image_height: 480\n    image_width: 640\n    type: pinhole\n    intrinsics:\n      cols: 1\n"
           "      rows: 4\n      data: " +
           focal_and_centre(m) +
           "\n    distortion:\n      type: radial-tangential\n      parameters:\n        cols: 1\n        rows: 4\n"
           "        data: " +
           list(four_of(d)) + "\n  T_B_C:\n    cols: 4\n    rows: 4\n    data: " + list(numbers(pose)) + "\n";
  };
  const cv::Mat left = body_from_left(), right = body_from_right(rig);
  for (const auto& [format, text] :
       {std::pair<std::string, std::string>{
            "OKVIS configuration",
            "%YAML:1.0\ncameras:\n" + okvis(left, rig.m1, rig.d1) + okvis(right, rig.m2, rig.d2)},
        {"OV2SLAM parameters", "%YAML 1.0\n---\n" + ov2slam("left", 'l', rig.m1, rig.d1) +
                                   ov2slam("right", 'r', rig.m2, rig.d2) + opencv_matrix("body_T_cam0", left) +
                                   opencv_matrix("body_T_cam1", right)},
        {"Kimera's file of both cameras",
         "camera_model: pinhole\ndistortion_model: radial-tangential\n"
         "camera_resolution: [640, 480]\n" +
             kimera("left", left, rig.m1, rig.d1) + kimera("right", right, rig.m2, rig.d2)},
        {"maplab cameras",
         "label: stereo\ncameras:\n" + maplab(left, rig.m1, rig.d1) + maplab(right, rig.m2, rig.d2)}}) {
    SCOPED_TRACE(format);
    const auto calibration = load_calibration(folder.write("c", text));
    EXPECT_EQ(calibration.format, format);
    expect_rectifies(calibration, rig);
  }
}

TEST(FoundFormats, MaplabHasOtherLensesThanRadialOnes) {
  const TemporaryFolder folder;
  const auto camera = [](const ToyRig& rig, bool is_right, const std::string& type, const std::string& bent,
                         std::size_t own) {
    const auto& m = is_right ? rig.m2 : rig.m1;
    const auto& d = is_right ? rig.d2 : rig.d1;
    std::vector<double> intrinsics(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(own));
    for (const double number : {m(0, 0), m(1, 1), m(0, 2), m(1, 2)}) intrinsics.push_back(number);
    return "  - camera: {image_height: 480, image_width: 640, type: " + type +
           ", intrinsics: {data: " + list(intrinsics) + "}, distortion: {type: " + bent +
           ", parameters: {data: " + list({d.begin() + static_cast<std::ptrdiff_t>(own), d.end()}) +
           "}}}\n    T_B_C: " + list(numbers(is_right ? body_from_right(rig) : body_from_left())) + "\n";
  };
  const auto both = [&](const ToyRig& rig, const std::string& type, const std::string& bent, std::size_t own) {
    return folder.write("c", "sensors:\n- sensor_type: NCAMERA\n  cameras:\n" + camera(rig, false, type, bent, own) +
                                 camera(rig, true, type, bent, own));
  };
  for (const auto& [rig, type, bent, own] :
       {std::tuple{ToyRig::fisheye(), "pinhole", "equidistant", std::size_t{0}},
        std::tuple{ToyRig::of(Lens::fov, {0.9}, 300), "pinhole", "fisheye", std::size_t{0}},
        std::tuple{ToyRig::of(Lens::mei, {1.5, -0.1, 0.05, 0.001, -0.001}, 1000), "unified-projection",
                   "radial-tangential", std::size_t{1}}}) {
    SCOPED_TRACE(bent);
    expect_rectifies(load_calibration(both(rig, type, bent, own)), rig);
  }
  EXPECT_THAT(error_of([&] { load_calibration(both(ToyRig(), "camera-3d-lidar", "none", 0)); }),
              HasSubstr("found 'camera-3d-lidar', expected pinhole or unified-projection"));
}

TEST(FoundFormats, KalibrsFileMayStandBelowAKey) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return "    camera_model: pinhole\n    distortion_model: radtan\n    distortion_coeffs: " + list(four_of(d)) +
           "\n    intrinsics: " + focal_and_centre(m) + "\n    resolution: [640, 480]\n";
  };
  expect_rectifies(load_calibration(folder.write("c", "%YAML:1.0\n\nstereo0:\n  cam0:\n" + camera(rig.m1, rig.d1) +
                                                          "  cam1:\n    T_cn_cnm1: " + rows(right_from_left(rig)) +
                                                          "\n" + camera(rig.m2, rig.d2))),
                   rig);
}

/// What ROS's calibrator writes of a camera.
std::string ost(const std::string& name, const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r,
                const cv::Mat& p) {
  const auto matrix = [](const cv::Mat& of) {
    std::string text;
    for (int row = 0; row < of.rows; ++row) text += fmt::format("{}\n", fmt::join(numbers(of.row(row)), " "));
    return text;
  };
  return "# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[" + name + "]\n\ncamera matrix\n" +
         matrix(cv::Mat(m)) + "\ndistortion\n" + matrix(cv::Mat(d).t()) + "\nrectification\n" + matrix(r) +
         "\nprojection\n" + matrix(p);
}

TEST(FoundFormats, OstFilesOfBothCamerasAndOfOneEach) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const std::string left = ost("narrow_stereo/left", rig.m1, rig.d1, to.r1, to.p1);
  const std::string right = ost("narrow_stereo/right", rig.m2, rig.d2, to.r2, to.p2);
  folder.write("right.ini", right);
  for (const auto& path : {folder.write("ost.txt", left + right), folder.write("left.ini", left)}) {
    const auto plain = load_calibration(path);
    EXPECT_EQ(plain.format, "ROS camera_info pair");
    EXPECT_NEAR(plain.camera.baseline_m, cv::norm(rig.t), kWritten_m);
    EXPECT_EQ(plain.camera.width_px, 640);
    expect_rectifies(load_calibration(path, of_raw_images()), rig);
  }
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("ost.txt", left + right + right)); }), HasSubstr("ost.txt"));
}

TEST(FoundFormats, RawPairsInOnePlaceOrOneAboveTheOtherAreRefusedByTheirNames) {
  const TemporaryFolder folder;
  const ToyRig rig;
  auto to = rectified(rig);
  const auto complaint = [&] {
    const auto path =
        folder.write("ost.txt", ost("left", rig.m1, rig.d1, to.r1, to.p1) + ost("right", rig.m2, rig.d2, to.r2, to.p2));
    return error_of([&] { load_calibration(path, of_raw_images()); });
  };
  to.p2.at<double>(0, 3) = 0.0;
  EXPECT_THAT(complaint(), HasSubstr("both cameras are in the same place"));
  to.p2.at<double>(1, 3) = -40.0;
  EXPECT_THAT(complaint(), HasSubstr("one above the other"));
}

TEST(FoundFormats, KittiOfOnePairNeedsNoChoiceForRawImages) {
  const TemporaryFolder folder;
  std::string text;
  for (const char* n : {"00", "01"})
    text += fmt::format(
        "S_{0}: 640 480\nK_{0}: 400 0 320 0 400 240 0 0 1\nD_{0}: 0 0 0 0 0\nR_{0}: 1 0 0 0 1 0 0 0 1\n"
        "T_{0}: {1} 0 0\nS_rect_{0}: 640 480\nP_rect_{0}: 400 0 320 {2} 0 400 240 0 0 0 1 0\n",
        n, n[1] == '0' ? 0.0 : -0.12, n[1] == '0' ? 0.0 : -48.0);
  EXPECT_NEAR(load_calibration(folder.write("c", text), of_raw_images()).camera.baseline_m, 0.12, kWritten_m);
}

TEST(FoundFormats, BaselineThatIsSaidOverrulesTheFile) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.baseline_m = 0.12;
  const std::string rectified_mm =
      "image_width: 640\nimage_height: 480\nP1: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n"
      "P2: [400, 0, 320, -48000, 0, 400, 240, 0, 0, 0, 1, 0]\n";
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", rectified_mm)); }),
              HasSubstr("is it in millimetres (0.12 m)"));
  const auto plain = load_calibration(folder.write("c", rectified_mm), request);
  EXPECT_EQ(plain.camera.baseline_m, 0.12);
  EXPECT_THAT(texts(plain.notes), Contains(HasSubstr("the baseline is 0.12 m as given, not 120")));
  const auto raw =
      load_calibration(folder.write("c",
                                    "image_width: 640\nimage_height: 480\nM1: [400, 0, 320, 0, 400, 240, 0, 0, 1]\n"
                                    "D1: [0, 0, 0, 0]\nM2: [400, 0, 320, 0, 400, 240, 0, 0, 1]\nD2: [0, 0, 0, 0]\n"
                                    "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-120, 0, 0]\n"),
                       request);
  EXPECT_NEAR(raw.camera.baseline_m, 0.12, kWritten_m);
  EXPECT_NEAR(raw.rectifier->raw().translation_m[0], -0.12, kWritten_m);
  request.baseline_m = -1.0;
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", rectified_mm), request); }), HasSubstr("baseline"));
}

}  // namespace
}  // namespace flies
