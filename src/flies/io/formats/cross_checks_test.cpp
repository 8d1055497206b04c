// What a file says twice, or of how its calibration went.
#include "flies/io/formats/cross_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::rectified;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Calibration load(const std::string& text, const CalibrationRequest& request = {}) {
  const TemporaryFolder folder;
  return load_calibration(folder.write("c", text), request);
}

std::vector<std::string> doubts(const std::string& text, const CalibrationRequest& request = {}) {
  return texts(load(text, request).notes, {CalibrationNoteKind::doubt});
}

std::string fault_of(const std::string& text) {
  return error_of([&] { load(text); });
}

const std::string kCamera = "fx: 700\ncx: 310\ncy: 240\nwidth: 640\nheight: 480\n";

TEST(CrossChecks, DoffsMovesThePrincipalPointOfTheRightCameraInAllFormats) {
  const std::string doffs = "doffs: 20\n", side = "{fx: 700, fy: 700, cx: 310, cy: 240}\n";
  for (const std::string& text : {kCamera + "baseline: 0.12\n", "left: " + side + "right: " + side + "baseline: 0.12\n",
                                  std::string("fx: 700\nfy: 700\ncx0: 310\ncx1: 310\ncy: 240\nbaseline_meters: 0.12\n"),
                                  kCamera + "cx1: 330.2\nbaseline: 0.12\n"})
    EXPECT_NEAR(load(text + doffs).camera.cx_right_px, 330.0, 0.3) << text;
  EXPECT_THAT(fault_of(kCamera + "cx1: 335\nbaseline: 0.12\n" + doffs),
              AllOf(HasSubstr("doffs: found 20 px"), HasSubstr("differ by 25 px: which is meant?")));
}

/// Everything that OpenCV's stereo_calib leaves.
struct OpenCvFile {
  ToyRig rig;
  flies::testing::Rectified to = rectified(ToyRig());
  std::string more;

  std::string text() const {
    return "image_width: 640\nimage_height: 480\nM1: " + rows(cv::Mat(rig.m1)) + "\nM2: " + rows(cv::Mat(rig.m2)) +
           "\nD1: " + list(rig.d1) + "\nD2: " + list(rig.d2) + "\nR: " + rows(cv::Mat(rig.r)) +
           "\nT: " + list(numbers(cv::Mat(rig.t))) + "\nR1: " + rows(to.r1) + "\nR2: " + rows(to.r2) +
           "\nP1: " + rows(to.p1) + "\nP2: " + rows(to.p2) + "\nQ: " + rows(to.q) + "\n" + more;
  }
};

TEST(CrossChecks, OpenCvsMatricesThatContradictEachOtherAreTold) {
  const CalibrationRequest raw = flies::testing::of_raw_images();
  EXPECT_THAT(doubts(OpenCvFile().text()), IsEmpty());
  EXPECT_THAT(doubts(OpenCvFile().text(), raw), IsEmpty());
  OpenCvFile file;
  file.rig.t *= 2.0;
  EXPECT_THAT(doubts(file.text()), Contains(HasSubstr("T gives a baseline of 0.2401 m, P1 and P2 one of 0.1201 m")));
  EXPECT_THAT(doubts(file.text(), raw), Contains(HasSubstr("P2 gives a baseline of 0.1201 m, T one of 0.2401")));
  file.rig.t *= 500.0;  // millimetres
  EXPECT_THAT(doubts(file.text()), IsEmpty());
  file = {};
  file.to.q.at<double>(2, 3) *= 1.3;
  EXPECT_THAT(doubts(file.text()), Contains(HasSubstr("Q gives a focal length of")));
  file.to.q.at<double>(3, 2) *= 0.5;
  EXPECT_THAT(doubts(file.text()), Contains(HasSubstr("Q gives a baseline of 0.2401 m")));
  file = {};
  file.more = "baseline: 0.54\n";
  EXPECT_THAT(doubts(file.text()),
              Contains(HasSubstr("baseline gives a baseline of 0.54 m, the rest of the file one of 0.1201 m")));
  CalibrationRequest said;
  said.baseline_m = 0.12;
  EXPECT_THAT(doubts(file.text(), said), IsEmpty());
}

TEST(CrossChecks, ACameraByHandBesideProjectionsIsTold) {
  const std::string projections =
      "P1: [900, 0, 310, 0, 0, 900, 240, 0, 0, 0, 1, 0]\n"
      "P2: [900, 0, 310, -108, 0, 900, 240, 0, 0, 0, 1, 0]\n";
  EXPECT_THAT(doubts(kCamera + "baseline: 0.12\n" + projections),
              Contains(HasSubstr("fx gives a focal length of 700 px, P1 one of 900 px, which is used")));
}

