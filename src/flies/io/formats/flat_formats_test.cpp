// Calibrations of a few numbers: as people write them by hand, as scripts dump them, as small programs and data sets
// have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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
  EXPECT_THAT(error(whole), HasSubstr("baseline: is missing: give the distance between the cameras (--baseline M)"));
  EXPECT_THAT(error(camera + "baseline: 0.0499\n"), HasSubstr("cy: is missing"));
  EXPECT_THAT(error(whole + "baseline: 0.0499\nwidth: 848\n"), HasSubstr("height: is missing"));
  const auto bent = load_calibration(folder.write("c", whole + "baseline: 0.0499\nk1: -0.3\n"));
  EXPECT_THAT(texts(bent.notes), Contains(HasSubstr("the distortion coefficients are ignored")));
}

TEST(FlatFormats, CoefficientsThatAreLeftOutAreToldWhicheverOfThemIsNot0) {
  const TemporaryFolder folder;
  const std::string camera = "fx: 424.5\ncx: 421.5\ncy: 236.25\nbaseline: 0.0499\n";
  const auto notes = [&](const std::string& lens) {
    return texts(load_calibration(folder.write("c", camera + lens)).notes);
  };
  for (const char* lens :
       {"k1: 0\nk2: 0.2\n", "k1: 0\nk2: 0\np1: 0.001\n", "p2: 0.001\n", "k1: 0\nk3: 0.1\n",
        "k1: 0\ndist: [0.1, 0, 0, 0]\n", "dist_coeffs: [0.1, 0, 0, 0]\n", "distCoeffs: [0.1, 0, 0, 0]\n",
        "distortion_coeffs: [0.1, 0, 0, 0]\n", "d: [0.1, 0, 0, 0]\n", "kc: [0.1, 0, 0, 0, 0]\n", "k: [0.1, 0, 0, 0]\n"})
    EXPECT_THAT(notes(lens), Contains(HasSubstr("the distortion coefficients are ignored"))) << lens;
  EXPECT_THAT(notes("k1: 0\nk2: 0\np1: 0\np2: 0\nk3: 0\n"), Not(Contains(HasSubstr("distortion"))));
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
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", sides + "}"), request); }),
              HasSubstr("expected more than 0"));
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

// As pyrealsense2 prints the cameras of a T265: five coefficients, of which the model has four.
TEST(FlatFormats, DumpedFisheyesAreReadByTheNameOfTheirModel) {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& camera, const std::string& beside) {
    return load_calibration(folder.write(
        "c", R"({"fisheye1": )" + camera + R"(, "fisheye2": )" + camera + R"(, "baseline": 0.064)" + beside + "}"));
  };
  const std::string side = R"({"width": 848, "height": 800, "fx": 285.7, "fy": 285.7, "ppx": 418.1, "ppy": 402.2, )";
  const std::string five = R"("coeffs": [-0.0076, 0.0436, -0.0412, 0.0076, 0])";
  const std::string one_by_one = R"("k1": -0.0076, "k2": 0.0436, "k3": -0.0412, "k4": 0.0076)";
  const std::string none, said = R"(, "distortion_model": "equidistant")";
  const std::string model = R"("model": "distortion.kannala_brandt4", )";
  for (const auto& [camera, beside] :
       {std::pair{side + model + five + "}", none}, std::pair{side + model + one_by_one + "}", none},
        std::pair{side + five + "}", said}}) {
    SCOPED_TRACE(camera + beside);
    const auto calibration = load(camera, beside);
    ASSERT_TRUE(calibration.rectifier);
    const auto& raw = calibration.rectifier->raw();
    for (const RawCamera& read : {raw.left, raw.right}) {
      EXPECT_EQ(read.lens, Lens::equidistant);
      EXPECT_THAT(read.distortion, ElementsAre(-0.0076, 0.0436, -0.0412, 0.0076));
    }
    EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("with the equidistant (fisheye) model")));
  }
  const std::string of_another = R"("coeffs": [-0.0076, 0.0436, -0.0412, 0.0076, 0.1]})";
  EXPECT_THAT(error_of([&] { load(side + model + of_another, ""); }), HasSubstr("found 5 coefficients"));
}

