// Calibrations with the mistakes that people make: another unit, another size, width for height, a baseline left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "flies/io/calibration.hpp"
#include "flies/io/for_images.hpp"
#include "flies/io/formats/rig_texts.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::expect_rectifies;
using flies::testing::for_images;
using flies::testing::list;
using flies::testing::numbers;
using flies::testing::rows;
using flies::testing::TemporaryFolder;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

CalibrationRequest with_baseline(double baseline_m) {
  CalibrationRequest request = for_images(640, 480);
  request.baseline_m = baseline_m;
  return request;
}

CalibrationRequest shifted(double shift_px) {
  CalibrationRequest request;
  request.disparity_shift_px = shift_px;
  return request;
}

/// @param more the size of the images, or another key
std::string raw(const ToyRig& rig, const std::string& more) {
  return "M1: " + rows(cv::Mat(rig.m1)) + "\nM2: " + rows(cv::Mat(rig.m2)) + "\nD1: " + list(rig.d1) +
         "\nD2: " + list(rig.d2) + "\nR: " + rows(cv::Mat(rig.r)) + "\nT: " + list(numbers(cv::Mat(rig.t))) + "\n" +
         more;
}

const std::string kSize = "image_width: 640\nimage_height: 480\n";

Calibration load(const std::string& text, const CalibrationRequest& request = {}) {
  const TemporaryFolder folder;
  return load_calibration(folder.write("c", text), request);
}

std::string fault_of(const std::string& text, const CalibrationRequest& request = {}) {
  return error_of([&] { load(text, request); });
}

TEST(Mistakes, FocalLengthsOfRawCamerasInAnotherUnitAreRefused) {
  ToyRig rig;
  for (const double focal : {4.0, 0.61}) {
    rig.m2(0, 0) = rig.m2(1, 1) = focal;
    EXPECT_THAT(fault_of(raw(rig, kSize)), AllOf(HasSubstr("M2: found"), HasSubstr("millimetres, or normalised")));
  }
  rig = ToyRig();
  rig.m1(0, 0) *= 2.0;
  EXPECT_THAT(texts(load(raw(rig, kSize)).notes),
              Contains(HasSubstr("M1: the horizontal focal length is 2 times the vertical one")));
  EXPECT_THAT(texts(load(raw(ToyRig(), kSize)).notes), Not(Contains(HasSubstr("focal length"))));
}

TEST(Mistakes, RawCamerasOfMorePixelsThanMemoryHoldsAreRefused) {
  ToyRig rig;
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) {
    (*m)(0, 0) = (*m)(1, 1) = 12600.0;
    (*m)(0, 2) = (*m)(1, 2) = 10000.0;
  }
  EXPECT_THAT(fault_of(raw(rig, "image_width: 20000\nimage_height: 20000\n")),
              HasSubstr("image size: found 20000 x 20000 px, expected at most 67 million pixels"));
}

TEST(Mistakes, FisheyesMayHaveShortFocalLengthsAndNotAnyone) {
  ToyRig rig = ToyRig::fisheye();
  const std::string model = "distortion_model: equidistant\n";
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) (*m)(0, 0) = (*m)(1, 1) = 130.0;
  EXPECT_THAT(texts(load(raw(rig, kSize + model)).notes), Not(Contains(HasSubstr("M1: the focal length"))));
  rig.m1(0, 0) = rig.m1(1, 1) = 4.0;
  EXPECT_THAT(fault_of(raw(rig, kSize + model)), HasSubstr("M1: found 4 px"));
}

TEST(Mistakes, RawCamerasWithoutASizeAreScaledToHalfImagesOrAskForIt) {
  const std::string text = raw(ToyRig(), "");
  const auto half = load(text, for_images(320, 240));
  EXPECT_DOUBLE_EQ(half.rectifier->raw().left.matrix[0], 210.0);
  EXPECT_EQ(half.camera.width_px, 320);
  EXPECT_THAT(texts(half.notes),
              Contains(HasSubstr("images of 640 x 480 px, which is assumed (--calib-size gives another)")));
  expect_rectifies(load(text, for_images(640, 480)), ToyRig());
  EXPECT_THAT(fault_of(text, for_images(480, 360)), HasSubstr("--calib-size"));
  auto said = for_images(480, 360);
  said.calibrated_width_px = 640;
  said.calibrated_height_px = 480;
  EXPECT_DOUBLE_EQ(load(text, said).rectifier->raw().left.matrix[0], 315.0);
}

