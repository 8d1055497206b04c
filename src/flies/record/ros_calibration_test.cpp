#include "flies/record/ros_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "flies/core/error.hpp"
#include "flies/io/for_images.hpp"

namespace flies {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kFocal_px = 500, kBaseline_m = 0.12;
/// A rectifier chooses the focal length anew, so that all pixels are valid.
constexpr double kPixel = 1.0;

/// Cameras that need no rectifying, with what a test changes of them.
struct Rig {
  RosCameraInfo left, right;

  Rig() {
    for (RosCameraInfo* camera : {&left, &right}) {
      camera->width_px = 640;
      camera->height_px = 480;
      camera->distortion_model = "plumb_bob";
      camera->intrinsics = {kFocal_px, 0, 320, 0, kFocal_px, 240, 0, 0, 1};
      camera->rectification = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      camera->projection = {kFocal_px, 0, 320, 0, 0, kFocal_px, 240, 0, 0, 0, 1, 0};
    }
    right.projection[3] = -kFocal_px * kBaseline_m;
    left.topic = "/l/camera_info";
    right.topic = "/r/camera_info";
  }
  Rig& with(void (*change)(RosCameraInfo&)) {
    change(left);
    change(right);
    return *this;
  }
  bool is_rectified() const { return is_rectified_by_nature(left) && is_rectified_by_nature(right); }
  Calibration read(const CalibrationRequest& request = {}) const { return ros_calibration(left, right, request, "f"); }
  Calibration read_raw(CalibrationRequest request = {}) const {
    request.images_are_raw = true;
    return read(request);
  }
};

CalibrationRequest with_baseline(double baseline_m) {
  CalibrationRequest request;
  request.baseline_m = baseline_m;
  return request;
}

void bend(RosCameraInfo& camera) { camera.distortion = {1e-6, 0, 0, 0, 0}; }

TEST(RosCalibration, OfRectifiedPicturesIsP) {
  const Calibration calibration = Rig().with(bend).read();
  EXPECT_FALSE(calibration.rectifier.has_value());
  EXPECT_DOUBLE_EQ(calibration.camera.baseline_m, kBaseline_m);
  EXPECT_DOUBLE_EQ(calibration.camera.fx_px, kFocal_px);
  EXPECT_DOUBLE_EQ(calibration.camera.cy_px, 240);
  EXPECT_EQ(calibration.format, "ROS CameraInfo");
}

TEST(RosCalibration, OfRawPicturesRectifies) {
  const Calibration calibration = Rig().with(bend).read_raw();
  ASSERT_TRUE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, kBaseline_m, 1e-9);
  EXPECT_NEAR(calibration.camera.fx_px, kFocal_px, kPixel);
}

/// As of KITTI's colour cameras, whose origin is that of the left grey one.
TEST(RosCalibration, BaselineIsTheDifferenceOfBothShifts) {
  Rig rig;
  rig.with(bend);
  rig.left.projection[3] = kFocal_px * 0.06;
  rig.right.projection[3] = -kFocal_px * 0.48;
  EXPECT_NEAR(rig.read().camera.baseline_m, 0.54, 1e-9);
  EXPECT_NEAR(rig.read_raw().camera.baseline_m, 0.54, 1e-9);
}

TEST(RosCalibration, RotationsOfBothCamerasAreUsed) {
  Rig rig;
  const double c = std::cos(0.02), s = std::sin(0.02);
  rig.right.rectification = {c, 0, s, 0, 1, 0, -s, 0, c};
  const Calibration calibration = rig.read_raw();
  ASSERT_TRUE(calibration.rectifier.has_value());
  EXPECT_NEAR(calibration.camera.baseline_m, kBaseline_m, 1e-6);
  EXPECT_NEAR(calibration.camera.fx_px, kFocal_px, 25);
  EXPECT_FALSE(rig.is_rectified());
}

TEST(RosCalibration, PicturesAreRectifiedByNatureWhereNothingIsToDo) {
  EXPECT_TRUE(Rig().is_rectified());
  EXPECT_TRUE(Rig().with([](auto& camera) { camera.distortion = {0, 0, 0, 0, 0}; }).is_rectified());
  EXPECT_TRUE(Rig().with([](auto& camera) { camera.distortion_model = ""; }).is_rectified());
  for (const char* model : {"radtan", "Brown Conrady", "rational_polynomial", "none"}) {
    Rig rig;
    for (RosCameraInfo* camera : {&rig.left, &rig.right}) camera->distortion_model = model;
    EXPECT_TRUE(rig.is_rectified()) << model;
  }
  EXPECT_TRUE(Rig().with([](auto& camera) { camera.rectification = {}; }).is_rectified());
  EXPECT_FALSE(Rig().with(bend).is_rectified());
  for (const std::size_t number : {0U, 2U, 5U, 6U})  // fx, cx, fy, cy
    for (RosCameraInfo Rig::*side : {&Rig::left, &Rig::right}) {
      Rig rig;
      (rig.*side).projection[number] *= 0.9;
      EXPECT_FALSE(rig.is_rectified()) << number;
    }
}

TEST(RosCalibration, KCountsOfRawPicturesWithoutDistortion) {
  const Calibration calibration = Rig()
                                      .with([](auto& camera) {
                                        camera.projection[0] = camera.projection[5] = 0.9 * kFocal_px;
                                        camera.projection[3] *= 0.9;  // which keeps the baseline
                                        camera.rectification = {};
                                      })
                                      .read_raw();
  ASSERT_TRUE(calibration.rectifier.has_value());
  EXPECT_EQ(calibration.rectifier->raw().left.matrix[0], kFocal_px);
  EXPECT_NEAR(calibration.camera.fx_px, kFocal_px, kPixel);
  EXPECT_NEAR(calibration.camera.baseline_m, kBaseline_m, 1e-9);
}

