// The numbers of known formats in other places: below keys, in XML, between lines of ---, under MATLAB's names, in Q.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/number_table.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::kWritten_m;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::rectified;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(NestedFormats, XmlOfMapsRectifies) {
  const TemporaryFolder folder;
  const ToyRig rig;
  cv::FileStorage file(".xml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  file << "image_width" << 640 << "image_height" << 480;
  file << "left"
       << "{"
       << "K" << cv::Mat(rig.m1) << "D" << cv::Mat(rig.d1).t() << "}";
  file << "right"
       << "{"
       << "K" << cv::Mat(rig.m2) << "D" << cv::Mat(rig.d2).t() << "}";
  file << "R" << cv::Mat(rig.r) << "T" << cv::Mat(rig.t);
  expect_rectifies(load_calibration(folder.write("c.xml", file.releaseAndGetString())), rig);
}

TEST(NestedFormats, XmlCountsTheMapsOfLists) {
  const auto table = parse_number_table(
      "<opencv_storage><a><_><b>1</b></_><_><b>2 3</b></_></a><c><_>4</_><_>5</_></c></opencv_storage>", "c");
  EXPECT_EQ(table.require_number("a.0.b"), 1.0);
  EXPECT_EQ(table.require("a.1.b"), (std::vector<double>{2, 3}));
  EXPECT_EQ(table.require("c"), (std::vector<double>{4, 5}));
}

TEST(NestedFormats, BothCamerasMayStandBelowOneKey) {
  const TemporaryFolder folder;
  for (const bool is_fisheye : {false, true}) {
    const ToyRig rig = is_fisheye ? ToyRig::fisheye() : ToyRig();
    const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
      return "{\"K\": " + rows(cv::Mat(m)) + ", \"D\": " + list(d) + "}";
    };
    const std::string pair = fmt::format(R"({{"left": {}, "right": {}, "R": {}, "T": {}}})", camera(rig.m1, rig.d1),
                                         camera(rig.m2, rig.d2), rows(cv::Mat(rig.r)), list(numbers(cv::Mat(rig.t))));
    const std::string key = is_fisheye ? "fisheye_pair" : "pair", size = R"(, "image_size": [640, 480]})";
    expect_rectifies(load_calibration(folder.write("c.json", "{\"" + key + "\": " + pair + size)), rig);
    EXPECT_THAT(
        error_of([&] { load_calibration(folder.write("c.json", R"({"a": )" + pair + R"(, "b": )" + pair + size)); }),
        HasSubstr("a.left.K: stands in the file as a.right.K too, with other numbers"));
  }
}

TEST(NestedFormats, QAloneIsTheRectifiedCamera) {
  const TemporaryFolder folder;
  const auto to = rectified(ToyRig());
  const auto calibration =
      load_calibration(folder.write("c.json", "{\"Q\": " + rows(to.q) + ", \"image_size\": [640, 480]}"));
  EXPECT_NEAR(calibration.camera.fx_px, to.p1.at<double>(0, 0), 1e-9);
  EXPECT_NEAR(calibration.camera.cx_px, to.p1.at<double>(0, 2), 1e-9);
  EXPECT_NEAR(calibration.camera.cx_right_px, to.p2.at<double>(0, 2), 1e-9);
  EXPECT_NEAR(calibration.camera.cy_px, to.p1.at<double>(1, 2), 1e-9);
  EXPECT_NEAR(calibration.camera.baseline_m, cv::norm(ToyRig().t), kWritten_m);
  EXPECT_EQ(calibration.camera.width_px, 640);
  const std::string turned = "Q: [1, 0, 0, -320, 0, -1, 0, 240, 0, 0, 0, -512, 0, 0, 1, 0]\n";
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", turned)); }), HasSubstr("as stereoRectify gives it"));
  const std::string beside_a_pose = "Q: " + rows(to.q) + "\nR: [0, 0, 0]\nT: [-0.12, 0, 0]\nleftIntr: [1, 2, 3]\n";
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", beside_a_pose)); }),
              HasSubstr("M1, D1, M2, D2: are missing"))
      << "of raw images, by names that are not known";
}

TEST(NestedFormats, QSaysHowFarThePrincipalPointsLieApart) {
  const TemporaryFolder folder;
  const auto camera =
      load_calibration(folder.write("c", "Q: [1, 0, 0, -320, 0, 1, 0, -240, 0, 0, 0, 400, 0, 0, 8, 40]\n")).camera;
  EXPECT_DOUBLE_EQ(camera.cx_right_px, 325.0);  // at infinity, where d = cx - cx' = -5, nothing of W is left
  EXPECT_DOUBLE_EQ(camera.baseline_m, 0.125);
}