TEST(CrossChecks, TranslationsBesideABaselineByHandAreCompared) {
  const std::string camera = kCamera + "baseline: 0.12\n";
  EXPECT_THAT(fault_of(camera + "Tx: -0.24\n"), HasSubstr("baseline, Tx: say 0.12 m and 0.24 m"));
  EXPECT_THAT(doubts(camera + "T: [-0.24, 0, 0]\n"),
              Contains(HasSubstr("T gives a baseline of 0.24 m, baseline one of 0.12 m, which is used")));
  const auto q = [](double over_baseline) {
    return fmt::format("Q: [1, 0, 0, -310, 0, 1, 0, -240, 0, 0, 0, 700, 0, 0, {}, 0]\n", over_baseline);
  };
  EXPECT_THAT(doubts(camera + q(1 / 0.12)), IsEmpty());
  EXPECT_THAT(doubts(camera + q(1 / 0.24)),
              Contains(HasSubstr("baseline gives a baseline of 0.12 m, the rest of the file one of 0.24 m")));
  for (const char* same : {"Tx: -0.12\n", "Tx: -120\n", "Tx: -84\n", "T: [-120, 0, 0]\n", "T: [-0.12, 0, 0.001]\n",
                           "tx: 1.5\nty: 0\ntz: 1.2\n", "T: [1.5, 0, 1.2]\n"})
    EXPECT_THAT(doubts(camera + same), IsEmpty()) << same;
}

TEST(CrossChecks, CalibrationsThatSayThatTheyFailedAreTold) {
  const std::string camera = kCamera + "baseline: 0.12\n";
  for (const char* error : {"rms: 35.2\n", "avg_reprojection_error: 12.5\n", "stereo: {RMS: 3.1}\n"})
    EXPECT_THAT(doubts(camera + error), Contains(HasSubstr("misses the corners of its board"))) << error;
  EXPECT_THAT(doubts(camera + "rms: 0.35\nreprojection_errors: [3, 4]\n"), IsEmpty());
}

TEST(CrossChecks, UnitsBesideOpenCvsNamesCount) {
  OpenCvFile file;
  const double baseline_m = cv::norm(file.rig.t);
  file.rig.t *= 100.0;
  file.to.p2.at<double>(0, 3) *= 100.0;
  file.more = "units: cm\n";
  EXPECT_NEAR(load(file.text()).camera.baseline_m, baseline_m, 1e-6);
  EXPECT_NEAR(load(file.text(), flies::testing::of_raw_images()).camera.baseline_m, baseline_m, 1e-6);
  file = {};
  file.more = "square_size: 25\nunits: mm\n";  // of the board
  EXPECT_NEAR(load(file.text()).camera.baseline_m, baseline_m, 1e-6);
  EXPECT_THAT(doubts(file.text()), Contains(HasSubstr("is taken as metres")));
}

std::string camchain(const char* inertial_of_right) {
  return std::string("cam0:\n  T_cam_imu: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n  camera_model: pinhole\n") +
         "  intrinsics: [461, 460, 363, 248]\n  distortion_model: radtan\n  distortion_coeffs: [-0.2, 0.05, 0, 0]\n"
         "  resolution: [752, 480]\ncam1:\n  T_cam_imu: " +
         inertial_of_right +
         "\n  T_cn_cnm1: [1,0,0,-0.11, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n  camera_model: pinhole\n"
         "  intrinsics: [461, 460, 363, 248]\n  distortion_model: radtan\n  distortion_coeffs: [-0.2, 0.05, 0, 0]\n"
         "  resolution: [752, 480]\n";
}

TEST(CrossChecks, PosesOfTheInertialUnitAreHeldAgainstTheChain) {
  EXPECT_THAT(doubts(camchain("[1,0,0,-0.11, 0,1,0,0, 0,0,1,0, 0,0,0,1]")), IsEmpty());
  EXPECT_THAT(doubts(camchain("[1,0,0,-0.3, 0,1,0,0, 0,0,1,0, 0,0,0,1]")),
              Contains(HasSubstr("T_cam_imu gives a baseline of 0.3 m, T_cn_cnm1 one of 0.11 m, which is used")));
  EXPECT_THAT(doubts(camchain("[0,0,0,0]")), IsEmpty());
}

