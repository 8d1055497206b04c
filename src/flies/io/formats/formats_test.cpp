// One example of each format of raw cameras, written as its documentation says, of a rig that is known; and the small
// formats of rectified ones.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/toy_rig.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::HasSubstr;

constexpr double kWritten_m = 1e-6;

CalibrationRequest of_raw_images() {
  CalibrationRequest request;
  request.images_are_raw = true;
  return request;
}

std::string list(const std::vector<double>& numbers) { return fmt::format("[{}]", fmt::join(numbers, ", ")); }

std::vector<double> numbers(const cv::Mat& m) {
  cv::Mat flat = m.clone().reshape(1, 1);
  return std::vector<double>(flat.begin<double>(), flat.end<double>());
}

std::string rows(const cv::Mat& m) {
  std::string text;
  for (int i = 0; i < m.rows; ++i) text += (i > 0 ? ", " : "") + list(numbers(m.row(i)));
  return "[" + text + "]";
}

/// right_from_left as a 4 x 4 matrix.
cv::Mat right_from_left(const ToyRig& rig) {
  cv::Mat pose = cv::Mat::eye(4, 4, CV_64F);
  cv::Mat(rig.r).copyTo(pose(cv::Rect(0, 0, 3, 3)));
  cv::Mat(rig.t).copyTo(pose(cv::Rect(3, 0, 1, 3)));
  return pose;
}

/// Where the left camera stands in the frame of a body.
cv::Mat body_from_left() {
  cv::Mat pose = cv::Mat::eye(4, 4, CV_64F);
  cv::Matx33d turn;
  cv::Rodrigues(cv::Vec3d(0.3, -1.2, 0.5), turn);
  cv::Mat(turn).copyTo(pose(cv::Rect(0, 0, 3, 3)));
  cv::Mat(cv::Vec3d(0.2, -0.1, 0.05)).copyTo(pose(cv::Rect(3, 0, 1, 3)));
  return pose;
}

cv::Mat body_from_right(const ToyRig& rig) { return body_from_left() * right_from_left(rig).inv(); }

std::string focal_and_centre(const cv::Matx33d& m) { return list({m(0, 0), m(1, 1), m(0, 2), m(1, 2)}); }

std::string kalibr(const ToyRig& rig, const std::string& model) {
  const auto camera = [&](const cv::Matx33d& m, const std::vector<double>& d) {
    return "  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: " +
           list(std::vector<double>(d.begin(), d.begin() + 4)) + "\n  distortion_model: " + model +
           "\n  intrinsics: " + focal_and_centre(m) + "\n  resolution: [640, 480]\n  rostopic: /image_raw\n";
  };
  std::string pose;
  for (int i = 0; i < 4; ++i) pose += "  - " + list(numbers(right_from_left(rig).row(i))) + "\n";
  return "cam0:\n" + camera(rig.m1, rig.d1) + "cam1:\n  T_cn_cnm1:\n" + pose + camera(rig.m2, rig.d2);
}

TEST(Formats, KalibrOfPinholesAndFisheyesRectifies) {
  const TemporaryFolder folder;
  const auto pinhole = load_calibration(folder.write("c", kalibr(ToyRig(), "radtan")));
  EXPECT_EQ(pinhole.format, "Kalibr camchain");
  EXPECT_NEAR(pinhole.camera.baseline_m, cv::norm(ToyRig().t), kWritten_m);
  expect_rectifies(pinhole, ToyRig());
  expect_rectifies(load_calibration(folder.write("c", kalibr(ToyRig::fisheye(), "equidistant"))), ToyRig::fisheye());
}

TEST(Formats, KalibrTakesTheCamerasThatAreAskedFor) {
  const TemporaryFolder folder;
  const auto path = folder.write("c", kalibr(ToyRig(), "radtan"));
  CalibrationRequest request;
  request.cameras = {1, 0};
  EXPECT_THAT(error_of([&] { load_calibration(path, request); }), HasSubstr("swapped"));
}

