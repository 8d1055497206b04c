// Where files of OpenCV's names say what model of a lens they are of.
#include "flies/io/formats/lens_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using detail::named_lens;
using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::of_raw_images;
using flies::testing::rectified;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Lens lens_in(const std::string& text) {
  CalibrationNotes notes;
  return named_lens(parse_number_table(text, "calib"), notes);
}

TEST(NamedLens, IsFoundBelowEveryKeyThatPeopleUse) {
  for (const char* text : {"distortion_model: equidistant",
                           "distortionModel: fisheye",
                           "cameraModel: FISHEYE",
                           "lens: fisheye",
                           "camera_type: fisheye",
                           "lens_type: kannala_brandt",
                           "distortion_model: kannala_brandt4",
                           "infra1: {model: distortion.kannala_brandt4}",
                           "calibration_type: fisheye",
                           "projection: equidistant",
                           "left: {model: fisheye}",
                           "right: {distortion_model: equidistant}",
                           "distortion_model_left: equidistant",
                           "left_distortionModel_1: equidistant",
                           "distortion_model: {right: equidistant}",
                           "cam0: {lensModel: equi}",
                           "camera_model: OPENCV_FISHEYE",
                           "fisheye: true",
                           "fisheye_model: 1",
                           "is_fisheye: 1",
                           "isFisheye: yes",
                           "use_fisheye_model: 1",
                           "model_type: KANNALA_BRANDT",
                           "projection_model: kb4",
                           "lens_model: KB8"})
    EXPECT_EQ(lens_in(text), Lens::equidistant) << text;
  EXPECT_EQ(lens_in("left: {camera_model: ds}"), Lens::double_sphere);
  EXPECT_EQ(lens_in("projection_model: omni"), Lens::mei);
  EXPECT_EQ(lens_in("camera_model: omnidirectional"), Lens::mei);
}

TEST(NamedLens, IsRadialAndTangentialWhereNothingElseIsSaid) {
  for (const char* text : {"K1: [1, 2]", "distortion_model: plumb_bob", "camera_model: pinhole", "fisheye: false",
                           "fisheye_model: 0", "lens: computar", "camera_type: stereo", "projection: [1, 2]",
                           "distortion_model: plumb_bob\ncamera_name: fisheye_left", "cameraModel: ZED 2i",
                           "left: {camera_model: FLIR BFS-U3}", "image_dir: /data/fisheye_lab/left"})
    EXPECT_EQ(lens_in(text), Lens::brown) << text;
}

TEST(NamedLens, PinholeSaysNothingOfWhatBendsRays) {
  EXPECT_EQ(lens_in("camera_model: pinhole\ndistortion_model: equidistant"), Lens::equidistant);
}

TEST(NamedLens, RefusesTwoModelsUnknownOnesAndFisheyesInOtherPlaces) {
  EXPECT_THAT(error_of([] { lens_in("left: {model: fisheye}\nright: {model: plumb_bob}"); }),
              AllOf(HasSubstr("right.model"), HasSubstr("left.model"), HasSubstr("expected the same of both cameras")));
  EXPECT_THAT(error_of([] { lens_in("left: {distortion_model: bent}"); }),
              HasSubstr("left.distortion_model: found 'bent'"));
  EXPECT_THAT(error_of([] { lens_in("comment: fisheye-lenses"); }),
              AllOf(HasSubstr("comment: found 'fisheye-lenses'"), HasSubstr("distortion_model: equidistant")));
  EXPECT_THAT(error_of([] { lens_in("fisheye_balance: 0\nnote: fisheye"); }), HasSubstr("note: found 'fisheye'"));
}

TEST(NamedLens, RefusesModelsThatAreNotReadUnderAnyKey) {
  for (const char* text : {"lens_model: scaramuzza", "lens_model: division", "camera_model: cylinder", "model: OCAM",
                           "model: ftheta\nD: [1]", "lens_type: equisolid", "lens: stereographic",
                           "projection: equirectangular", "model_type: SCARAMUZZA", "projection_model: bent",
                           "model_type: bent", "distortion_model: none\nD: [0.1, 0, 0, 0]"})
    EXPECT_THAT(error_of([&] { lens_in(text); }), HasSubstr("expected")) << text;
}