TEST(NestedFormats, MatlabsNamesForOpenCvHaveMillimetresAndRowsFirst) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto text = [&](double scale) {
    return fmt::format(
        R"({{"intrinsicMatrix1": {}, "distortionCoefficients1": {}, "intrinsicMatrix2": {}, )"
        R"("distortionCoefficients2": {}, "rotationOfCamera2": {}, "translationOfCamera2": {}, "imageSize": [480, 640]}})",
        rows(cv::Mat(rig.m1)), list(rig.d1), rows(cv::Mat(rig.m2)), list(rig.d2), rows(cv::Mat(rig.r)),
        list(numbers(cv::Mat(scale * rig.t))));
  };
  for (const auto& [scale, unit] : {std::pair{1e3, "millimetres"}, std::pair{1.0, "metres"}}) {
    const auto calibration = load_calibration(folder.write("c.json", text(scale)));
    EXPECT_THAT(texts(calibration.notes),
                Contains(AllOf(HasSubstr("translationOfCamera2 is taken as "), HasSubstr(unit))));
    EXPECT_EQ(calibration.camera.width_px, 640);
    expect_rectifies(calibration, rig);
  }
}

/// A message of ROS as it is printed.
/// @param more of its keys
std::string message(const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r, const cv::Mat& p,
                    const std::string& more = "") {
  return "header:\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: " + list(d) +
         "\nK: " + list(numbers(cv::Mat(m))) + "\nR: " + list(numbers(r)) + "\nP: " + list(numbers(p)) + "\n" + more +
         "---\n";
}

TEST(NestedFormats, MessagesOfBothCamerasMayStandInOneFile) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const std::string left = message(rig.m1, rig.d1, to.r1, to.p1), right = message(rig.m2, rig.d2, to.r2, to.p2);
  const std::string cut_in_a_line = left.substr(0, left.find("P: ") + 20), cut_between_lines = left.substr(0, 40);
  for (const std::string& text :
       {left + right, left + right + left + right, left + right + cut_in_a_line, left + right + cut_between_lines}) {
    const auto path = folder.write("c.yaml", text);
    EXPECT_NEAR(load_calibration(path).camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(load_calibration(path, of_raw_images()), rig);
  }
  cv::Mat third = to.p2.clone();
  third.at<double>(0, 3) *= 2.0;
  EXPECT_THAT(
      error_of([&] { load_calibration(folder.write("c.yaml", left + right + message(rig.m2, rig.d2, to.r2, third))); }),
      HasSubstr("holds 3 cameras between lines of ---"));
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c.yaml", left + cut_in_a_line)); }),
              HasSubstr("the message behind the first one is cut off"));
  folder.write("right.yaml", right + right);
  EXPECT_NEAR(load_calibration(folder.write("left.yaml", left + left)).camera.baseline_m, cv::norm(rig.t), kWritten_m);
}

TEST(NestedFormats, MessagesMaySayThatTheRightCameraComesFirst) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto named = [](const std::string& name, std::string text) {
    return text.replace(text.find("frame_id: camera"), 16, "frame_id: " + name);
  };
  const std::string left = message(rig.m1, rig.d1, to.r1, to.p1), right = message(rig.m2, rig.d2, to.r2, to.p2);
  for (const std::string& text :
       {named("left", left) + named("right", right), named("right", right) + named("left", left),
        named("right", left) + named("left", right)})
    expect_rectifies(load_calibration(folder.write("c.yaml", text), of_raw_images()), rig);
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c.yaml", right + left)); }),
              HasSubstr("left and right are swapped"));
}

TEST(NestedFormats, MessagesMayStandInAListOrBelowTheirTopics) {
  const TemporaryFolder folder;
  const ToyRig rig;
  const auto to = rectified(rig);
  const auto indented = [](const std::string& message) {
    std::string text;
    std::istringstream lines(message.substr(0, message.find("---")));
    for (std::string line; std::getline(lines, line);) text += "  " + line + "\n";
    return text;
  };
  const std::string left = indented(message(rig.m1, rig.d1, to.r1, to.p1)),
                    right = indented(message(rig.m2, rig.d2, to.r2, to.p2));
  for (const std::string& text :
       {"/stereo/left/camera_info:\n" + left + "/stereo/right/camera_info:\n" + right, "-\n" + left + "-\n" + right,
        "color:\n" + right + "left:\n" + left + "right:\n" + right}) {
    SCOPED_TRACE(text);
    const auto path = folder.write("c.yaml", text);
    EXPECT_NEAR(load_calibration(path).camera.baseline_m, cv::norm(rig.t), kWritten_m);
    expect_rectifies(load_calibration(path, of_raw_images()), rig);
  }
}

TEST(NestedFormats, WhatOpenCvAppendedIsReadToo) {
  const auto table = parse_number_table("%YAML:1.0\n---\na: 1\n...\n---\nb: 2\n", "c");
  EXPECT_EQ(table.require_number("a") + table.require_number("b"), 3.0);
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "P: " + std::to_string(i) + "\n---\n";
  EXPECT_THAT(error_of([&] { parse_number_table(many, "c"); }), HasSubstr("holds 2000 documents"));
  EXPECT_THAT(error_of([] { parse_number_table("a: 1\n---\na: 2\n", "c"); }),
              HasSubstr("a: stands in two of the 2 documents"));
}