TEST(Formats, KalibrOfOtherLensesRectifies) {
  const TemporaryFolder folder;
  struct Other {
    Lens lens;
    std::string model;
    std::vector<double> own;
    std::vector<double> bent;
    double focal_px;
  };
  for (const Other& other :
       {Other{Lens::double_sphere, "ds", {-0.24, 0.57}, {}, 260}, Other{Lens::unified, "eucm", {0.6, 1.1}, {}, 420},
        Other{Lens::mei, "omni", {1.5}, {-0.1, 0.05, 0.001, -0.001}, 1000}}) {
    auto all = other.own;
    all.insert(all.end(), other.bent.begin(), other.bent.end());
    const ToyRig rig = ToyRig::of(other.lens, all, other.focal_px);
    const auto camera = [&](const cv::Matx33d& m) {
      auto intrinsics = other.own;
      for (const double number : {m(0, 0), m(1, 1), m(0, 2), m(1, 2)}) intrinsics.push_back(number);
      return "  camera_model: " + other.model + "\n  intrinsics: " + list(intrinsics) + "\n  resolution: [640, 480]\n" +
             (other.bent.empty() ? "  distortion_model: none\n"
                                 : "  distortion_model: radtan\n  distortion_coeffs: " + list(other.bent) + "\n");
    };
    SCOPED_TRACE(other.model);
    expect_rectifies(load_calibration(folder.write("c", "cam0:\n" + camera(rig.m1) + "cam1:\n  T_cn_cnm1: " +
                                                            rows(right_from_left(rig)) + "\n" + camera(rig.m2))),
                     rig);
  }
}

std::string sensor(const cv::Mat& pose, const cv::Matx33d& m, const std::vector<double>& d, const std::string& model) {
  return "%YAML:1.0\n# General sensor definitions.\ncamera_id: left_cam\nT_BS:\n  cols: 4\n  rows: 4\n  data: " +
         list(numbers(pose)) +
         "\nrate_hz: 20\nresolution: [640, 480]\ncamera_model: pinhole\nintrinsics: " + focal_and_centre(m) +
         " #fu, fv, cu, cv\ndistortion_model: " + model + "\ndistortion_coefficients: " + list(d) + "\n";
}

TEST(Formats, EurocFindsTheOtherCameraAndRectifies) {
  const TemporaryFolder folder;
  for (const auto& [rig, model] :
       {std::pair{ToyRig(), "radial-tangential"}, std::pair{ToyRig::fisheye(), "equidistant"}}) {
    const auto cut = [](std::vector<double> d) { return std::vector<double>(d.begin(), d.begin() + 4); };
    std::filesystem::create_directories(folder.file("cam0"));
    std::filesystem::create_directories(folder.file("cam1"));
    folder.write("cam1/sensor.yaml", sensor(body_from_right(rig), rig.m2, cut(rig.d2), model));
    const auto path = folder.write("cam0/sensor.yaml", sensor(body_from_left(), rig.m1, cut(rig.d1), model));
    const auto calibration = load_calibration(path);
    EXPECT_EQ(calibration.format, "EuRoC sensor.yaml pair");
    expect_rectifies(calibration, rig);
  }
}

std::string keyed(const std::string& prefix, std::initializer_list<std::pair<const char*, double>> values) {
  std::string text;
  for (const auto& [key, value] : values) text += fmt::format("{}{}: {}\n", prefix, key, value);
  return text;
}

std::string opencv_matrix(const std::string& key, const cv::Mat& m) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n", key, m.rows, m.cols,
                     list(numbers(m)));
}

TEST(Formats, OrbSlam3RectifiesPinholesAndFisheyes) {
  const TemporaryFolder folder;
  for (const bool is_fisheye : {false, true}) {
    const ToyRig rig = is_fisheye ? ToyRig::fisheye() : ToyRig();
    const auto camera = [&](const char* prefix, const cv::Matx33d& m, const std::vector<double>& d) {
      return keyed(prefix, {{"fx", m(0, 0)}, {"fy", m(1, 1)}, {"cx", m(0, 2)}, {"cy", m(1, 2)}}) +
             (is_fisheye ? keyed(prefix, {{"k1", d[0]}, {"k2", d[1]}, {"k3", d[2]}, {"k4", d[3]}})
                         : keyed(prefix, {{"k1", d[0]}, {"k2", d[1]}, {"p1", d[2]}, {"p2", d[3]}}));
    };
    const std::string text = std::string("%YAML:1.0\n\n#----\nFile.version: \"1.0\"\nCamera.type: \"") +
                             (is_fisheye ? "KannalaBrandt8" : "PinHole") + "\"\n" + camera("Camera1.", rig.m1, rig.d1) +
                             camera("Camera2.", rig.m2, rig.d2) +
                             "Camera.width: 640\nCamera.height: 480\nCamera.fps: 20\nStereo.ThDepth: 60.0\n" +
                             opencv_matrix("Stereo.T_c1_c2", right_from_left(rig).inv());
    const auto calibration = load_calibration(folder.write("c", text));
    EXPECT_EQ(calibration.format, "ORB-SLAM settings");
    expect_rectifies(calibration, rig);
  }
}

struct Rectified {
  cv::Mat r1, r2, p1, p2, q;
};