TEST(Mistakes, WidthForHeightIsExchangedWhereTheImagesSaySo) {
  ToyRig rig;
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) (*m)(1, 2) -= 120.0;
  for (const char* size : {"image_size: [240, 640]\n", "image_width: 240\nimage_height: 640\n"}) {
    const auto calibration = load(raw(rig, size), for_images(640, 240));
    EXPECT_EQ(calibration.camera.width_px, 640) << size;
    EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("width and height are exchanged")));
    expect_rectifies(calibration, rig);
    EXPECT_THAT(fault_of(raw(rig, size)), HasSubstr("cx and cy, or width and height, are swapped"));
  }
  for (const char* size : {"image_size: [240, 640, 3]\n", "image_shape: [240, 640]\n"})
    EXPECT_EQ(load(raw(rig, size)).camera.width_px, 640) << size;
  const std::string own = "fx_px: 400\ncx_px: 320\ncy_px: 120\nbaseline_m: 0.12\nwidth_px: 240\nheight_px: 640\n";
  EXPECT_EQ(load(own, for_images(640, 240)).camera.height_px, 240);
}

TEST(Mistakes, NoRectificationIsToldWithWhatWasNoted) {
  const ToyRig rig;
  EXPECT_THAT(fault_of(raw(rig, "image_width: 320\nimage_height: 240\n")),
              AllOf(HasSubstr("no rectification exists"), HasSubstr("M1: the principal point (318.0, 243.0)")));
  const auto turned = fault_of("M1: " + rows(cv::Mat(rig.m1)) + "\nM2: " + rows(cv::Mat(rig.m2)) +
                               "\nR: [0.687, -1.203, 0.458]\nT: [-0.12, 0, 0]\n" + kSize);
  EXPECT_THAT(turned, AllOf(HasSubstr("no rectification exists"), HasSubstr("degrees where radians are expected")));
}

TEST(Mistakes, ABaselineThatTheFileLeavesOutIsSaid) {
  const std::string projections =
      kSize + "P1: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\nP2: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n";
  for (const std::string& text :
       {projections, std::string("400 0 320 0 400 240 0 0 1\n"),
        std::string("Camera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\n"),
        std::string("cam0=[400 0 320; 0 400 240; 0 0 1]\ncam1=[400 0 320; 0 400 240; 0 0 1]\n"),
        "fx_px: 400\ncx_px: 320\ncy_px: 240\nwidth_px: 640\nheight_px: 480\n" + std::string()}) {
    const auto calibration = load(text, with_baseline(0.12));
    EXPECT_EQ(calibration.camera.baseline_m, 0.12) << text;
    EXPECT_EQ(calibration.camera.width_px, 640) << text;
    EXPECT_THAT(texts(calibration.notes), Contains(HasSubstr("0.12 m as given, not in the file")));
    EXPECT_THAT(fault_of(text), HasSubstr("--baseline M")) << text;
  }
}

TEST(Mistakes, SizesThatFormatsMayLeaveOutAreThoseOfTheImages) {
  for (const char* text : {"cam0=[400 0 320; 0 400 240; 0 0 1]\ncam1=[400 0 320; 0 400 240; 0 0 1]\nbaseline=120\n",
                           R"({"fx": 400, "fy": 400, "cx0": 320, "cx1": 320, "cy": 240, "baseline_meters": 0.12})"})
    EXPECT_EQ(load(text, for_images(640, 480)).camera.height_px, 480) << text;
}

TEST(Mistakes, NormalisedCamerasAreToldFromSmallOnes) {
  EXPECT_THAT(fault_of("0.58 0 0.49 0 0.58 0.14 0 0 1\n0.54\n", for_images(640, 480)), HasSubstr("normalised"));
  EXPECT_THAT(fault_of("0.58 0 0.49 0 1.9 0.46 0 0 1\n0.54\n"), HasSubstr("normalised"));
}