TEST(NestedFormats, WindowsOfRosAreThoseOfImagesOfTheirSize) {
  const TemporaryFolder folder;
  const std::string roi = "binning_x: 2\nbinning_y: 2\nroi: {x_offset: 100, y_offset: 40, height: 300, width: 500}\n";
  const cv::Matx33d m(400, 0, 320, 0, 400, 240, 0, 0, 1);
  const auto text = [&](double shift) {
    const cv::Mat p = (cv::Mat_<double>(3, 4) << 400, 0, 320, shift, 0, 400, 240, 0, 0, 0, 1, 0);
    return message(m, {0, 0, 0, 0, 0}, cv::Mat::eye(3, 3, CV_64F), p, roi);
  };
  folder.write("right.yaml", text(-48.0));
  const auto left = folder.write("left.yaml", text(0.0));
  const auto load = [&](int width_px, int height_px, bool is_raw) {
    CalibrationRequest request;
    request.width_px = width_px;
    request.height_px = height_px;
    request.images_are_raw = is_raw;
    return load_calibration(left, request);
  };
  const auto unseen = load(0, 0, false), whole = load(640, 480, false), window = load(500, 300, false),
             binned = load(250, 150, false);
  EXPECT_EQ(whole.camera.cx_px, 320.0);
  EXPECT_THAT(texts(whole.notes), Not(Contains(HasSubstr("roi"))));
  EXPECT_EQ(unseen.camera.cx_px, 320.0);
  EXPECT_THAT(texts(unseen.notes),
              Contains(HasSubstr("roi, a window of 500 x 300 px at column 100, row 40, is ignored")));
  EXPECT_THAT(texts(window.notes), Contains(HasSubstr("roi is read as a window of 500 x 300 px")));
  EXPECT_EQ(window.camera.cx_px, 220.0);
  EXPECT_EQ(window.camera.cx_right_px, 220.0);
  EXPECT_EQ(window.camera.cy_px, 200.0);
  EXPECT_EQ(window.camera.width_px, 500);
  EXPECT_DOUBLE_EQ(window.camera.baseline_m, 0.12);
  EXPECT_DOUBLE_EQ(binned.camera.fx_px, 200.0);
  EXPECT_DOUBLE_EQ(binned.camera.cx_px, 220.5 / 2 - 0.5);
  EXPECT_EQ(load(500, 300, true).rectifier->raw().right.matrix[5], 200.0);
}

TEST(NestedFormats, FilesThatAreNoTextSayWhatTheyAre) {
  const TemporaryFolder folder;
  for (const auto& [bytes, what] :
       {std::pair{std::string("PK\x03\x04\x14\0", 6), ".npz"}, std::pair{std::string("\x93NUMPY\x01\0v\0", 10), ".npy"},
        std::pair{std::string("MATLAB 5.0 MAT-file, \0", 22), "jsonencode"},
        std::pair{std::string("\x89PNG\r\n\x1a\n\0", 9), "is a picture"},
        std::pair{std::string("II*\0", 4), "is a picture"}, std::pair{std::string("\x80\x04\x95\0", 4), "is a pickle"},
        std::pair{std::string("ARROW1\0", 7), ".feather"}, std::pair{std::string("%PDF-1.5"), "camchain"}})
    EXPECT_THAT(error_of([&, &bytes = bytes] { load_calibration(folder.write("c", bytes)); }), HasSubstr(what));
}

TEST(NestedFormats, TextsThatAreNoCalibrationSayWhatToGiveInstead) {
  const TemporaryFolder folder;
  for (const auto& [text, what] :
       {std::pair{"K: !!python/object/apply:numpy.core.multiarray.scalar\n- &id001 !!python/object/apply:numpy.dtype\n",
                  ".tolist() behind each array"},
        std::pair{"Calibration results\n===\nCamera-system parameters:\ncam0 (/cam0):\n    projection: [461. 460. 362. "
                  "246.] +- [0.1 0.1 0.1 0.1]\n",
                  "give camchain-*.yaml"},
        std::pair{"left: [ 848x480  p[421.5 236.25]  f[424.1 424.1]  Brown Conrady [0 0 0 0 0] ]\n",
                  "as Python prints them: give what rs-enumerate-devices -c writes"},
        std::pair{"%YAML:1.0\nuse_stereo: true\nrelative_config_imucam: \"kalibr_imucam_chain.yaml\"\n",
                  "give the file of the cameras that it names as relative_config_imucam"}})
    EXPECT_THAT(error_of([&, text = text] { load_calibration(folder.write("c", text)); }), HasSubstr(what));
}

}  // namespace
}  // namespace flies
