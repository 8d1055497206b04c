#include "flies/diagnose/calibrated_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/diagnose/textured_pair.hpp"

namespace flies {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Rotation = std::array<double, 9>;
constexpr Rotation kNotTurned{1, 0, 0, 0, 1, 0, 0, 0, 1};

/// Pitched by three degrees: rows of 21 px.
Rotation pitched() {
  const double angle_rad = 0.052, c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {1, 0, 0, 0, c, -s, 0, s, c};
}

RawStereo rig(double right_cy_px, const Rotation& rotation) {
  const auto camera = [](double cy_px) { return RawCamera{{400, 0, 320, 0, 400, cy_px, 0, 0, 1}, {0, 0, 0, 0}}; };
  return {640, 240, camera(120), camera(right_cy_px), rotation, {-0.5, 0, 0}};
}

Calibration calibration_of(const RawStereo& raw) {
  Calibration calibration;
  calibration.rectifier.emplace(raw, "rig");
  calibration.camera = calibration.rectifier->camera();
  return calibration;
}

/// The image that the raw camera would have given.
GrayImage raw_image(const GrayImage& rectified, const StereoCamera& camera, const RawCamera& raw,
                    const Rotation& rectified_from_raw) {
  const cv::Matx33d into(raw.matrix.data()), turned(rectified_from_raw.data());
  const cv::Matx33d from(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  cv::Mat image;
  cv::warpPerspective(mat_of(rectified.view()), image, into * turned.t() * from.inv(),
                      {rectified.width_px, rectified.height_px});
  return {image.cols, image.rows, {image.begin<std::uint8_t>(), image.end<std::uint8_t>()}};
}

/// What this rig sees of a textured wall.
GrayPair seen_by(const Calibration& calibration) {
  const GrayPair wall = textured_pair(20.0, 0.0, 0.0);
  const Rectifier& rectifier = *calibration.rectifier;
  return {raw_image(wall.left, calibration.camera, rectifier.raw().left, rectifier.left_rotation()),
          raw_image(wall.right, calibration.camera, rectifier.raw().right, rectifier.right_rotation())};
}

GrayPair exchanged(GrayPair pair) {
  std::swap(pair.left, pair.right);
  return pair;
}

/// What is said of raw images that are rectified with a calibration.
std::string fault_of(const Calibration& calibration, const GrayPair& images, bool are_read_again = true) {
  const ReadPair as_read = are_read_again ? ReadPair([&] { return images; }) : ReadPair();
  try {
    check_calibrated_pair(calibration.rectifier->rectify(images).view(), calibration, as_read, "l.png", "r.png");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CheckCalibratedPair, PassesAPair) {
  for (const auto& raw : {rig(120, kNotTurned), rig(145, kNotTurned), rig(120, pitched())}) {
    const Calibration calibration = calibration_of(raw);
    EXPECT_EQ(fault_of(calibration, seen_by(calibration)), "");
  }
}

TEST(CheckCalibratedPair, NamesSwappedRawImages) {
  for (const auto& raw : {rig(145, kNotTurned), rig(120, pitched())}) {
    const Calibration calibration = calibration_of(raw);
    EXPECT_THAT(fault_of(calibration, exchanged(seen_by(calibration))),
                AllOf(HasSubstr("l.png: left and right seem to be swapped"), HasSubstr("row of r.png, as given only"),
                      Not(HasSubstr("already"))));
  }
}

TEST(CheckCalibratedPair, NamesImagesThatAreRectifiedAlready) {
  const Calibration calibration = calibration_of(rig(145, pitched()));
  EXPECT_THAT(fault_of(calibration, textured_pair(20.0, 0.0, 0.0)),
              HasSubstr("l.png: the images seem to be rectified already"));
}

TEST(CheckCalibratedPair, NamesImagesOfOneCamera) {
  const Calibration calibration = calibration_of(rig(145, pitched()));
  const GrayPair pair = seen_by(calibration);
  EXPECT_THAT(fault_of(calibration, {pair.left, pair.left}), HasSubstr("both images seem to be of the same camera"));
}

TEST(CheckCalibratedPair, NamesExchangedIntrinsics) {
  const Calibration calibration = calibration_of(rig(145, kNotTurned));
  RawStereo wrong = rig(145, kNotTurned);
  std::swap(wrong.left, wrong.right);
  EXPECT_THAT(fault_of(calibration_of(wrong), seen_by(calibration)), HasSubstr("exchange M1 and M2"));
}

TEST(CheckCalibratedPair, NamesATransposedRotation) {
  const Calibration calibration = calibration_of(rig(120, pitched()));
  RawStereo wrong = rig(120, pitched());
  std::swap(wrong.rotation[5], wrong.rotation[7]);
  EXPECT_THAT(fault_of(calibration_of(wrong), seen_by(calibration)), HasSubstr("seems to be transposed"));
}

TEST(CheckCalibratedPair, DoubtsTheCalibrationWhereNothingMakesAPairOfTheImages) {
  const Calibration calibration = calibration_of(rig(145, kNotTurned));
  GrayPair images = seen_by(calibration);
  images.right = textured_pair(8.0, 0.0, 0.0).left;
  cv::Mat right = mat_of(images.right.view());
  cv::flip(right, right, -1);
  const auto said = AllOf(HasSubstr("r.png: not a pair with l.png: rectified with the calibration, hardly any place"),
                          Not(HasSubstr("or not rectified")));
  EXPECT_THAT(fault_of(calibration, images), said);
  EXPECT_THAT(fault_of(calibration, exchanged(seen_by(calibration)), false), said) << "the raw images are not at hand";
}

}  // namespace
}  // namespace flies