/// A file of cameras of these names.
std::string dump_of(const std::vector<std::string>& names, const std::string& beside = R"("baseline": 0.0499)") {
  std::string text = "{";
  for (const auto& name : names) text += '"' + name + R"(": )" + kSide + R"("coeffs": [0, 0, 0, 0, 0]}, )";
  return text + beside + "}";
}

TEST(FlatFormats, DumpedCamerasAreLeftAndRightByTheirNames) {
  const TemporaryFolder folder;
  for (const auto& [left, right] :
       {std::pair{"infra1", "infra2"}, std::pair{"left", "right"}, std::pair{"Camera_Left", "Camera_Right"},
        std::pair{"camL", "camR"}, std::pair{"cam9", "cam10"}, std::pair{"left_0", "right_1"}}) {
    for (const bool has_others : {false, true}) {
      std::vector<std::string> names{right, left};
      if (has_others) names.insert(names.begin(), {"color", "depth"});
      SCOPED_TRACE(dump_of(names));
      const auto calibration = load_calibration(folder.write("c", dump_of(names)));
      expect_small_camera(calibration);
      EXPECT_EQ(calibration.left_name, left);
      EXPECT_EQ(calibration.right_name, right);
      const auto note = HasSubstr(std::string(left) + " and " + right + " are taken");
      EXPECT_THAT(texts(calibration.notes, {CalibrationNoteKind::told}), Contains(note).Times(has_others ? 1 : 0));
    }
  }
  const std::string pose = R"("extrinsics": {"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "translation": [-0.05, 0, 0]})";
  const auto calibration = load_calibration(folder.write("c", dump_of({"color", "infra1", "infra2"}, pose)));
  EXPECT_THAT(texts(calibration.notes, {CalibrationNoteKind::doubt}),
              Contains(HasSubstr("extrinsics as the pose between these two")));
}

TEST(FlatFormats, DumpedCamerasThatAreNoPairByTheirNamesAreRefused) {
  const TemporaryFolder folder;
  const auto error = [&](const std::vector<std::string>& names) {
    return error_of([&] { load_calibration(folder.write("c", dump_of(names))); });
  };
  EXPECT_THAT(error({"color", "depth"}), HasSubstr("cameras: found color, depth, expected two whose names differ in"));
  EXPECT_THAT(error({"depth", "infra1"}), HasSubstr("found depth, infra1, expected two"));
  EXPECT_THAT(error({"cam1", "cam3"}), HasSubstr("found cam1, cam3, expected two"));
  EXPECT_THAT(error({"left_1", "right_0"}), HasSubstr("found left_1, right_0, expected two"));
  EXPECT_THAT(error({"cam0", "cam1", "cam2"}), HasSubstr("found cam0, cam1, cam2, expected only two"));
}

TEST(FlatFormats, OtherCamerasOfADumpSayNothingOfTheLensesOfThePair) {
  const TemporaryFolder folder;
  const std::string color = R"({"color": )" + kSide + R"("model": "distortion.brown_conrady", "k1": 0.1}, )";
  const std::string fisheye = kSide + R"("model": "distortion.kannala_brandt4", "coeffs": [0.01, 0, 0, 0, 0]})";
  const auto calibration = load_calibration(
      folder.write("c", color + R"("infra1": )" + fisheye + R"(, "infra2": )" + fisheye + R"(, "baseline": 0.0499})"));
  ASSERT_TRUE(calibration.rectifier);
  EXPECT_EQ(calibration.rectifier->raw().left.lens, Lens::equidistant);
  const std::string beside = kSide.substr(1) + R"("left": )" + fisheye + R"(, "right": )" + fisheye;
  const auto nested = load_calibration(folder.write("c", R"({"rig": {)" + beside + R"(}, "baseline": 0.0499})"));
  EXPECT_EQ(nested.left_name, "rig.left");
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