Rectified rectified(const ToyRig& rig) {
  Rectified result;
  if (rig.lens == Lens::equidistant)
    cv::fisheye::stereoRectify(rig.m1, rig.d1, rig.m2, rig.d2, {640, 480}, rig.r, rig.t, result.r1, result.r2,
                               result.p1, result.p2, result.q, cv::CALIB_ZERO_DISPARITY);
  else
    cv::stereoRectify(rig.m1, rig.d1, rig.m2, rig.d2, {640, 480}, rig.r, rig.t, result.r1, result.r2, result.p1,
                      result.p2, result.q);
  return result;
}

TEST(Formats, OrbSlam2RectifiesAsItsViewsSay) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto side = [](const std::string& name, const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r,
                       const cv::Mat& p) {
    return name + ".height: 480\n" + name + ".width: 640\n" + opencv_matrix(name + ".D", cv::Mat(d).t()) +
           opencv_matrix(name + ".K", cv::Mat(m)) + opencv_matrix(name + ".R", r) + opencv_matrix(name + ".P", p);
  };
  const std::string text =
      "%YAML:1.0\nCamera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\nCamera.bf: 48\n" +
      side("LEFT", rig.m1, rig.d1, to.r1, to.p1) + side("RIGHT", rig.m2, rig.d2, to.r2, to.p2);
  expect_rectifies(load_calibration(folder.write("c", text)), rig);
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

TEST(Formats, DepthAiFollowsThePosesOfSockets) {
  const TemporaryFolder folder;
  for (const bool is_fisheye : {false, true})
    for (const bool through_third : {false, true}) {
      const ToyRig rig = is_fisheye ? ToyRig::fisheye() : ToyRig();
      const auto camera = [&](int socket, const cv::Matx33d& m, std::vector<double> d, int to, const cv::Mat& pose) {
        d.resize(14, 0.0);
        return fmt::format(
            "[{}, {{\"cameraType\": {}, \"distortionCoeff\": {}, \"extrinsics\": {{\"rotationMatrix\": {}, "
            "\"specTranslation\": {{\"x\": 7.5, \"y\": 0, \"z\": 0}}, \"toCameraSocket\": {}, \"translation\": "
            "{{\"x\": {}, \"y\": {}, \"z\": {}}}}}, \"height\": 480, \"intrinsicMatrix\": {},\n\t\"lensPosition\": 0, "
            "\"width\": 640}}]",
            socket, is_fisheye ? 1 : 0, list(d), rows(pose(cv::Rect(0, 0, 3, 3))), to, 100 * pose.at<double>(0, 3),
            100 * pose.at<double>(1, 3), 100 * pose.at<double>(2, 3), rows(cv::Mat(m)));
      };
      const cv::Mat none = cv::Mat::eye(4, 4, CV_64F);
      const std::string left = through_third ? camera(1, rig.m1, rig.d1, 0, body_from_left())
                                             : camera(1, rig.m1, rig.d1, 2, right_from_left(rig));
      const std::string text = "{\"batchName\": \"\", \"boardName\": \"x\", \"cameraData\": [" +
                               camera(0, rig.m1, rig.d1, -1, none) + ", " + left + ", " +
                               camera(2, rig.m2, rig.d2, 0, body_from_right(rig)) +
                               "], \"stereoRectificationData\": {\"leftCameraSocket\": 1, \"rightCameraSocket\": 2}, "
                               "\"version\": 7}";
      const auto calibration = load_calibration(folder.write("c.json", text));
      EXPECT_EQ(calibration.format, "DepthAI calibration");
      expect_rectifies(calibration, rig);
    }
}

std::string quaternion(const cv::Mat& pose) {
  cv::Vec3d turn;
  cv::Rodrigues(pose(cv::Rect(0, 0, 3, 3)), turn);
  const double angle = cv::norm(turn);
  const cv::Vec3d q = turn / angle * std::sin(angle / 2);
  return fmt::format("{{\"px\": {}, \"py\": {}, \"pz\": {}, \"qx\": {}, \"qy\": {}, \"qz\": {}, \"qw\": {}}}",
                     pose.at<double>(0, 3), pose.at<double>(1, 3), pose.at<double>(2, 3), q[0], q[1], q[2],
                     std::cos(angle / 2));
}

