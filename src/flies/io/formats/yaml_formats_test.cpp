// One example of each format of raw cameras that is YAML, written as its documentation says, of a rig that is known.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

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
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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

// A fisheye's four coefficients under the name of a pinhole: k3 and k4 are then read as tangential ones, or the view is
// wider than a pinhole's.
TEST(Formats, FisheyeUnderThePinholesNameIsTold) {
  const TemporaryFolder folder;
  const auto notes = [&](const ToyRig& rig, const char* model) {
    return fmt::format("{}", fmt::join(texts(load_calibration(folder.write("c", kalibr(rig, model))).notes), "; "));
  };
  EXPECT_THAT(notes(ToyRig::of(Lens::brown, {-0.0088, 0.0463, -0.0441, 0.0083}, 420), "radtan"),
              HasSubstr("cam0: a tangential coefficient p1 of -0.0441 is improbable"));
  EXPECT_THAT(notes(ToyRig::of(Lens::brown, {0.0034, 0.0008, -0.002, 0.0002}, 220), "radtan"),
              HasSubstr("cam0: a view of 122 degrees from corner to corner is improbable"));
  for (const auto& [rig, model] : {std::pair{ToyRig(), "radtan"}, std::pair{ToyRig::fisheye(), "equidistant"}})
    EXPECT_THAT(notes(rig, model), Not(HasSubstr("improbable")));
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

/// A camera file of camodocal.
std::string camodocal(const ToyRig& rig, bool is_right) {
  const auto& m = is_right ? rig.m2 : rig.m1;
  const auto& d = is_right ? rig.d2 : rig.d1;
  std::string text = "%YAML:1.0\n---\ncamera_name: camera\nimage_width: 640\nimage_height: 480\n";
  if (rig.lens == Lens::equidistant)
    return text + "model_type: KANNALA_BRANDT\nprojection_parameters:\n" +
           keyed("   ", {{"k2", d[0]},
                         {"k3", d[1]},
                         {"k4", d[2]},
                         {"k5", d[3]},
                         {"mu", m(0, 0)},
                         {"mv", m(1, 1)},
                         {"u0", m(0, 2)},
                         {"v0", m(1, 2)}});
  const bool is_mei = rig.lens == Lens::mei;
  const std::size_t own = is_mei ? 1 : 0;
  text += "model_type: " + std::string(is_mei ? "MEI" : "PINHOLE") + "\ndistortion_parameters:\n" +
          keyed("   ", {{"k1", d[own]}, {"k2", d[own + 1]}, {"p1", d[own + 2]}, {"p2", d[own + 3]}});
  if (!is_mei)
    return text + "projection_parameters:\n" +
           keyed("   ", {{"fx", m(0, 0)}, {"fy", m(1, 1)}, {"cx", m(0, 2)}, {"cy", m(1, 2)}});
  return text + "mirror_parameters:\n" + keyed("   ", {{"xi", d[0]}}) + "projection_parameters:\n" +
         keyed("   ", {{"gamma1", m(0, 0)}, {"gamma2", m(1, 1)}, {"u0", m(0, 2)}, {"v0", m(1, 2)}});
}

TEST(Formats, VinsFusionHasRationalLensesToo) {
  const TemporaryFolder folder;
  ToyRig rig;
  rig.d1 = {-0.2, 0.05, 0.0005, -0.0003, 0.01, 0.02, 0.01, 0.005};
  rig.d2 = {-0.21, 0.06, -0.0002, 0.0004, 0.012, 0.018, 0.011, 0.004};
  const auto camera = [&](bool is_right, const std::string& model) {
    const auto& m = is_right ? rig.m2 : rig.m1;
    const auto& d = is_right ? rig.d2 : rig.d1;
    return "%YAML:1.0\n---\nmodel_type: " + model + "\nimage_width: 640\nimage_height: 480\ndistortion_parameters:\n" +
           keyed("   ", {{"k1", d[0]},
                         {"k2", d[1]},
                         {"k3", d[4]},
                         {"k4", d[5]},
                         {"k5", d[6]},
                         {"k6", d[7]},
                         {"p1", d[2]},
                         {"p2", d[3]}}) +
           "projection_parameters:\n" +
           keyed("   ", {{"fx", m(0, 0)}, {"fy", m(1, 1)}, {"cx", m(0, 2)}, {"cy", m(1, 2)}});
  };
  const auto path =
      folder.write("stereo.yaml", "%YAML:1.0\n---\ncam0_calib: \"cam0.yaml\"\ncam1_calib: \"cam1.yaml\"\n" +
                                      opencv_matrix("body_T_cam0", body_from_left()) +
                                      opencv_matrix("body_T_cam1", body_from_right(rig)));
  for (const bool is_right : {false, true})
    folder.write(is_right ? "cam1.yaml" : "cam0.yaml", camera(is_right, "PINHOLE_FULL"));
  expect_rectifies(load_calibration(path), rig);
  folder.write("cam0.yaml", camera(false, "SCARAMUZZA"));
  EXPECT_THAT(error_of([&] { load_calibration(path); }), HasSubstr("expected PINHOLE, PINHOLE_FULL, MEI or KANNALA"));
}

TEST(Formats, VinsFusionReadsTheFilesThatItNamesAndRectifies) {
  const TemporaryFolder folder;
  for (const auto& rig : {ToyRig(), ToyRig::fisheye(), ToyRig::of(Lens::mei, {1.5, -0.1, 0.05, 0.001, -0.001}, 1000)}) {
    SCOPED_TRACE(lens_name(rig.lens));
    folder.write("cam0_any.yaml", camodocal(rig, false));
    folder.write("cam1_any.yaml", camodocal(rig, true));
    const auto path = folder.write("stereo.yaml",
                                   "%YAML:1.0\n---\nimu: 0\nnum_of_cam: 2\ncam0_calib: \"cam0_any.yaml\"\n"
                                   "cam1_calib: \"cam1_any.yaml\"\nimage_width: 640\nimage_height: 480\n" +
                                       opencv_matrix("body_T_cam0", body_from_left()) +
                                       opencv_matrix("body_T_cam1", body_from_right(rig)));
    const auto calibration = load_calibration(path);
    EXPECT_EQ(calibration.format, "VINS-Fusion configuration");
    expect_rectifies(calibration, rig);
  }
  // The left camera is the body, whose pose is its own transpose: that of the right one tells that it is transposed.
  const ToyRig rig;
  folder.write("cam0_any.yaml", camodocal(rig, false));
  folder.write("cam1_any.yaml", camodocal(rig, true));
  const auto transposed = load_calibration(
      folder.write("transposed.yaml", "%YAML:1.0\n---\ncam0_calib: \"cam0_any.yaml\"\ncam1_calib: \"cam1_any.yaml\"\n" +
                                          opencv_matrix("body_T_cam0", cv::Mat::eye(4, 4, CV_64F)) +
                                          opencv_matrix("body_T_cam1", right_from_left(rig).inv().t())));
  EXPECT_THAT(fmt::format("{}", fmt::join(texts(transposed.notes), "; ")), HasSubstr("body_T_cam1 is transposed"));
  expect_rectifies(transposed, rig);
  CalibrationRequest of_both;
  of_both.right_path = folder.file("cam1_any.yaml");
  for (const auto& request : {CalibrationRequest(), of_both})
    EXPECT_THAT(error_of([&] { load_calibration(folder.file("cam0_any.yaml"), request); }),
                HasSubstr("body_T_cam0, body_T_cam1: are missing: this file describes one camera"));
  EXPECT_THAT(error_of([&] { load_calibration(folder.file("stereo.yaml"), of_both); }),
              HasSubstr("right calibration: is not used"));
  std::filesystem::remove(folder.file("cam1_any.yaml"));
  EXPECT_THAT(error_of([&] { load_calibration(folder.file("stereo.yaml")); }),
              AllOf(HasSubstr("stereo.yaml: cam1_calib: names"), HasSubstr("cam1_any.yaml, which is not there")));
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

}  // namespace
}  // namespace flies
