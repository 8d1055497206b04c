// A pair in two files of OpenCV's names: intrinsics and extrinsics, or a file a camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::opencv_matrix;
using flies::testing::rectified;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class TwoFiles : public ::testing::Test {
 protected:
  Calibration load(const std::string& first, const std::string& second, std::optional<double> baseline_m = {}) const {
    CalibrationRequest request;
    request.right_path = folder_.write("second", second);
    request.baseline_m = baseline_m;
    return load_calibration(folder_.write("first", first), request);
  }
  std::string complaint(const std::string& first, const std::string& second,
                        std::optional<double> baseline_m = {}) const {
    return error_of([&] { load(first, second, baseline_m); });
  }
  std::string intrinsics() const {
    return kSize + opencv_matrix("M1", cv::Mat(rig_.m1)) + opencv_matrix("D1", cv::Mat(rig_.d1).t()) +
           opencv_matrix("M2", cv::Mat(rig_.m2)) + opencv_matrix("D2", cv::Mat(rig_.d2).t());
  }
  std::string extrinsics(double times = 1.0) const {
    return opencv_matrix("R", cv::Mat(rig_.r)) + opencv_matrix("T", cv::Mat(rig_.t * times));
  }
  static std::string camera(const cv::Matx33d& m, const std::vector<double>& d) {
    return kSize + opencv_matrix("camera_matrix", cv::Mat(m)) +
           opencv_matrix("distortion_coefficients", cv::Mat(d).t());
  }
  inline static const std::string kSize = "image_width: 640\nimage_height: 480\n";
  const ToyRig rig_;
  const TemporaryFolder folder_;
};

TEST_F(TwoFiles, IntrinsicsAndExtrinsicsMayComeInEitherOrder) {
  expect_rectifies(load(intrinsics(), extrinsics()), rig_);
  expect_rectifies(load(extrinsics(), intrinsics()), rig_);
  EXPECT_THAT(error_of([&] { load_calibration(folder_.write("e", extrinsics())); }),
              AllOf(HasSubstr("M1, D1, M2, D2: are missing"), HasSubstr("--right-calib")));
}

TEST_F(TwoFiles, TheSecondMustBelongToTheFirst) {
  const std::string whole = intrinsics() + extrinsics();
  expect_rectifies(load(whole, extrinsics()), rig_);
  EXPECT_THAT(complaint(whole, extrinsics(1.2)), HasSubstr("T: says something else than T in"));
  EXPECT_THAT(complaint(whole, "T_BS: [1, 0, 0, 0]\nintrinsics: [400, 400, 320, 240]\nresolution: [640, 480]\n"),
              HasSubstr("second: right calibration: is not used"));
  EXPECT_THAT(complaint(whole, "threads: 1\nfield:\n  x_min_m: 4\n"), HasSubstr("right calibration: is not used"));
}

TEST_F(TwoFiles, WhatIsMissingBesideProjectionsIsSaid) {
  const auto to = rectified(rig_);
  const std::string projections =
      opencv_matrix("R1", to.r1) + opencv_matrix("R2", to.r2) + opencv_matrix("P1", to.p1) + opencv_matrix("P2", to.p2);
  const auto notes = texts(load(intrinsics(), projections).notes);
  EXPECT_THAT(notes, Contains(HasSubstr("R and T are missing")));
  EXPECT_THAT(notes, Not(Contains(HasSubstr("file of the intrinsics"))));
}

TEST_F(TwoFiles, ACameraEachIsReadWhereOneSaysHowTheyStand) {
  const std::string left = camera(rig_.m1, rig_.d1), right = camera(rig_.m2, rig_.d2);
  expect_rectifies(load(left, right + extrinsics()), rig_);
  expect_rectifies(load(left + extrinsics(), right), rig_);
  expect_rectifies(load(left + extrinsics(), right + extrinsics()), rig_);
  EXPECT_EQ(load(left, right + extrinsics()).format, "OpenCV stereo");
  EXPECT_THAT(complaint(left + extrinsics(), right + extrinsics(2.0)), HasSubstr("R, T: say something else"));
  EXPECT_THAT(complaint(left, right, 0.12), HasSubstr("R, T: are missing: two raw cameras"));
  EXPECT_THAT(complaint(left, extrinsics()), HasSubstr("this file not the other one"));
  const std::string other_size = "image_width: 320\nimage_height: 240\n" + right.substr(kSize.size());
  EXPECT_THAT(complaint(left, other_size + extrinsics()), HasSubstr("found 320 x 240 px"));
}

TEST_F(TwoFiles, ACameraEachMayHaveTheSameLensOrNone) {
  ToyRig alike;
  alike.m2 = alike.m1;
  alike.d2 = alike.d1;
  const std::string same = camera(alike.m1, alike.d1);
  expect_rectifies(load(same, same + extrinsics()), alike);
  const auto straight = camera(alike.m1, {0, 0, 0, 0, 0});
  EXPECT_NEAR(load(straight, straight, 0.12).camera.baseline_m, 0.12, 1e-9);
}

TEST_F(TwoFiles, ACameraEachMayNameItsNumbersOneByOne) {
  const auto one_by_one = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return kSize + fmt::format("fx: {}\nfy: {}\ncx: {}\ncy: {}\nk1: {}\nk2: {}\np1: {}\np2: {}\n", m(0, 0), m(1, 1),
                               m(0, 2), m(1, 2), d[0], d[1], d[2], d[3]);
  };
  expect_rectifies(load(one_by_one(rig_.m1, rig_.d1), one_by_one(rig_.m2, rig_.d2) + extrinsics()), rig_);
}

}  // namespace
}  // namespace flies
