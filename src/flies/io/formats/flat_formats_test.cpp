// Calibrations of a few numbers: as people write them by hand, as scripts dump them, as small programs and data sets
// have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

void expect_small_camera(const Calibration& calibration) {
  const auto& camera = calibration.camera;
  EXPECT_FALSE(calibration.rectifier);
  EXPECT_EQ(camera.fx_px, 424.5);
  EXPECT_EQ(camera.fy_px, 424.5);
  EXPECT_EQ(camera.cx_px, 421.5);
  EXPECT_EQ(camera.cx_right_px, 421.5);
  EXPECT_EQ(camera.cy_px, 236.25);
  EXPECT_DOUBLE_EQ(camera.baseline_m, 0.0499);
  EXPECT_EQ(camera.width_px, 848);
  EXPECT_EQ(camera.height_px, 480);
}

TEST(FlatFormats, NumbersWrittenByHandAreReadUnderTheirUsualNames) {
  const TemporaryFolder folder;
  for (const char* text :
       {"fx: 424.5\nfy: 424.5\ncx: 421.5\ncy: 236.25\nbaseline: 0.0499\nwidth: 848\nheight: 480\n",
        R"({"fx": 424.5, "fy": 424.5, "cx": 421.5, "cy": 236.25, "baseline_m": 0.0499, "width": 848, "height": 480})",
        "f: 424.5\ncx: 421.5\ncy: 236.25\nb: 0.0499\nimage_width: 848\nimage_height: 480\n",
        "fx: 424.5\nppx: 421.5\nppy: 236.25\nTx: -0.0499\nwidth: 848\nheight: 480\n"}) {
    SCOPED_TRACE(text);
    expect_small_camera(load_calibration(folder.write("c", text)));
  }
  const auto shifted = "fx: 424.5\ncx: 421.5\ncx_right: 430\ncy: 236.25\nbaseline: 0.0499\n";
  EXPECT_EQ(load_calibration(folder.write("c", shifted)).camera.cx_right_px, 430.0);
}

TEST(FlatFormats, NumbersWrittenByHandAreCheckedLikeAllOthers) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return error_of([&] { load_calibration(folder.write("c", text)); });
  };
  const std::string camera = "fx: 424.5\ncx: 421.5\n", whole = camera + "cy: 236.25\n";
  EXPECT_THAT(error(whole + "baseline: 49.9\n"), HasSubstr("is it in millimetres (0.0499 m)"));
  EXPECT_THAT(error(whole), HasSubstr("baseline: is missing: say how far the cameras stand apart (--baseline M)"));
  EXPECT_THAT(error(camera + "baseline: 0.0499\n"), HasSubstr("cy: is missing"));
  EXPECT_THAT(error(whole + "baseline: 0.0499\nwidth: 848\n"), HasSubstr("height: is missing"));
  const auto bent = load_calibration(folder.write("c", whole + "baseline: 0.0499\nk1: -0.3\n"));
  EXPECT_THAT(texts(bent.notes), Contains(HasSubstr("the coefficients of distortion left out")));
}

TEST(FlatFormats, WhatIsNotRecognisedIsToldWhatWouldDo) {
  const TemporaryFolder folder;
  const auto told = error_of([&] { load_calibration(folder.write("c", "camera: good\n")); });
  EXPECT_THAT(told,
              AllOf(HasSubstr("not recognised"), HasSubstr("fx: 700, fy: 700, cx: 320, cy: 240, baseline: 0.12")));
  const std::string lines = "fx: 700\nfy: 700\ncx: 320\ncy: 240\nbaseline: 0.12\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(load_calibration(folder.write("c", lines)).camera.baseline_m, 0.12);
}

const std::string kSide = R"({"width": 848, "height": 480, "fx": 424.5, "fy": 424.5, "ppx": 421.5, "ppy": 236.25, )";

TEST(FlatFormats, TwoCamerasAreReadAsScriptsDumpThem) {
  const TemporaryFolder folder;
  const std::string straight = kSide + R"("model": "distortion.brown_conrady", "coeffs": [0, 0, 0, 0, 0]})";
  for (const char* shift : {"-0.0499", "0.0499"}) {
    const std::string pose =
        std::string(R"({"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [)") + shift + ", 0, 0]}";
    expect_small_camera(load_calibration(folder.write(
        "c", R"({"infra1": )" + straight + R"(, "infra2": )" + straight + R"(, "extrinsics": )" + pose + "}")));
  }
  const std::string sides = R"({"left": )" + straight + R"(, "right": )" + straight;
  expect_small_camera(load_calibration(folder.write("c", sides + R"(, "baseline": 0.0499})")));
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", sides + "}")); }), HasSubstr("--baseline M"));
  CalibrationRequest request;
  request.baseline_m = 0.0499;
  expect_small_camera(load_calibration(folder.write("c", sides + "}"), request));
  request.baseline_m = -0.0499;
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", sides + "}"), request); }), HasSubstr("was asked for"));
}

