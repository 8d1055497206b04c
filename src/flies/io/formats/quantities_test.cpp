// The numbers of a rectified camera under the names, in the units and below the keys that people and scripts give them.
#include "flies/io/formats/quantities.hpp"

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
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_camera(const std::string& text) {
  SCOPED_TRACE(text);
  const TemporaryFolder folder;
  const auto calibration = load_calibration(folder.write("c", text));
  const auto& camera = calibration.camera;
  EXPECT_FALSE(calibration.rectifier);
  EXPECT_EQ(camera.fx_px, 700.0);
  EXPECT_EQ(camera.fy_px, 710.0);
  EXPECT_EQ(camera.cx_px, 320.0);
  EXPECT_EQ(camera.cy_px, 240.0);
  EXPECT_NEAR(camera.baseline_m, 0.12, 1e-12);
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.height_px, 480);
}

std::string error(const std::string& text) {
  const TemporaryFolder folder;
  return error_of([&] { load_calibration(folder.write("c", text)); });
}

const std::string kCamera = "fx: 700\nfy: 710\ncx: 320\ncy: 240\n";
const std::string kSize = "width: 640\nheight: 480\n";

TEST(Quantities, BaselinesAreReadInTheUnitThatTheFileNames) {
  for (const char* baseline :
       {"baseline_mm: 120\n", "baseline_cm: 12\n", "baselineInMeters: 0.12\n", "stereo_baseline: 0.12\n",
        "baseline: 120 mm\n", "baseline: 12\nunits: cm\n", "baseline: 120\nbaseline_unit: MILLIMETERS\n",
        "baseline_mm: 120\nunits: m\n", "bf: 84\n", "baseline: 0.12\nbf: 84\n", "b: 0.12\n", "Tx: -0.12\n",
        "Tx: -120\nunits: mm\n", "baseline: 0.12\nunits: px\n", "baseline: 0.12\nboard: {units: cm}\n",
        "units: cm\nrig: {baseline: 120, units: mm}\n"})
    expect_camera(kCamera + kSize + baseline);
}

TEST(Quantities, LinesOfAssignmentsMayQuoteWords) {
  const std::string lines = "fx = 700\nfy = 710\ncx = 320\ncy = 240\n";
  expect_camera(lines + "baseline = 120\nunits = \"mm\"\nresolution = '640x480'; % of the images\n");
  expect_camera(lines + "baseline = \"12 cm\"  # of the box\nwidth = 640\nheight = 480\n");
  EXPECT_THAT(error("K = [700 0 0; 0 700 0; 320 240 1]'\nbaseline = 0.12\n"), HasSubstr("K: found '''"));
}

TEST(Quantities, TwoBaselinesThatDifferAreRefused) {
  EXPECT_THAT(error(kCamera + "baseline: 0.12\nbf: 42\n"),
              HasSubstr("baseline, bf: say 0.12 m and 0.06 m, expected the same distance of the cameras"));
  EXPECT_THAT(error(kCamera + "baseline: 0.12\nbaseline_mm: 60\n"), HasSubstr("which is meant?"));
  EXPECT_THAT(error("fx: 0\ncx: 320\ncy: 240\nbf: 84\n"), HasSubstr("fx_px (focal length): found 0"));
  EXPECT_THAT(error(kCamera + "baseline: 1\nunits: furlongs\n"),
              HasSubstr("units: found 'furlongs', expected m, cm, mm or inches"));
}

TEST(Quantities, CamerasMayBeMatricesListsOrStandBelowAKey) {
  const std::string baseline = "baseline: 0.12\n";
  for (const char* camera :
       {"K: [700, 0, 320, 0, 710, 240, 0, 0, 1]\n", "camera_matrix: [[700, 0, 320], [0, 710, 240], [0, 0, 1]]\n",
        "intrinsics: [700, 710, 320, 240]\n", "focal_length: [700, 710]\nprincipal_point: [320, 240]\n",
        "intrinsics: {fx: 700, fy: 710, cx: 320, cy: 240}\n", "FX: 700\nFY: 710\nCX: 320\nCY: 240\n",
        "K: [700, 0, 320, 0, 710, 240, 0, 0, 1]\nfx: 700\nfy: 710\ncx: 320\ncy: 240\n",
        "left: {fx: 700, fy: 710, cx: 320, cy: 240}\n"})
    expect_camera(camera + baseline + kSize);
  expect_camera(R"({"stereo": {"fx": 700, "fy": 710, "cx": 320, "cy": 240, "baseline": 0.12,)"
                R"( "width": 640, "height": 480}})");
  for (const char* lines :
       {"fx=700\nfy=710\ncx=320\ncy=240\nbaseline=0.12\nwidth=640\nheight=480\n",
        "[camera]\nfx = 700\nfy = 710\ncx = 320\ncy = 240\nbaseline = 0.12\nresolution = [640, 480]\n",
        "fx,fy,cx,cy,baseline,width,height\n700,710,320,240,0.12,640,480\n"})
    expect_camera(lines);
}