TEST(Mistakes, AWindowOfTheSameShapeIsToldBesideTheScale) {
  const std::string own = "fx_px: 400\ncx_px: 320\ncy_px: 240\nbaseline_m: 0.12\nwidth_px: 640\nheight_px: 480\n";
  const auto cut_out = HasSubstr("cropped from larger images instead, ranges are 2 times those printed");
  EXPECT_THAT(texts(load(own, for_images(320, 240)).notes), Contains(cut_out));
  EXPECT_THAT(texts(load(raw(ToyRig(), kSize), for_images(320, 240)).notes), Contains(cut_out));
  EXPECT_THAT(texts(load(own, for_images(1280, 960)).notes), Not(Contains(HasSubstr("cut out"))));
  auto resized = for_images(320, 240);
  resized.images_are_resized = true;
  EXPECT_THAT(texts(load(own, resized).notes), Not(Contains(HasSubstr("cut out"))));
}

TEST(Mistakes, HeightsInAnotherUnitAreTold) {
  const std::string own = "fx_px: 400\ncx_px: 320\ncy_px: 240\nbaseline_m: 0.12\nwidth_px: 640\nheight_px: 480\n";
  EXPECT_THAT(texts(load(own + "height_m: 165\n").notes), Contains(HasSubstr("is it in centimetres (1.65 m)?")));
  EXPECT_THAT(texts(load(own + "height_m: 1650\n").notes), Contains(HasSubstr("is it in millimetres (1.65 m)?")));
  EXPECT_THAT(texts(load(own + "height_m: 12\n").notes), Not(Contains(HasSubstr("improbable"))));
}

TEST(Mistakes, SkewIsToldAndLeftOut) {
  ToyRig rig;
  rig.m1(0, 1) = 25.0;
  EXPECT_THAT(texts(load(raw(rig, kSize)).notes), Contains(HasSubstr("M1: its skew of 25 px is ignored")));
}