TEST(FlatFormats, ADumpedRotationStandsColumnByColumn) {
  const TemporaryFolder folder;
  const std::string bent = kSide + R"("coeffs": [-0.05, 0.06, 0, 0, 0]})";
  const auto calibration = load_calibration(folder.write(
      "c",
      R"({"infra1": )" + bent + R"(, "infra2": )" + bent +
          R"(, "extrinsics": {"rotation": [0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1], "translation": [-0.0499, 0, 0]}})"));
  ASSERT_TRUE(calibration.rectifier);
  EXPECT_EQ(calibration.rectifier->raw().rotation[1], -0.6);
  EXPECT_EQ(calibration.rectifier->raw().left.distortion[1], 0.06);
  const std::string one_by_one = kSide + R"("k1": -0.05, "k2": 0.06})";
  const auto named = load_calibration(
      folder.write("c", R"({"left": )" + one_by_one + R"(, "right": )" + one_by_one + R"(, "baseline": 0.0499})"));
  ASSERT_TRUE(named.rectifier);
  EXPECT_EQ(named.rectifier->raw().right.distortion[1], 0.06);
}

// The sections that TStereoCamera::loadFromConfigFile of MRPT names, as in the Malaga data sets.
TEST(FlatFormats, MrptSaysWhereTheRightCameraIs) {
  const TemporaryFolder folder;
  const std::string lens = "resolution = [640 480]\ncx = 320.1\ncy = 240.2\nfx = 500.1\nfy = 500.2\n";
  const auto sections = [&](const std::string& dist, const std::string& pose) {
    return "[CAMERA_PARAMS_LEFT]\n" + lens + dist + "[CAMERA_PARAMS_RIGHT]\n" + lens + dist +
           "[CAMERA_PARAMS_LEFT2RIGHT_POSE]\npose_quaternion = " + pose;
  };
  const auto straight = load_calibration(folder.write("c", sections("", "[0.12 0 0 1 0 0 0]\n"))).camera;
  EXPECT_DOUBLE_EQ(straight.baseline_m, 0.12);
  EXPECT_EQ(straight.cx_px, 320.1);
  EXPECT_EQ(straight.width_px, 640);
  const auto raw = load_calibration(folder.write(
      "c", sections("dist = [-3.3e-1 1.2e-1 1e-4 -2e-4 0]\n", "[0.12 0 0 0.995004165 0 0 0.099833417]\n")));
  ASSERT_TRUE(raw.rectifier);
  EXPECT_NEAR(raw.camera.baseline_m, 0.12, 1e-6);
  const auto& translation_m = raw.rectifier->raw().translation_m;  // of points of the left camera to the right one
  EXPECT_NEAR(translation_m[0], -0.12 * 0.980067, 1e-5);
  EXPECT_NEAR(translation_m[1], 0.12 * 0.198669, 1e-5);
}

TEST(FlatFormats, VirtualKittiLeavesTheBaselineToTheUser) {
  const TemporaryFolder folder;
  const std::string text =
      "frame cameraID K[0,0] K[1,1] K[0,2] K[1,2]\n0 0 725.0087 725.0087 620.5 187\n0 1 725.0087 725.0087 620.5 187\n";
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", text)); }),
              AllOf(HasSubstr("0.532725 m"), HasSubstr("--baseline M")));
  CalibrationRequest request;
  request.baseline_m = 0.532725;
  const auto camera = load_calibration(folder.write("c", text), request).camera;
  EXPECT_EQ(camera.fx_px, 725.0087);
  EXPECT_EQ(camera.cx_right_px, 620.5);
  EXPECT_EQ(camera.baseline_m, 0.532725);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", text + "1 0 700 700 620.5 187\n"), request); }),
              HasSubstr("row 3: is of another camera"));
}

// calib_cam_to_cam of the stereo benchmark of 2015.
TEST(FlatFormats, KittiWithoutASizeTakesThatOfItsImages) {
  const TemporaryFolder folder;
  const std::string rows =
      "P_rect_02: 721.5377 0 609.5593 44.85728 0 721.5377 172.854 0.2163791 0 0 1 0.002745884\n"
      "P_rect_03: 721.5377 0 609.5593 -339.5242 0 721.5377 172.854 2.199936 0 0 1 0.002729905\n";
  CalibrationRequest request;
  request.width_px = 1242;
  request.height_px = 375;
  const auto camera = load_calibration(folder.write("c", rows), request).camera;
  EXPECT_NEAR(camera.baseline_m, 0.5327, 1e-4);
  EXPECT_EQ(camera.width_px, 1242);
  EXPECT_EQ(load_calibration(folder.write("c", rows)).camera.width_px, 0);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", rows + "S_rect_03: 1242 375\n"), request); }),
              HasSubstr("S_rect_02: is missing"));
}

}  // namespace
}  // namespace flies