TEST(CrossChecks, StereoBIsHeldAgainstThePose) {
  const auto settings = [](const char* b) {
    std::string text = "Camera.type: PinHole\nCamera.width: 640\nCamera.height: 480\n";
    for (const char* camera : {"Camera1", "Camera2"})
      for (const char* number : {"fx: 500", "fy: 500", "cx: 320", "cy: 240", "k1: -0.1", "k2: 0", "p1: 0", "p2: 0"})
        text += std::string(camera) + "." + number + "\n";
    return text + "Stereo.T_c1_c2: [1,0,0,0.11, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nStereo.b: " + b + "\n";
  };
  EXPECT_THAT(doubts(settings("0.11")), IsEmpty());
  EXPECT_THAT(doubts(settings("0.25")), Contains(HasSubstr("Stereo.b gives a baseline of 0.25 m")));
}

TEST(CrossChecks, MatlabsTwoNamesOfOneMatrixAreCompared) {
  const auto camera = [](const char* k) {
    return std::string(
               "{RadialDistortion: [-0.2, 0.05], TangentialDistortion: [0, 0], ImageSize: [480, 640], "
               "IntrinsicMatrix: [500, 0, 0, 0, 500, 0, 321, 241, 1], K: ") +
           k + "}\n";
  };
  const auto file = [&](const char* k, const char* pose) {
    return "CameraParameters1: " + camera(k) + "CameraParameters2: " + camera("[500, 0, 321, 0, 500, 241, 0, 0, 1]") +
           "RotationOfCamera2: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nTranslationOfCamera2: [-120, 0, 0]\n" + pose;
  };
  const char* k = "[500, 0, 321, 0, 500, 241, 0, 0, 1]";
  EXPECT_THAT(doubts(file(k, "PoseCamera2: {Translation: [120, 0, 0]}\n")), IsEmpty());
  EXPECT_THAT(doubts(file("[550, 0, 321, 0, 550, 241, 0, 0, 1]", "")),
              Contains(HasSubstr("CameraParameters1.IntrinsicMatrix gives a focal length of 500 px")));
  EXPECT_THAT(doubts(file(k, "PoseCamera2: {Translation: [240, 0, 0]}\n")),
              Contains(HasSubstr("PoseCamera2.Translation gives a baseline of 0.24 m")));
}

TEST(CrossChecks, SocketsThatPointAtEachOtherAreCompared) {
  const auto camera = [](int to, double x) {
    return fmt::format(
        R"({{"cameraType": 0, "distortionCoeff": [0, 0, 0, 0, 0], "height": 800, "width": 1280, )"
        R"("intrinsicMatrix": [[800, 0, 640], [0, 800, 400], [0, 0, 1]], "extrinsics": {{"toCameraSocket": {}, )"
        R"("rotationMatrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "translation": {{"x": {}, "y": 0, "z": 0}}}}}})",
        to, x);
  };
  const auto file = [&](double back) {
    return fmt::format(R"({{"cameraData": [[1, {}], [2, {}]]}})", camera(2, -7.5), camera(1, back));
  };
  EXPECT_THAT(doubts(file(7.5)), IsEmpty());
  EXPECT_THAT(doubts(file(15.0)), Contains(HasSubstr("extrinsics by way of socket 2 gives a baseline of 0.075 m")));
}

std::string realsense(const char* back) {
  std::string text;
  for (const char* stream : {"Infrared 1", "Infrared 2"})
    text += fmt::format(
        " Intrinsic of \"{}\" / 640x480 / {{Y8}}\n  Width: 640\n  Height: 480\n  PPX: 320\n  PPY: 240\n  Fx: 386\n"
        "  Fy: 386\n  Distortion: Brown Conrady\n  Coeffs: 0 0 0 0 0\n\n",
        stream);
  const auto extrinsic = [](const char* from, const char* to, const char* x) {
    return fmt::format(
        " Extrinsic from \"{}\" To \"{}\" :\n Rotation Matrix:\n  1 0 0\n  0 1 0\n  0 0 1\n\n Translation Vector: {} 0 "
        "0\n\n",
        from, to, x);
  };
  return text + extrinsic("Infrared 1", "Infrared 2", "-0.05") + extrinsic("Infrared 2", "Infrared 1", back);
}

TEST(CrossChecks, RealSensesPosesThereAndBackAreCompared) {
  EXPECT_THAT(doubts(realsense("0.05")), IsEmpty());
  EXPECT_THAT(doubts(realsense("0.095")), Contains(HasSubstr("gives a baseline of 0.095 m")));
}

}  // namespace
}  // namespace flies