TEST(Mistakes, AShiftOfDisparitiesIsInPixelsOfTheImagesAndAfterAllThatJudgesTheFile) {
  const std::string own =
      "fx_px: 400\ncx_px: 320\ncx_right_px: 325\ncy_px: 240\nbaseline_m: 0.12\nwidth_px: 640\nheight_px: 480\n";
  CalibrationRequest request = shifted(-2.5);
  EXPECT_EQ(load(own, request).camera.cx_right_px, 322.5);
  EXPECT_THAT(texts(load(own, request).notes, {CalibrationNoteKind::told}),
              Contains(HasSubstr("2.5 px smaller than the images show")));
  request.width_px = 320;
  request.height_px = 240;
  const auto halved = load(own, request), as_it_is = load(own, for_images(320, 240));
  EXPECT_EQ(halved.camera.cx_right_px, as_it_is.camera.cx_right_px - 2.5);
  ToyRig rig;
  const auto raw_as_it_is = load(raw(rig, kSize), {});
  EXPECT_EQ(load(raw(rig, kSize), shifted(3.0)).camera.cx_right_px, raw_as_it_is.camera.cx_right_px + 3.0);
  for (const double absurd_px : {640.0, -640.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(fault_of(own, shifted(absurd_px)), AllOf(HasSubstr("disparity shift"), HasSubstr("640 px")))
        << absurd_px;
}

TEST(Mistakes, NegativeBaselinesNameTheirCauses) {
  ToyRig rig;
  rig.t = -rig.t;
  EXPECT_THAT(fault_of(raw(rig, kSize)),
              AllOf(HasSubstr("left and right are swapped"), HasSubstr("the pose of the right camera instead")));
  const std::string camera = "  camera_model: pinhole\n  intrinsics: [400, 400, 320, 240]\n  resolution: [640, 480]\n";
  EXPECT_THAT(fault_of("cam0:\n" + camera + "cam1:\n" + camera +
                       "  T_cn_cnm1: [[1, 0, 0, 0.12], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"),
              HasSubstr("--cameras 1,0"));
  EXPECT_THAT(fault_of("fx: 400\nfy: 400\ncx: 320\ncy: 240\nbaseline: -0.12\nwidth: 640\nheight: 480\n"),
              AllOf(HasSubstr("found -0.12 m: expected a distance"), Not(HasSubstr("fx and fx"))));
}

TEST(Mistakes, MetresForTheFocalLengthTimesMetresAreTheCauseThatIsNamed) {
  const std::string camera = "Camera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\nCamera.bf: ";
  EXPECT_THAT(fault_of(camera + "0.12\n"),
              AllOf(HasSubstr("were metres written (0.12 m) where the format has the focal length times metres (48)"),
                    Not(HasSubstr("centimetres"))));
  EXPECT_EQ(load(camera + "0.12\n", with_baseline(0.12)).camera.baseline_m, 0.12);
  EXPECT_NEAR(load(camera + "48\n").camera.baseline_m, 0.12, 1e-12);
}

TEST(Mistakes, TheTwoBaselinesOfOrbSlamAreHeldAgainstEachOther) {
  const std::string camera = "Camera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\nStereo.b: ";
  const auto both = load(camera + "0.12\nCamera.bf: 24\n");
  EXPECT_EQ(both.camera.baseline_m, 0.12);
  EXPECT_THAT(texts(both.notes),
              Contains(HasSubstr("Camera.bf gives a baseline of 0.06 m, Stereo.b one of 0.12 m, which is used")));
  EXPECT_THAT(texts(load(camera + "0.12\nCamera.bf: 48\n").notes), Not(Contains(HasSubstr("Stereo.b"))));
  EXPECT_THAT(fault_of(camera + "48\n"), HasSubstr("or focal length times metres (0.12 m)"));
}

TEST(Mistakes, AMountThatIsSaidIsNotTheFilesFault) {
  CalibrationRequest request;
  request.camera_pitch_rad = radians(95.0);
  EXPECT_THAT(fault_of("Camera.fx: 400\nCamera.fy: 400\nCamera.cx: 320\nCamera.cy: 240\nStereo.b: 0.1\n", request),
              AllOf(StartsWith("given mount"), HasSubstr("found 95")));
}

TEST(Mistakes, AnotherSizeThanTheFilesIsRefused) {
  CalibrationRequest request;
  request.calibrated_width_px = 1280;
  request.calibrated_height_px = 960;
  const std::string own = "fx_px: 400\ncx_px: 320\ncy_px: 240\nbaseline_m: 0.12\nwidth_px: 640\nheight_px: 480\n";
  for (const auto& text : {own, raw(ToyRig(), kSize)})
    EXPECT_THAT(fault_of(text, request), HasSubstr("found 640 x 480 px in the file, but 1280 x 960 px in --calib-size"))
        << text;
  request.calibrated_width_px = 640;
  request.calibrated_height_px = 480;
  EXPECT_EQ(load(own, request).camera.width_px, 640);
  EXPECT_EQ(load(raw(ToyRig(), kSize), request).camera.width_px, 640);
}

TEST(Mistakes, CoefficientsAreNamedAndTwoAreRadial) {
  ToyRig rig;
  rig.d2 = {-0.2, 0.05, 0.01};
  EXPECT_THAT(fault_of(raw(rig, kSize)), HasSubstr("D2: found 3 coefficients"));
  rig.d1 = rig.d2 = {-0.28, 0.07};
  const auto radial = load(raw(rig, kSize));
  EXPECT_THAT(texts(radial.notes), Contains(HasSubstr("D1 is read as a pair of radial coefficients")));
  rig.d1 = rig.d2 = {-0.28, 0.07, 0.0, 0.0};
  expect_rectifies(radial, rig);
}

TEST(LoadCalibration, TakesImagesOfHalfTheHeightAsSqueezed) {
  const TemporaryFolder folder;
  const auto own = [&](int height_px) {
    return folder.write("c", "fx_px: 721.5\ncx_px: 609.5\ncy_px: 172.5\nbaseline_m: 0.54\nwidth_px: 1242\nheight_px: " +
                                 std::to_string(height_px) + "\n");
  };
  CalibrationRequest request;
  request.width_px = 1242;
  for (const auto& [whole_px, half_px] : {std::pair{375, 188}, std::pair{375, 187}, std::pair{376, 188}}) {
    request.height_px = half_px;
    const auto calibration = load_calibration(own(whole_px), request);
    EXPECT_EQ(calibration.camera.fx_px, 721.5);
    EXPECT_NEAR(calibration.camera.fy_px, 0.5 * 721.5, 1.0);
    EXPECT_EQ(calibration.camera.height_px, half_px);
    EXPECT_THAT(texts(calibration.notes), Contains(AllOf(HasSubstr("taken as squeezed"),
                                                         HasSubstr("if rows were cut off instead, the road seems"))));
    EXPECT_THAT(texts(calibration.notes), Not(Contains(HasSubstr("stretched"))));
  }
  request.height_px = 250;
  EXPECT_THAT(
      texts(load_calibration(own(375), request).notes),
      Contains(AllOf(HasSubstr("the upper 250 rows"), HasSubstr("if the images were squeezed, give --resized"))));
}

TEST(LoadCalibration, DoesNotAskWhetherImagesWereStretchedThatWereSaidToBeResized) {
  const TemporaryFolder folder;
  const auto notes = [&](double fy_px) {
    CalibrationRequest request = for_images(1242, 188);
    request.images_are_resized = true;
    const auto text = fmt::format(
        "fx_px: 721.5\nfy_px: {}\ncx_px: 609.5\ncy_px: 172.5\nbaseline_m: 0.54\nwidth_px: 1242\nheight_px: 375\n",
        fy_px);
    return texts(load_calibration(folder.write("c", text), request).notes);
  };
  EXPECT_THAT(notes(721.5), Not(Contains(HasSubstr("stretched"))));
  EXPECT_THAT(notes(600.0), Contains(HasSubstr("stretched"))) << "the calibration itself is odd";
}

TEST(Mistakes, ASizeThatIsNotThatOfTheNumbersIsReplacedByThatOfTheImages) {
  const std::string numbers = "fx: 721.5\ncx: 609.6\ncy: 172.9\nbaseline: 0.54\n";
  for (const char* size : {"width: 621\nheight: 188\n", "width: 2484\nheight: 750\n"}) {
    const auto calibration = load(numbers + size, for_images(1242, 375));
    EXPECT_EQ(calibration.camera.fx_px, 721.5);
    EXPECT_EQ(calibration.camera.width_px, 1242);
    EXPECT_THAT(texts(calibration.notes, {CalibrationNoteKind::doubt}),
                Contains(HasSubstr("its numbers are taken as those of the images, and not scaled")));
  }
  const auto scaled = load(numbers + "width: 1242\nheight: 375\n", for_images(621, 188));
  EXPECT_NEAR(scaled.camera.fx_px, 360.75, 1e-9);
  const std::string half = "image_width: 320\nimage_height: 240\n";
  const auto of_raw = load(raw(ToyRig(), half), for_images(640, 480));
  EXPECT_EQ(of_raw.rectifier->raw().left.matrix[0], 420.0);
  EXPECT_THAT(texts(of_raw.notes), Contains(HasSubstr("and not scaled")));
}

TEST(Mistakes, ExchangedPrincipalPointsAreNamedWithoutASizeToo) {
  EXPECT_THAT(fault_of("fx: 721.5\ncx: 172.9\ncy: 609.6\nbaseline: 0.54\n", for_images(1242, 375)),
              HasSubstr("principal point: found (172.9, 609.6) px for images of 1242 x 375 px: cx and cy are swapped"));
  ToyRig rig;
  rig.m2(0, 2) = 120.0;
  rig.m2(1, 2) = 500.0;
  for (cv::Matx33d* m : {&rig.m1, &rig.m2}) (*m)(0, 0) = (*m)(1, 1) = 700.0;
  rig.m1(0, 2) = 500.0;
  rig.m1(1, 2) = 120.0;
  EXPECT_THAT(fault_of(raw(rig, ""), for_images(1000, 240)), HasSubstr("M2: found (120.0, 500.0) px"));
}

TEST(Mistakes, TwoSizesBesideOpenCvsNamesAreRefusedUnlessOneIsSaid) {
  const std::string two = kSize + "imageWidth: 1280\nimageHeight: 960\n";
  EXPECT_THAT(fault_of(raw(ToyRig(), two)), HasSubstr("--calib-size W,H says it"));
  CalibrationRequest said;
  said.calibrated_width_px = 640;
  said.calibrated_height_px = 480;
  expect_rectifies(load(raw(ToyRig(), two), said), ToyRig());
  expect_rectifies(load(raw(ToyRig(), kSize + "imageSize: [640, 480]\nboard_size: [9, 6]\nsize: [9, 6]\n")), ToyRig());
}

}  // namespace
}  // namespace flies