TEST(RosCalibration, FisheyesWithoutCoefficientsAreFisheyes) {
  for (const char* model : {"equidistant", "fisheye", "Kannala Brandt4"}) {
    Rig rig;
    for (RosCameraInfo* camera : {&rig.left, &rig.right}) {
      camera->distortion_model = model;
      camera->distortion = {0, 0, 0, 0};
    }
    EXPECT_FALSE(rig.is_rectified()) << model;
    EXPECT_EQ(rig.read_raw().rectifier->raw().left.lens, Lens::equidistant) << model;
  }
}

TEST(RosCalibration, FollowsTheSizeOfThePictures) {
  const auto binned = [](auto& camera) { camera.binning_x = camera.binning_y = 2; };
  const Calibration halved = Rig().with(binned).read(testing::for_images(320, 240));
  EXPECT_NEAR(halved.camera.fx_px, kFocal_px / 2, 1e-9);
  EXPECT_NEAR(halved.camera.baseline_m, kBaseline_m, 1e-9);
  EXPECT_EQ(halved.camera.width_px, 320);
  EXPECT_NEAR(Rig().read(testing::for_images(320, 240)).camera.fx_px, kFocal_px / 2, 1e-9);
  EXPECT_NEAR(Rig().with(bend).read_raw(testing::for_images(320, 240)).camera.fx_px, kFocal_px / 2, kPixel);

  const auto windowed = [](auto& camera) { camera.window = {20, 40, 600, 320}; };
  const Calibration window = Rig().with(windowed).read(testing::for_images(600, 320));
  EXPECT_NEAR(window.camera.fx_px, kFocal_px, 1e-9);
  EXPECT_NEAR(window.camera.cx_px, 300, 1e-9);
  EXPECT_NEAR(window.camera.cy_px, 200, 1e-9);
  EXPECT_THAT(texts(window.notes), Contains(HasSubstr("a window of 600 x 320 px at column 20, row 40")));
  const Calibration both = Rig().with(windowed).with(binned).read(testing::for_images(300, 160));
  EXPECT_NEAR(both.camera.fx_px, kFocal_px / 2, 1e-9);
  EXPECT_NEAR(both.camera.cx_px, 149.75, 1e-9);  // between the middles of pixels
}

TEST(RosCalibration, BaselineOfTheUserStandsInWhereEachCameraWasCalibratedAlone) {
  Rig rig;
  rig.right.projection[3] = 0;
  EXPECT_NEAR(rig.read(with_baseline(0.3)).camera.baseline_m, 0.3, 1e-12);
  EXPECT_THAT([&] { rig.read(); }, ThrowsMessage<InputError>(HasSubstr("give it with --baseline M")));

  rig.with(bend);
  const Calibration raw = rig.read_raw(with_baseline(0.3));
  EXPECT_NEAR(raw.camera.baseline_m, 0.3, 1e-9);
  EXPECT_THAT(texts(raw.notes, {CalibrationNoteKind::doubt}),
              Contains(HasSubstr("/r/camera_info P says that both cameras are in the same place")));
  EXPECT_THAT([&] { rig.read_raw(); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("f: /r/camera_info P: "), HasSubstr("(--baseline M)"))));
  for (const double baseline_m : {-0.3, 0.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT([&] { rig.read_raw(with_baseline(baseline_m)); },
                ThrowsMessage<InputError>(HasSubstr("m, expected more than 0")));
}

TEST(RosCalibration, CamerasThatAreNotCalibratedAreTold) {
  Rig rig;
  rig.with([](auto& camera) { camera.projection = {}; });
  const auto fault = ThrowsMessage<InputError>(AllOf(HasSubstr("f: /l/camera_info P: "), HasSubstr("not calibrated")));
  EXPECT_THAT([&] { rig.read(with_baseline(0.3)); }, fault);
  EXPECT_THAT([&] { rig.read_raw(with_baseline(0.3)); }, fault);
}

TEST(RosCalibration, FaultsAreNamed) {
  const Rig good;
  EXPECT_THAT([&] { ros_calibration(good.right, good.left, {}, "f"); },
              ThrowsMessage<InputError>(HasSubstr("left and right are swapped")));
  for (const std::size_t number : {0U, 5U, 6U}) {  // fx, fy, cy
    Rig rig;
    rig.right.projection[number] += 30.0;
    EXPECT_THAT([&] { rig.read(); }, ThrowsMessage<InputError>(HasSubstr("in both images of a rectified pair")));
  }
  Rig far;
  far.right.projection[3] = -1e9;
  EXPECT_THAT([&] { far.read(); }, ThrowsMessage<InputError>(HasSubstr("baseline")));
  EXPECT_THAT([&] { far.with(bend).read_raw(); }, ThrowsMessage<InputError>(HasSubstr("baseline")));
  Rig odd;
  odd.left.distortion_model = "odd";
  EXPECT_FALSE(odd.is_rectified());
  EXPECT_THAT([&] { odd.read_raw(); },
              ThrowsMessage<InputError>(HasSubstr("f: /l/camera_info distortion_model: found 'odd'")));
  Rig narrow;
  narrow.right.width_px = 320;
  EXPECT_THAT([&] { narrow.read(); },
              ThrowsMessage<InputError>(HasSubstr("f: /r/camera_info image size: found 320 x 480 px")));
}

}  // namespace
}  // namespace flies
