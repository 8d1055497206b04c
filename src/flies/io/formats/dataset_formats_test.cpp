// Calibrations of data sets and of toolboxes that have names of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::body_from_left;
using flies::testing::body_from_right;
using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::focal_and_centre;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::rectified;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Frames are those of the rig; events are elsewhere.
std::string dsec(const ToyRig& rig, const std::string& reprojection) {
  const auto views = rectified(rig);
  const auto raw = [](const char* name, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format(
        "  {}:\n    camera_matrix: {}\n    camera_model: pinhole\n    distortion_coeffs: {}\n    distortion_model: "
        "radtan\n    resolution: [640, 480]\n",
        name, focal_and_centre(m), list({d.begin(), d.begin() + 4}));
  };
  const auto straight = [](const char* name, const cv::Mat& p) {
    return fmt::format("  {}:\n    camera_matrix: {}\n    resolution: [640, 480]\n", name,
                       focal_and_centre(cv::Matx33d(p.colRange(0, 3))));
  };
  return "intrinsics:\n" + raw("cam1", rig.m1, rig.d1) + raw("cam2", rig.m2, rig.d2) + straight("camRect1", views.p1) +
         straight("camRect2", views.p2) + "extrinsics:\n  T_10: " + rows(body_from_left()) +
         "\n  T_21: " + rows(right_from_left(rig)) + "\n" + reprojection;
}

TEST(DatasetFormats, DsecIsRectifiedUnlessItsImagesAreRaw) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto views = rectified(rig);
  const auto file = folder.write("c", dsec(rig, "disparity_to_depth:\n  cams_12: " + rows(views.q) + "\n"));
  const auto calibration = load_calibration(file);
  EXPECT_FALSE(calibration.rectifier);
  EXPECT_DOUBLE_EQ(calibration.camera.fx_px, views.p1.at<double>(0, 0));
  EXPECT_DOUBLE_EQ(calibration.camera.cx_px, views.p1.at<double>(0, 2));
  EXPECT_DOUBLE_EQ(calibration.camera.cx_right_px, views.p2.at<double>(0, 2));
  EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(rig.t), 1e-9);
  EXPECT_EQ(calibration.camera.width_px, 640);
  expect_rectifies(load_calibration(file, of_raw_images()), rig);
}

TEST(DatasetFormats, DsecNamesWhatIsMissing) {
  const TemporaryFolder folder;
  const ToyRig rig;
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", dsec(rig, ""))); }),
              HasSubstr("disparity_to_depth.cams_12: is missing"));
  cv::Mat q = rectified(rig).q;
  q.at<double>(2, 3) *= 2.0;
  EXPECT_THAT(
      error_of([&] { load_calibration(folder.write("c", dsec(rig, "disparity_to_depth:\n  cams_12: " + rows(q)))); }),
      HasSubstr("expected that of intrinsics.camRect1 and intrinsics.camRect2"));
}

TEST(DatasetFormats, ArgoverseSaysWhereItsCamerasStandOnTheVehicle) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto camera = [](const char* name, const cv::Matx33d& m, const cv::Mat& pose) {
    cv::Vec3d turn;
    cv::Rodrigues(pose(cv::Rect(0, 0, 3, 3)), turn);
    const double angle = cv::norm(turn);
    const cv::Vec3d q = turn / angle * std::sin(angle / 2);
    return fmt::format(
        R"({{"key": "image_raw_{}", "value": {{"focal_length_x_px_": {}, "focal_length_y_px_": {}, )"
        R"("focal_center_x_px_": {}, "focal_center_y_px_": {}, "skew_": 0, "distortion_coefficients_": [-0.2, 0.04, 0], )"
        R"("vehicle_SE3_camera_": {{"rotation": {{"coefficients": {}}}, "translation": {}}}}}}})",
        name, m(0, 0), m(1, 1), m(0, 2), m(1, 2), list({std::cos(angle / 2), q[0], q[1], q[2]}),
        list({pose.at<double>(0, 3), pose.at<double>(1, 3), pose.at<double>(2, 3)}));
  };
  const std::string ring = camera("ring_front_left", rig.m2, body_from_left()),
                    left = camera("stereo_front_left", rig.m1, body_from_left()),
                    right = camera("stereo_front_right", rig.m2, body_from_right(rig));
  CalibrationRequest request;
  request.width_px = 640;
  request.height_px = 480;
  ToyRig radial = rig;
  radial.d1 = radial.d2 = {-0.2, 0.04, 0.0, 0.0, 0.0};
  const auto text = "{\"camera_data_\": [" + ring + ", " + right + ", " + left + "]}";
  expect_rectifies(load_calibration(folder.write("c", text), request), radial);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", "{\"camera_data_\": [" + left + "]}"), request); }),
              HasSubstr("camera_data_: has no camera stereo_front_right"));
}

TEST(DatasetFormats, BouguetsToolboxIsReadAsTextAndAsJson) {
  const TemporaryFolder folder;
  const ToyRig rig;
  cv::Vec3d om;
  cv::Rodrigues(rig.r, om);
  const auto column = [](const std::vector<double>& values) { return fmt::format("[ {} ]", fmt::join(values, " ; ")); };
  const auto camera = [&](const char* side, const cv::Matx33d& m, const std::vector<double>& d, auto entry) {
    return entry(std::string("fc_") + side, {m(0, 0), m(1, 1)}) + entry(std::string("cc_") + side, {m(0, 2), m(1, 2)}) +
           entry(std::string("alpha_c_") + side, {0.0}) + entry(std::string("kc_") + side, d);
  };
  const auto whole = [&](auto entry) {
    return camera("left", rig.m1, rig.d1, entry) + camera("right", rig.m2, rig.d2, entry) +
           entry("om", {om[0], om[1], om[2]}) + entry("T", {1e3 * rig.t[0], 1e3 * rig.t[1], 1e3 * rig.t[2]}) +
           entry("nx", {640}) + entry("ny", {480});
  };
  const auto as_text = whole([&](const std::string& name, const std::vector<double>& values) {
    return name + " = " + column(values) + ";  % of the board, = 1\n";
  });
  const auto as_yaml = whole(
      [&](const std::string& name, const std::vector<double>& values) { return name + ": " + list(values) + "\n"; });
  for (const auto& text : {"% Stereo calibration\n\n" + as_text, as_yaml}) {
    SCOPED_TRACE(text);
    const auto calibration = load_calibration(folder.write("Calib_Results_stereo.m", text));
    EXPECT_EQ(calibration.format, "Bouguet's toolbox");
    EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("T is taken as millimetres")));
    expect_rectifies(calibration, rig);
  }
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", "fc_left: [420, 420]\ncc_left: [320, 240]\n")); }),
              HasSubstr("kc_left: is missing"));
}

}  // namespace
}  // namespace flies
