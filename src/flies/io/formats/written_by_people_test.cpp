// Files as people write them, cut them and copy them from a screen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::focal_and_centre;
using flies::testing::kWritten_m;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::right_from_left;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct WrittenByPeople : ::testing::Test {
  Calibration load(const std::string& text, const CalibrationRequest& request = {}) const {
    return load_calibration(folder.write("c", text), request);
  }
  std::string error(const std::string& text, const CalibrationRequest& request = {}) const {
    return error_of([&] { load(text, request); });
  }
  TemporaryFolder folder;
};

CalibrationRequest of_size(int width_px, int height_px) {
  CalibrationRequest request;
  request.width_px = width_px;
  request.height_px = height_px;
  return request;
}

TEST_F(WrittenByPeople, ABaselineInMetresIsNotYetStereodemos) {
  const auto calibration = load("fx: 700\ncx: 320\ncy: 240\nbaseline_meters: 0.12\n");
  EXPECT_EQ(calibration.camera.baseline_m, 0.12);
  EXPECT_EQ(calibration.camera.cx_right_px, 320.0);
}

TEST_F(WrittenByPeople, TwoMatricesAndABaselineAreRectifiedCameras) {
  const std::string left = "K_left: [800, 0, 640, 0, 800, 400, 0, 0, 1]\n",
                    right = "K_right: [800, 0, 650, 0, 800, 400, 0, 0, 1]\n", zeros = ": [0, 0, 0, 0]\n";
  for (const char* baseline : {"baseline: 0.075\n", "baseline_mm: 75\n"})
    for (const std::string& lenses : {std::string(), "D_left" + zeros + "D_right" + zeros}) {
      const auto calibration = load(left + right + lenses + baseline);
      EXPECT_FALSE(calibration.rectifier);
      EXPECT_EQ(calibration.camera.fx_px, 800.0);
      EXPECT_EQ(calibration.camera.cx_right_px, 650.0);
      EXPECT_NEAR(calibration.camera.baseline_m, 0.075, kWritten_m);
    }
  CalibrationRequest request;
  request.baseline_m = 0.2;
  EXPECT_EQ(load(left + right, request).camera.baseline_m, 0.2);
  EXPECT_THAT(error(left + right), HasSubstr("R: is missing"));
  const std::string bent = "D_left: [-0.3, 0.1, 0, 0]\nD_right: [-0.3, 0.1, 0, 0]\n";
  EXPECT_THAT(error(left + right + bent + "baseline: 0.075\n"), HasSubstr("R: is missing"));
  EXPECT_THAT(error(left + right + "T: [-0.075, 0.01, 0]\nbaseline: 0.075\n"), HasSubstr("R: is missing"));
}

TEST_F(WrittenByPeople, ThePoseMayStandBelowTheRightCamera) {
  const ToyRig rig;
  const auto camera = [](const char* name, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format("{{\"name\": \"{}\", \"K\": {}, \"dist\": {}", name, rows(cv::Mat(m)), list(d));
  };
  const std::string pose =
      fmt::format(", \"R\": {}, \"T\": {}", rows(cv::Mat(rig.r)), list({rig.t[0], rig.t[1], rig.t[2]}));
  const auto cameras = [&](const std::string& of_left, const std::string& of_right) {
    return "{\"cameras\": [" + camera("left", rig.m1, rig.d1) + of_left + "}, " + camera("right", rig.m2, rig.d2) +
           of_right + "}], \"image_size\": [640, 480]}";
  };
  expect_rectifies(load(cameras("", pose)), rig);
  EXPECT_THAT(error(cameras(pose, pose)), HasSubstr("R: is missing"));  // of each against something else
}

TEST_F(WrittenByPeople, WhatBouguetsToolboxPrintsIsRead) {
  const ToyRig rig;
  cv::Vec3d turn;
  cv::Rodrigues(rig.r, turn);
  const auto words = [](const std::vector<double>& values) { return fmt::format("{}", fmt::join(values, "   ")); };
  const auto camera = [&](const char* side, const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format(
        "\nIntrinsic parameters of {0} camera:\n\nFocal Length:          fc_{0} = [ {1} ] ± [ 1.0   1.1 ]\n"
        "Principal point:       cc_{0} = [ {2} ] ± [ 1.2   1.3 ]\nSkew:             alpha_c_{0} = [ 0.00000 ] ± [ 0  ] "
        "  "
        "=> angle of pixel axes = 90.0 ± 0.0 degrees\nDistortion:            kc_{0} = [ {3} ] ± [ 0.1 0.1 0 0 0 ]\n",
        side, words({m(0, 0), m(1, 1)}), words({m(0, 2), m(1, 2)}), words(d));
  };
  const std::string text =
      "Stereo calibration parameters after optimization:\n" + camera("left", rig.m1, rig.d1) +
      camera("right", rig.m2, rig.d2) + "\nExtrinsic parameters (position of right camera wrt left camera):\n\n" +
      fmt::format("Rotation vector:             om = [ {} ] ± [ 0.1 0.1 0.1 ]\n", words({turn[0], turn[1], turn[2]})) +
      fmt::format("Translation vector:           T = [ {} ] ± [ 0.1 0.1 0.1 ]\n",
                  words({1e3 * rig.t[0], 1e3 * rig.t[1], 1e3 * rig.t[2]}));
  const auto calibration = load(text, of_size(640, 480));
  EXPECT_EQ(calibration.format, "Bouguet's toolbox");
  expect_rectifies(calibration, rig);
}