TEST(Quantities, AMatrixColumnByColumnIsReadAndTold) {
  const std::string text =
      "intrinsic_matrix: [700, 0, 0, 0, 710, 0, 320, 240, 1]\nbaseline: 0.12\nwidth: 640\nheight: 480\n";
  expect_camera(text);
  const TemporaryFolder folder;
  EXPECT_THAT(texts(load_calibration(folder.write("c", text)).notes), Contains(HasSubstr("column by column")));
}

TEST(Quantities, WhatTwoPlacesSayDifferentlyIsRefused) {
  const std::string one = "{fx: 700, fy: 710, cx: 320, cy: 240}", other = "{fx: 400, fy: 400, cx: 300, cy: 200}";
  EXPECT_THAT(error("near: {lens: " + one + "}\nfar: {lens: " + one + "}\nbaseline: 0.12\n"), HasSubstr("cameras"));
  EXPECT_THAT(error("K: [400, 0, 320, 0, 400, 240, 0, 0, 1]\n" + kCamera + "baseline: 0.12\n"),
              HasSubstr("fx, K: say fx 700 and 400 px"));
  EXPECT_THAT(error("a: {K: [700, 0, 320, 0, 710, 240, 0, 0, 1]}\nb: {K: [400, 0, 320, 0, 400, 240, 0, 0, 1]}\n"),
              HasSubstr("a.K: stands in the file as b.K too, with other numbers"));
  EXPECT_THAT(error("fx: 700,5\ncx: 320,1\ncy: 240\nbaseline: 0.12\n"), HasSubstr("fx: found 2 numbers, expected 1"));
  EXPECT_THAT(error(kCamera + "baseline: 0,12\n"), HasSubstr("baseline: found 2 numbers, expected 1"));
}

TEST(Quantities, AnotherCameraBelowAKeySaysNothingOfTheOneBelowNone) {
  const TemporaryFolder folder;
  const auto camera =
      load_calibration(folder.write("c",
                                    "fx: 700\ncx: 320\ncy: 240\nbaseline: 0.12\n"
                                    "rgb: {fx: 1400, fy: 1500, cx: 640, cx1: 650, cy: 360, width: 1280, height: 720}"
                                    "\n"))
          .camera;
  EXPECT_EQ(camera.fy_px, 700.0);
  EXPECT_EQ(camera.cx_right_px, 320.0);
  EXPECT_EQ(camera.width_px, 0);
}

TEST(Quantities, SizesAreListsAndWordsToo) {
  for (const char* size :
       {"resolution: [640, 480]\n", "resolution: 640x480\n", "frame_size: 640*480\n", "image_size: 640 x 480\n",
        "image_size: {width: 640, height: 480}\n", "image_shape: [480, 640, 3]\n", "imageShape: [480, 640]\n",
        "img_width: 640\nimg_height: 480\n"})
    expect_camera(kCamera + "baseline: 0.12\n" + size);
  EXPECT_THAT(error(kCamera + "baseline: 0.12\nimage_size: [480, 640]\n"), HasSubstr("are swapped"));
}

TEST(Quantities, SizesThatContradictEachOtherAreRefusedUnlessOneIsSaid) {
  const std::string camera = kCamera + "baseline: 0.12\n";
  for (const char* other : {"image_width: 1280\nimage_height: 960\n", "image_size: [1280, 960]\n",
                            "resolution: 1280x960\n", "image_shape: [960, 1280, 3]\n"})
    EXPECT_THAT(error(camera + kSize + other),
                AllOf(HasSubstr("1280 x 960 px"), HasSubstr("640 x 480 px"), HasSubstr("--calib-size W,H says it")));
  for (const char* same : {"image_width: 640\nimage_height: 480\n", "image_size: [480, 640]\n", "resolution: 640x480\n",
                           "image_shape: [480, 640, 3]\n"})
    expect_camera(camera + kSize + same);
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.calibrated_width_px = 1280;
  request.calibrated_height_px = 960;
  const auto text = camera + kSize + "image_size: [1280, 960]\n";
  EXPECT_EQ(load_calibration(folder.write("c", text), request).camera.width_px, 1280);
}

TEST(Quantities, SizesOfOtherThingsAreNotThoseOfTheImages) {
  const std::string camera = "camera: {fx: 700, fy: 710, cx: 320, cy: 240, width: 640, height: 480}\nbaseline: 0.12\n";
  for (const char* other : {"board: {width: 9, height: 6}\n", "vehicle: {width: 1.8, height: 1.5}\n",
                            "board: {size: [9, 6]}\n", "board: {width: 9, rows: 6}\n"}) {
    expect_camera(camera + other);
    expect_camera(kCamera + "baseline: 0.12\nimage: {width: 640, height: 480}\n" + other);
    const TemporaryFolder folder;
    const auto unsized = folder.write("c", kCamera + "baseline: 0.12\n" + other);
    EXPECT_EQ(load_calibration(unsized).camera.width_px, 0) << other;
  }
  expect_camera(kCamera + "baseline: 0.12\nimage_width: 640\nimage_height: 480\nwidth: 9\nheight: 6\n");
}

