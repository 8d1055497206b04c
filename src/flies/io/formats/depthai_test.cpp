// OAK cameras in the forms in which their calibration is kept, and the images of their video modes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::list;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string xyz(const cv::Vec3d& t) {
  return fmt::format(R"({{"x": {}, "y": {}, "z": {}}})", 100 * t[0], 100 * t[1], 100 * t[2]);
}

struct Oak {
  ToyRig rig;
  cv::Vec3d translation = rig.t, built;
  std::string type = "0", to_right = "2";
  int height_px = 480;

  /// What DepthAI writes of a camera.
  std::string camera(const cv::Matx33d& m, std::vector<double> d, const std::string& to) const {
    d.resize(14, 0.0);
    return fmt::format(
        R"("cameraType": {}, "distortionCoeff": {}, "extrinsics": {{"rotationMatrix": {}, "specTranslation": {}, )"
        R"("toCameraSocket": {}, "translation": {}}}, "height": {}, "intrinsicMatrix": {}, "width": 640)",
        type, list(d), rows(cv::Mat(rig.r)), xyz(built), to, xyz(translation), height_px, rows(cv::Mat(m)));
  }
  std::string left() const { return camera(rig.m1, rig.d1, to_right); }
  std::string right() const { return camera(rig.m2, rig.d2, "-1"); }
  std::string file(const std::string& more = "") const {
    return "{\"cameraData\": [[1, {" + left() + "}], [2, {" + right() + "}]]" + more + "}";
  }
};

CalibrationRequest of_size(int width_px, int height_px) {
  CalibrationRequest request;
  request.width_px = width_px;
  request.height_px = height_px;
  return request;
}

TEST(DepthAi, CamerasMayStandInAListInAMapOrNameTheirSocket) {
  const TemporaryFolder folder;
  Oak oak;
  const std::string left = oak.left(), right = oak.right();
  for (const std::string& text : {oak.file(), "{\"cameraData\": {\"1\": {" + left + "}, \"2\": {" + right + "}}}",
                                  "{\"cameraData\": {\"CAM_B\": {" + left + "}, \"CAM_C\": {" + right + "}}}",
                                  "{\"cameraData\": [{\"socket\": 2, " + right + "}, {\"socket\": 1, " + left + "}]}",
                                  "{\"eeprom\": " + oak.file() + ", \"mxid\": \"x\"}"})
    expect_rectifies(load_calibration(folder.write("c", text)), oak.rig);
  oak.to_right = "\"CameraBoardSocket.CAM_C\"";
  expect_rectifies(load_calibration(folder.write("c", oak.file())), oak.rig);
  const std::string twice = "{\"cameraData\": [{\"socket\": 1, " + right + "}, {\"socket\": 1, " + left + "}]}";
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", twice)); }),
              HasSubstr("cameraData.1: is a second camera at socket 1"));
}

TEST(DepthAi, LensesAreNamedByNumberOrByWord) {
  const TemporaryFolder folder;
  Oak oak;
  oak.rig = ToyRig::fisheye();
  for (const char* type : {"1", "\"Fisheye\"", "\"CameraModel.Fisheye\""}) {
    oak.type = type;
    expect_rectifies(load_calibration(folder.write("c", oak.file())), oak.rig);
  }
  for (const char* type : {"2", "3", "\"RadialDivision\""}) {
    oak.type = type;
    EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", oak.file())); }),
                HasSubstr("expected 0 (Perspective) or 1 (Fisheye)"))
        << type;
  }
}

TEST(DepthAi, WhatTheCameraWasBuiltToStandsInForWhatWasNotMeasured) {
  const TemporaryFolder folder;
  Oak oak;
  oak.built = oak.rig.t;
  oak.translation = {};
  const auto calibration = load_calibration(folder.write("c", oak.file(", \"stereoUseSpecTranslation\": true")));
  expect_rectifies(calibration, oak.rig);
  EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("specTranslation, as the camera was built")));
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", oak.file(", \"stereoUseSpecTranslation\": false"))); }),
              HasSubstr("both cameras are in the same place"));
  oak.translation = oak.rig.t;
  oak.built *= 2.0;
  EXPECT_NEAR(load_calibration(folder.write("c", oak.file())).camera.baseline_m, cv::norm(oak.rig.t), 1e-9);
}

TEST(DepthAi, VideoOfASensorWithMoreRowsIsItsMiddle) {
  const TemporaryFolder folder;
  Oak oak;
  oak.height_px = 400;  // of which 360 are 16:9
  for (cv::Matx33d* m : {&oak.rig.m1, &oak.rig.m2}) (*m)(1, 2) -= 40;
  const auto file = folder.write("c", oak.file());
  const auto video = load_calibration(file, of_size(640, 360));
  EXPECT_EQ(video.camera.height_px, 360);
  EXPECT_THAT(texts(video.notes), Contains(HasSubstr("the middle 360 rows")));
  for (cv::Matx33d* m : {&oak.rig.m1, &oak.rig.m2}) (*m)(1, 2) -= 20;
  expect_rectifies(video, oak.rig);
  for (const int said_px : {400, 360}) {
    auto said = of_size(640, 360);
    said.calibrated_width_px = 640;
    said.calibrated_height_px = said_px;
    EXPECT_EQ(load_calibration(file, said).rectifier->raw().left.matrix[5], oak.rig.m1(1, 2)) << said_px;
  }
  const double halved_px = load_calibration(file, of_size(320, 180)).rectifier->raw().left.matrix[5];
  EXPECT_DOUBLE_EQ(halved_px, (oak.rig.m1(1, 2) + 0.5) / 2 - 0.5);

  EXPECT_THAT(texts(load_calibration(file, of_size(640, 400)).notes), Not(Contains(HasSubstr("the middle"))));
  auto squeezed = of_size(640, 360);
  squeezed.images_are_resized = true;
  EXPECT_DOUBLE_EQ(load_calibration(file, squeezed).rectifier->raw().left.matrix[4], 421 * 0.9);
}

}  // namespace
}  // namespace flies
