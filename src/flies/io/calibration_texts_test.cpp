#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/toy_rig.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kExact = 1e-12;  // numbers are written with all their digits

Calibration rectified() {
  Calibration calibration;
  calibration.camera = {.fx_px = 721.5377,
                        .fy_px = 721.6,
                        .cx_px = 609.5593,
                        .cx_right_px = 601.25,
                        .cy_px = 172.854,
                        .baseline_m = 0.5327254,
                        .width_px = 1242,
                        .height_px = 375,
                        .mount = {.height_m = 1.2, .pitch_rad = 0.05, .roll_rad = -0.01}};
  return calibration;
}

/// Raw cameras as a calibration has them after it was read.
Calibration raw(const ToyRig& rig) {
  const auto camera = [&](const cv::Matx33d& m, const std::vector<double>& d) {
    RawCamera one{{}, d, rig.lens};
    std::copy_n(m.val, 9, one.matrix.begin());
    return one;
  };
  RawStereo stereo{640, 480, camera(rig.m1, rig.d1), camera(rig.m2, rig.d2), {}, {rig.t[0], rig.t[1], rig.t[2]}};
  std::copy_n(rig.r.val, 9, stereo.rotation.begin());
  Calibration calibration;
  calibration.rectifier.emplace(stereo, "test");
  calibration.camera = calibration.rectifier->camera();
  return calibration;
}

void expect_same(const StereoCamera& a, const StereoCamera& b) {
  EXPECT_EQ(a.fx_px, b.fx_px);
  EXPECT_EQ(a.fy_px, b.fy_px);
  EXPECT_EQ(a.cx_px, b.cx_px);
  EXPECT_EQ(a.cx_right_px, b.cx_right_px);
  EXPECT_EQ(a.cy_px, b.cy_px);
  EXPECT_NEAR(a.baseline_m, b.baseline_m, kExact);
}

TEST(CalibrationTexts, RectifiedCamerasComeBackFromEveryFormat) {
  const TemporaryFolder folder;
  const auto calibration = rectified();
  for (const auto syntax :
       {CalibrationSyntax::kitti, CalibrationSyntax::opencv, CalibrationSyntax::ros, CalibrationSyntax::yaml}) {
    const auto texts = calibration_texts(calibration, syntax);
    EXPECT_EQ(texts.right.empty(), syntax != CalibrationSyntax::ros);
    if (!texts.right.empty()) folder.write("right.yaml", texts.right);
    const auto back = load_calibration(folder.write("left.yaml", texts.text));
    SCOPED_TRACE(back.format);
    expect_same(back.camera, calibration.camera);
    EXPECT_EQ(back.camera.width_px, syntax == CalibrationSyntax::kitti ? 0 : 1242);
    EXPECT_FALSE(back.rectifier.has_value());
    if (syntax == CalibrationSyntax::yaml) {
      EXPECT_NEAR(back.camera.mount.pitch_rad, 0.05, kExact);
    }
  }
}

TEST(CalibrationTexts, RawCamerasComeBackFromOpenCvAndRos) {
  const TemporaryFolder folder;
  ToyRig rational;
  rational.d1 = rational.d2 = {-0.3, 0.08, 0.0005, -0.0003, 0.01, -0.02, 0.01, 0.001};
  for (const auto& rig : {ToyRig(), rational, ToyRig::fisheye()}) {
    const auto calibration = raw(rig);
    expect_rectifies(
        load_calibration(folder.write("c", calibration_texts(calibration, CalibrationSyntax::opencv).text)), rig);
    const auto ros = calibration_texts(calibration, CalibrationSyntax::ros);
    CalibrationRequest request;
    request.right_path = folder.write("b", ros.right);
    request.images_are_raw = true;
    expect_rectifies(load_calibration(folder.write("a", ros.text), request), rig);
  }
}

TEST(CalibrationTexts, RefusesWhatAFormatHasNoPlaceFor) {
  EXPECT_THAT(error_of([] { calibration_texts(raw(ToyRig()), CalibrationSyntax::kitti); }), HasSubstr("raw images"));
  EXPECT_THAT(error_of([] { calibration_texts(raw(ToyRig()), CalibrationSyntax::yaml, "rig.yml"); }),
              AllOf(HasSubstr("rig.yml"), HasSubstr("raw images")));
  const auto sphere = raw(ToyRig::of(Lens::double_sphere, {-0.24, 0.57}, 260));
  EXPECT_THAT(error_of([&] { calibration_texts(sphere, CalibrationSyntax::opencv); }), HasSubstr("double sphere"));
  Calibration unsized = rectified();
  unsized.camera.width_px = 0;
  for (const auto syntax : {CalibrationSyntax::ros, CalibrationSyntax::yaml})
    EXPECT_THAT(error_of([&] { calibration_texts(unsized, syntax); }), HasSubstr("image size: is missing"));
}

}  // namespace
}  // namespace flies