std::string chain(const ToyRig& rig, int first) {
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return "  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: " +
           list(std::vector<double>(d.begin(), d.begin() + 4)) + "\n  intrinsics: " + focal_and_centre(m) +
           "\n  resolution: [640, 480]\n";
  };
  return fmt::format("cam{}:\n{}cam{}:\n  T_cn_cnm1: {}\n{}", first, camera(rig.m1, rig.d1), first + 1,
                     rows(right_from_left(rig)), camera(rig.m2, rig.d2));
}

TEST_F(WrittenByPeople, AChainOfKalibrMayBeCutOutOfALongerOne) {
  const ToyRig rig;
  CalibrationRequest both;
  both.cameras = {1, 2};
  for (const std::string& text : {chain(rig, 1), chain(rig, 2)}) {
    const auto calibration = load(text);
    EXPECT_EQ(calibration.format, "Kalibr camchain");
    expect_rectifies(calibration, rig);
  }
  expect_rectifies(load(chain(rig, 1), both), rig);
  EXPECT_THAT(error(chain(rig, 2), both), HasSubstr("cam1.intrinsics: is missing"));
  ToyRig swapped;
  swapped.t = -swapped.t;
  EXPECT_THAT(error(chain(swapped, 1)), HasSubstr("--cameras 2,1 exchanges them"));
}

TEST_F(WrittenByPeople, MatlabsFisheyeIsNamedAndSoIsATransposedMatrix) {
  const auto file = [](const std::string& left) {
    return R"({"CameraParameters1": {)" + left +
           R"(}, "CameraParameters2": {"RadialDistortion": [-0.2, 0], "TangentialDistortion": [0, 0], )"
           R"("ImageSize": [480, 640], "IntrinsicMatrix": [[502, 0, 0], [0, 503, 0], [323, 242, 1]], )"
           R"("K": [[502, 0, 323], [0, 503, 242], [0, 0, 1]]}, "RotationOfCamera2": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], )"
           R"("TranslationOfCamera2": [-120, 0, 0]})";
  };
  EXPECT_THAT(error(file(R"("FisheyeIntrinsics": {"MappingCoefficients": [880, -0.0003, 0, 0]})")),
              HasSubstr("c: CameraParameters1.FisheyeIntrinsics.MappingCoefficients: is of MATLAB's fisheye model"));
  const std::string lens =
      R"("RadialDistortion": [-0.2, 0], "TangentialDistortion": [0, 0], "ImageSize": [480, 640], )";
  const std::string row_by_row = "[[500, 0, 321], [0, 501, 241], [0, 0, 1]]",
                    transposed = "[[500, 0, 0], [0, 501, 0], [321, 241, 1]]";
  EXPECT_THAT(error(file(lens + "\"K\": " + transposed)), HasSubstr("c: CameraParameters1.K: is transposed"));
  EXPECT_THAT(error(file(lens + "\"IntrinsicMatrix\": " + row_by_row)),
              HasSubstr("c: CameraParameters1.IntrinsicMatrix: is transposed"));
  EXPECT_EQ(load(file(lens + "\"K\": " + row_by_row)).camera.width_px, 640);
}

TEST_F(WrittenByPeople, AMatrixMayStandInTheFileByRowsAndByColumns) {
  const std::string columns = "camera:\n  IntrinsicMatrix: [502, 0, 0, 0, 503, 0, 323, 242, 1]\n";
  EXPECT_EQ(load(columns + "  K: [502, 0, 323, 0, 503, 242, 0, 0, 1]\nbaseline: 0.1\n").camera.cx_px, 323.0);
  EXPECT_THAT(error(columns + "  K: [502, 0, 333, 0, 503, 242, 0, 0, 1]\nbaseline: 0.1\n"),
              HasSubstr("with other numbers"));
}

TEST_F(WrittenByPeople, AZedFileThatWasCutShortSaysWhatItLacks) {
  std::string modes;
  for (const char* mode : {"HD", "VGA"})
    for (const char* side : {"LEFT", "RIGHT"})
      modes += fmt::format("[{}_CAM_{}]\nfx=700\nfy=700\ncx=640\ncy=360\nk1=0\nk2=0\np1=0\np2=0\nk3=0\n", side, mode);
  EXPECT_THAT(error(modes, of_size(1280, 720)), AllOf(HasSubstr("[STEREO]: is missing"), Not(HasSubstr("infra1"))));
  EXPECT_THAT(error("[LEFT_CAM_HD]\n[RIGHT_CAM_HD]\n[STEREO]\nBaseline=120\n"),
              HasSubstr("[LEFT_CAM_HD]: is missing or empty"));
}

}  // namespace
}  // namespace flies