TEST(Quantities, AFocalLengthInMetresIsNamedByItsKey) {
  EXPECT_THAT(error("f: 0.004\ncx: 320\ncy: 240\nbaseline: 0.12\n" + kSize),
              AllOf(HasSubstr("f: found 0.004 px"), HasSubstr("is it in metres, or normalised")));
  EXPECT_THAT(error("f: 4\ncx: 320\ncy: 240\nbaseline: 0.12\n" + kSize),
              AllOf(HasSubstr("f: found 4 px"), HasSubstr("is it in millimetres, or normalised")));
}

TEST(Quantities, OneCameraAloneIsToldWhatIsMissing) {
  const std::string mono =
      "image_width: 640\nimage_height: 480\ncamera_matrix: [700, 0, 320, 0, 710, 240, 0, 0, 1]\n"
      "distortion_coefficients: [-0.2, 0.1, 0, 0, 0]\n";
  const auto is_told = HasSubstr("camera_matrix: describes one camera: the other one, and R and T between them");
  EXPECT_THAT(error(mono), is_told);
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.right_path = folder.write("r", mono);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", mono), request); }), HasSubstr("R, T: are missing"));
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", kCamera + "baseline: 0.12\n"), request); }),
              AllOf(HasSubstr("right calibration: is not used"), Not(is_told)));
}

TEST(Quantities, AFisheyeBesideRectifiedNumbersIsTold) {
  const TemporaryFolder folder;
  const auto notes = [&](const std::string& more) {
    return texts(load_calibration(folder.write("c", kCamera + kSize + "baseline: 0.12\n" + more)).notes);
  };
  EXPECT_THAT(notes("model: fisheye\n"), Contains(HasSubstr("though the file says 'fisheye'")));
  EXPECT_THAT(notes("model: pinhole\nname: front\n"), Not(Contains(HasSubstr("though"))));
}

/// Two cameras of the rig, without what lies between them.
std::string sides(const ToyRig& rig) {
  const auto side = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return fmt::format("{{fx: {}, fy: {}, cx: {}, cy: {}, disto: {}, image_size: {{width: 640, height: 480}}}}",
                       m(0, 0), m(1, 1), m(0, 2), m(1, 2), list(d));
  };
  return "left_cam: " + side(rig.m1, rig.d1) + "\nright_cam: " + side(rig.m2, rig.d2) + "\n";
}

TEST(Quantities, TwoCamerasStandAsRAndTOrATransformSay) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const cv::Mat pose = right_from_left(rig), inverted = pose.inv();
  cv::Mat in_millimetres = inverted.clone();
  in_millimetres(cv::Rect(3, 0, 1, 3)) *= 1000.0;
  const std::string r = "R: " + rows(cv::Mat(rig.r)) + "\n", t = "T: " + list({rig.t[0], rig.t[1], rig.t[2]}) + "\n",
                    in_centimetres = "T: " + list({100 * rig.t[0], 100 * rig.t[1], 100 * rig.t[2]}) + "\n";
  for (const std::string& between :
       {r + t, "stereo_transform: " + rows(inverted) + "\n", "stereo_transform: " + rows(in_millimetres) + "\n",
        "unit: mm\nstereo_transform: " + rows(in_millimetres) + "\n", "units: cm\n" + r + in_centimetres,
        "extrinsics_left_to_right: " + rows(pose) + "\n",
        r + t + fmt::format("baseline_mm: {}\n", 1000 * cv::norm(rig.t))}) {
    SCOPED_TRACE(between);
    expect_rectifies(load_calibration(folder.write("c", sides(rig) + between)), rig);
  }
  EXPECT_THAT(error(sides(rig) + r + t + "baseline: 0.5\n"), HasSubstr("baseline, T: say 0.5 m and 0.1201 m"));
  EXPECT_THAT(error(sides(rig) + t), HasSubstr("R: is missing"));
  const std::string others =
      "rgb: {fx: 900, fy: 900, cx: 320, cy: 240}\nextrinsics: {translation: [-0.12, 0, 0], "
      "rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n";
  EXPECT_EQ(error(sides(rig) + others + fmt::format("baseline: 0.12\nbf: {}\n", 0.12 * rig.m1(0, 0))), "no error");
  EXPECT_THAT(error(sides(rig)), HasSubstr("baseline (or R and T, "));
}

}  // namespace
}  // namespace flies