TEST(NamedLens, TellsWhatMayBeAProductOrAModel) {
  const auto told = [](const std::string& text) {
    CalibrationNotes notes;
    named_lens(parse_number_table(text, "calib"), notes);
    return texts(notes, {CalibrationNoteKind::told});
  };
  EXPECT_THAT(told("camera_model: bent"), ElementsAre(HasSubstr("camera_model: 'bent' is not a known lens model")));
  EXPECT_THAT(told("camera_model: pinhole\ncamera_type: stereo\nmodel: radtan"), IsEmpty());
}

TEST(NamedLens, OfRealSenseIsReadByNameAndNumberWhereRaysAreBent) {
  const auto dump = [](const std::string& model, double coefficient) {
    return fmt::format(R"({{"left": {{"ppx": 1, "model": {}, "coeffs": [{}, 0, 0, 0, 0]}}}})", model, coefficient);
  };
  for (const char* model : {"\"distortion.kannala_brandt4\"", "\"<distortion.kannala_brandt4: 5>\"", "5",
                            "\"RS2_DISTORTION_KANNALA_BRANDT4\"", "\"Kannala Brandt4\""})
    EXPECT_EQ(lens_in(dump(model, 0.1)), Lens::equidistant) << model;
  EXPECT_EQ(lens_in(dump("4", 0.1)), Lens::brown);
  EXPECT_EQ(lens_in(dump("\"Brown Conrady\"", 0.1)), Lens::brown);
  for (const char* model :
       {"\"distortion.ftheta\"", "\"F-Theta\"", "\"distortion.inverse_brown_conrady\"", "\"Inverse Brown Conrady\"",
        "\"RS2_DISTORTION_MODIFIED_BROWN_CONRADY\"", "\"distortion.none\"", "0", "1", "2", "3"}) {
    EXPECT_THAT(error_of([&] { lens_in(dump(model, 0.1)); }),
                AllOf(HasSubstr("left.model: found"), HasSubstr("or coefficients of 0")))
        << model;
    EXPECT_EQ(lens_in(dump(model, 0.0)), Lens::brown) << model;
  }
}

TEST(NamedLens, BelowItsCameraRectifiesAFisheye) {
  const TemporaryFolder folder;
  const ToyRig rig = ToyRig::fisheye();
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d) {
    return R"({"distortion_model": "equidistant", "K": )" + rows(cv::Mat(m)) + R"(, "D": )" + list(d) + "}";
  };
  const std::string text =
      fmt::format(R"({{"image_size": [640, 480], "left": {}, "right": {}, "R": {}, "T": {}}})", camera(rig.m1, rig.d1),
                  camera(rig.m2, rig.d2), rows(cv::Mat(rig.r)), list(numbers(cv::Mat(rig.t))));
  expect_rectifies(load_calibration(folder.write("c.json", text)), rig);
}

TEST(NamedLens, OfAllIsNotThatOfMessagesOfRos) {
  const TemporaryFolder folder;
  const ToyRig rig = ToyRig::fisheye();
  const auto to = rectified(rig);
  const auto camera = [](const cv::Matx33d& m, const std::vector<double>& d, const cv::Mat& r, const cv::Mat& p) {
    return R"({"width": 640, "height": 480, "K": )" + rows(cv::Mat(m)) + R"(, "D": )" + list(d) + R"(, "R": )" +
           rows(r) + R"(, "P": )" + rows(p) + "}";
  };
  const std::string text = fmt::format(
      R"({{"distortion_model": "equidistant", "image_size": [640, 480], "left": {}, "right": {}, "R": {}, "T": {}}})",
      camera(rig.m1, rig.d1, to.r1, to.p1), camera(rig.m2, rig.d2, to.r2, to.p2), rows(cv::Mat(rig.r)),
      list(numbers(cv::Mat(rig.t))));
  expect_rectifies(load_calibration(folder.write("c.json", text), of_raw_images()), rig);
}

}  // namespace
}  // namespace flies