TEST(Formats, BasaltOfItsLensesRectifies) {
  const TemporaryFolder folder;
  const ToyRig sphere = ToyRig::of(Lens::double_sphere, {-0.24, 0.57}, 260);
  for (const auto& [rig, type] : {std::pair{sphere, "ds"}, std::pair{ToyRig::fisheye(), "kb4"}}) {
    const bool is_sphere = rig.lens == Lens::double_sphere;
    const auto camera = [&, type = type](const cv::Matx33d& m, const std::vector<double>& d) {
      std::string text =
          fmt::format("{{\"camera_type\": \"{}\", \"intrinsics\": {{\"fx\": {}, \"fy\": {}, \"cx\": {}, \"cy\": {}",
                      type, m(0, 0), m(1, 1), m(0, 2), m(1, 2));
      text += is_sphere ? fmt::format(", \"xi\": {}, \"alpha\": {}", d[0], d[1])
                        : fmt::format(", \"k1\": {}, \"k2\": {}, \"k3\": {}, \"k4\": {}", d[0], d[1], d[2], d[3]);
      return text + "}}";
    };
    const std::string text = "{\"value0\": {\"T_imu_cam\": [" + quaternion(body_from_left()) + ", " +
                             quaternion(body_from_right(rig)) + "], \"intrinsics\": [" + camera(rig.m1, rig.d1) + ", " +
                             camera(rig.m2, rig.d2) + "], \"resolution\": [[640, 480], [640, 480]]}}";
    const auto calibration = load_calibration(folder.write("c.json", text));
    EXPECT_EQ(calibration.format, "Basalt calibration");
    expect_rectifies(calibration, rig);
  }
}

TEST(Formats, MatlabCountsFromOneAndMultipliesFromTheRight) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [&](cv::Matx33d m, const std::vector<double>& d, bool is_new) {
    m(0, 2) += 1;
    m(1, 2) += 1;
    return fmt::format(
        "{{\"RadialDistortion\": [{}, {}], \"TangentialDistortion\": [{}, {}], \"ImageSize\": [480, 640], "
        "\"WorldUnits\": \"millimeters\", \"{}\": {}}}",
        d[0], d[1], d[2], d[3], is_new ? "K" : "IntrinsicMatrix", rows(cv::Mat(is_new ? m : m.t())));
  };
  const cv::Vec3d t_mm = 1e3 * rig.t;
  for (const bool is_new : {false, true}) {
    const std::string pose =
        is_new ? fmt::format("\"PoseCamera2\": {{\"Dimensionality\": 3, \"R\": {}, \"Translation\": [{}, {}, {}]}}",
                             rows(cv::Mat(rig.r)), t_mm[0], t_mm[1], t_mm[2])
               : fmt::format("\"RotationOfCamera2\": {}, \"TranslationOfCamera2\": [{}, {}, {}]",
                             rows(cv::Mat(rig.r.t())), t_mm[0], t_mm[1], t_mm[2]);
    const auto calibration =
        load_calibration(folder.write("c.json", "{\"CameraParameters1\": " + camera(rig.m1, rig.d1, is_new) +
                                                    ", \"CameraParameters2\": " + camera(rig.m2, rig.d2, is_new) +
                                                    ", " + pose + ", \"Version\": {\"Major\": 10}}"));
    EXPECT_EQ(calibration.format, "MATLAB stereoParameters");
    EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(calibration, rig);
  }
}

std::string camera_info(const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r, const cv::Mat& p,
                        const std::string& model) {
  return fmt::format(
      "header:\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: {}\nd: {}\nk: {}\nr: {}\np: {}\n"
      "binning_x: 0\nroi:\n  x_offset: 0\n  do_rectify: false\n---\n",
      model, list(d), list(numbers(cv::Mat(m))), list(numbers(r)), list(numbers(p)));
}

TEST(Formats, Ros2CameraInfoOfRawImagesRectifies) {
  const TemporaryFolder folder;
  ToyRig rational;
  rational.d1 = {-0.3, 0.08, 0.0005, -0.0003, 0.01, -0.02, 0.01, 0.001};
  rational.d2 = {-0.29, 0.07, -0.0002, 0.0004, 0.01, -0.02, 0.01, 0.001};
  for (const auto& [rig, model] : {std::pair{ToyRig(), "plumb_bob"}, std::pair{rational, "rational_polynomial"},
                                   std::pair{ToyRig::fisheye(), "equidistant"}}) {
    SCOPED_TRACE(model);
    const auto to = rectified(rig);
    folder.write("right.yaml", camera_info(rig.m2, rig.d2, to.r2, to.p2, model));
    const auto path = folder.write("left.yaml", camera_info(rig.m1, rig.d1, to.r1, to.p1, model));
    const auto plain = load_calibration(path);
    EXPECT_FALSE(plain.rectifier.has_value());
    EXPECT_NEAR(plain.camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(load_calibration(path, of_raw_images()), rig);
  }
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

}  // namespace
}  // namespace flies
