#include "flies/core/plausible.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "flies/io/calibration.hpp"
#include "flies/io/number_table.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/text_file.hpp"

namespace flies::detail {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr StereoCamera kCamera{721.5, 721.5, 609.6, 609.6, 172.9, 0.54, 1242, 375, {}};

StereoCamera with(double StereoCamera::*member, double value) {
  StereoCamera camera = kCamera;
  camera.*member = value;
  return camera;
}

std::string fault_of(const StereoCamera& camera) {
  return error_of([&] { check_plausible(camera, "calib"); });
}

std::string note_of(const StereoCamera& camera) {
  const auto notes = check_plausible(camera, "calib");
  return notes.empty() ? "" : notes.front();
}

TEST(CheckPlausible, SaysNothingOfAGoodCamera) { EXPECT_THAT(check_plausible(kCamera, "calib"), ::testing::IsEmpty()); }

TEST(CheckPlausible, NamesTheLikelyUnitOfTheBaseline) {
  const auto baseline = [](double found) { return with(&StereoCamera::baseline_m, found); };
  EXPECT_THAT(fault_of(baseline(540.0)), HasSubstr("millimetres (0.54 m)"));
  EXPECT_THAT(fault_of(baseline(54.0)), HasSubstr("centimetres (0.54 m)"));
  EXPECT_THAT(fault_of(baseline(21.26)), HasSubstr("inches (0.54 m)"));
  EXPECT_THAT(note_of(baseline(5.4)), HasSubstr("decimetres (0.54 m)"));
  EXPECT_THAT(fault_of(baseline(540.0)), HasSubstr("or focal length times metres (0.748 m)"));
  EXPECT_THAT(fault_of(baseline(0.00012)), HasSubstr("written in metres where the file wants millimetres (0.12 m)"));
  EXPECT_THAT(note_of(baseline(0.0054)), HasSubstr("written in metres where the file wants centimetres (0.54 m)?"));
  EXPECT_THAT(fault_of(baseline(14.8)), HasSubstr("inches (0.376 m)"));
  EXPECT_THAT(note_of(baseline(3.5)), HasSubstr("feet (1.07 m)"));
  EXPECT_THAT(fault_of(baseline(0.54 / 721.5)), HasSubstr("focal length times metres (0.54 m)"));
}

TEST(CheckPlausible, RefusesAFocalLengthInAnotherUnit) {
  StereoCamera camera = kCamera;
  camera.fx_px = camera.fy_px = 4.0;
  EXPECT_THAT(fault_of(camera), HasSubstr("is it in millimetres, or normalised"));
  camera.fx_px = camera.fy_px = 0.58;
  EXPECT_THAT(fault_of(camera), HasSubstr("is it in millimetres, or normalised"));
  camera.width_px = camera.height_px = 0;
  EXPECT_THAT(fault_of(camera), HasSubstr("is it in millimetres, or normalised"));
}

TEST(CheckPlausible, NotesPixelsThatAreNotSquare) {
  EXPECT_THAT(note_of(with(&StereoCamera::fy_px, 360.75)), HasSubstr("2 times the vertical one"));
}

TEST(CheckPlausible, TellsAPrincipalPointFarFromTheMiddle) {
  EXPECT_THAT(note_of(with(&StereoCamera::cy_px, 250.0)), HasSubstr("cropped or resized"));
  StereoCamera swapped = kCamera;
  swapped.cx_px = swapped.cx_right_px = kCamera.cy_px;
  swapped.cy_px = kCamera.cx_px;
  EXPECT_THAT(fault_of(swapped), HasSubstr("cx and cy, or width and height, are swapped"));
}

TEST(CheckPlausible, RefusesAPrincipalPointThatIsNormalisedOrCountedFromTheMiddle) {
  for (const auto& [cx_px, cy_px] : {std::pair{0.0, 0.0}, {0.5, 0.46}, {-0.3, 0.8}})
    for (const int width_px : {0, 1242}) {
      StereoCamera camera = kCamera;
      camera.cx_px = camera.cx_right_px = cx_px;
      camera.cy_px = cy_px;
      camera.width_px = width_px;
      camera.height_px = width_px > 0 ? 375 : 0;
      EXPECT_THAT(fault_of(camera), HasSubstr("normalised")) << cx_px << " " << width_px;
    }
  StereoCamera shifted = kCamera;
  shifted.cx_px = shifted.cx_right_px = -11.4;
  shifted.cy_px = -14.6;
  EXPECT_THAT(note_of(shifted), HasSubstr("counted from the middle of the image?"));
  EXPECT_THAT(error_of([] {
                check_camera_matrix({700, 0, 0.5, 0, 700, 0.5, 0, 0, 1}, "calib", "M1");
              }),
              HasSubstr("M1: found (0.5, 0.5) for cx and cy: are they normalised"));
}

TEST(CheckPlausible, KnowsThePrincipalPointOfKitti360) {
  const StereoCamera whole{552.554261, 552.554261, 682.049453, 682.049453, 238.769549, 0.5942, 1408, 376, {}};
  EXPECT_THAT(check_plausible(whole, "calib"), ::testing::IsEmpty());
  EXPECT_THAT(check_plausible(scaled_camera(whole, {0.5, 0.5}, 704, 188), "calib"), ::testing::IsEmpty());
  StereoCamera other = whole;
  other.fx_px = other.fy_px = 560.0;
  EXPECT_THAT(note_of(other), HasSubstr("far from the middle"));
}

TEST(CheckMount, NamesWhatIsNotAllowed) {
  EXPECT_THAT(error_of([] {
                check_mount({1.65, radians(95.0), 0.0}, "calib");
              }),
              HasSubstr("pitch_deg (camera pitch): found 95, expected -45 to 45 degrees"));
  EXPECT_THAT(error_of([] {
                check_mount({-1.0, 0.0, 0.0}, "calib");
              }),
              HasSubstr("height_m (camera height): found -1"));
  check_mount({1.65, radians(45.0), radians(-45.0)}, "calib");
}

TEST(LoadCalibration, HoldsPrincipalPointsOfRawCamerasAgainstTheSize) {
  const TemporaryFolder folder;
  const auto load = [&](const std::string& centre) {
    const std::string matrix = ": {rows: 3, cols: 3, data: [700, 0, " + centre + ", 0, 0, 1]}\n";
    return load_calibration(
        folder.write("calib.yaml", "image_width: 1242\nimage_height: 375\nM1" + matrix + "M2" + matrix +
                                       "D1: [0, 0, 0, 0, 0]\nD2: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
                                       "T: [-0.5, 0, 0]\n"));
  };
  EXPECT_THAT(texts(load("620, 0, 700, 187").notes), ::testing::Not(::testing::Contains(HasSubstr("principal point"))));
  EXPECT_THAT(texts(load("420, 0, 700, 187").notes),
              ::testing::Contains(HasSubstr("M1: the principal point (420.0, 187.0)")));
  EXPECT_THAT(error_of([&] { load("180, 0, 700, 610"); }),
              ::testing::AllOf(HasSubstr("M1"), HasSubstr("cx and cy, or width and height, are swapped")));
}

TEST(CheckPlausible, BearsWhatRectificationCropsOffFilesThatSayTheirSize) {
  const auto moved = with(&StereoCamera::cx_px, 1242 * 0.42);
  EXPECT_EQ(note_of(moved), "");
  EXPECT_THAT(check_plausible(moved, "calib", false).front(), HasSubstr("cropped or resized"));
}

TEST(SizeOfUnsized, KnowsKittisCamerasAndTheHalfOfOthers) {
  using Size = std::array<int, 2>;
  StereoCamera kitti = with(&StereoCamera::cx_px, 609.5593);
  kitti.fx_px = kitti.fy_px = 721.5377;
  kitti.cy_px = 172.854;
  for (const Size& size : {Size{621, 187}, Size{1024, 320}, Size{640, 192}, Size{1216, 352}})
    EXPECT_EQ(size_of_unsized(kitti, size[0], size[1]), (Size{1242, 375})) << size[0];
  EXPECT_FALSE(size_of_unsized(kitti, 1242, 375));
  StereoCamera other = kCamera;
  other.fx_px = 700.0;
  other.cx_px = 635.0;
  other.cy_px = 370.0;
  EXPECT_EQ(size_of_unsized(other, 640, 360), (Size{1280, 720}));
  EXPECT_EQ(size_of_unsized(other, 320, 180), (Size{1280, 720}));
  EXPECT_FALSE(size_of_unsized(other, 1280, 720));
  EXPECT_FALSE(size_of_unsized(other, 640, 300));
  EXPECT_FALSE(size_of_unsized(other, 960, 540));
}

TEST(LoadCalibration, ScalesAFileWithoutASizeToHalfImagesAndSaysSo) {
  const TemporaryFolder folder;
  const auto file = folder.write("calib.txt",
                                 "P0: 700 0 635 0 0 700 370 0 0 0 1 0\nP1: 700 0 635 -350 0 700 370 0 0 0 1 0\nP2: 700 "
                                 "0 635 0 0 700 370 0 0 0 1 0\n"
                                 "P3: 700 0 635 -350 0 700 370 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n");
  const auto load = [&](int width_px, int height_px) {
    CalibrationRequest request;
    request.width_px = width_px;
    request.height_px = height_px;
    return load_calibration(file, request);
  };
  const auto half = load(640, 360);
  EXPECT_DOUBLE_EQ(half.camera.fx_px, 350.0);
  EXPECT_DOUBLE_EQ(half.camera.cx_px, 317.25);  // pixels are counted at their middles
  EXPECT_EQ(half.camera.width_px, 640);
  EXPECT_THAT(texts(half.notes), ::testing::Contains(HasSubstr("images of 1280 x 720 px")));
  EXPECT_THAT(texts(half.notes), ::testing::Contains(HasSubstr("scaled by 0.5")));
  EXPECT_EQ(load(1280, 720).camera.fx_px, 700.0);
  EXPECT_THAT(error_of([&] { load(900, 500); }), HasSubstr("--calib-size"));
}

constexpr const char* kKittiWithoutSize =
    "P0: 721.5377 0 609.5593 0 0 721.5377 172.854 0 0 0 1 0\n"
    "P1: 721.5377 0 609.5593 -387.5744 0 721.5377 172.854 0 0 0 1 0\n";

TEST(LoadCalibration, RefusesImagesOfAnotherShapeThanKittis) {
  const TemporaryFolder folder;
  const auto file = folder.write("calib.txt", kKittiWithoutSize);
  CalibrationRequest request;
  request.width_px = 1024;
  request.height_px = 320;
  EXPECT_THAT(error_of([&] { load_calibration(file, request); }),
              ::testing::AllOf(HasSubstr("1242 x 375 px, not of 1024 x 320 px"),
                               HasSubstr("0.824 horizontally and 0.853 vertically"), HasSubstr("--calib-size")));
  request.calibrated_width_px = 1024;
  request.calibrated_height_px = 320;
  EXPECT_EQ(load_calibration(file, request).camera.fx_px, 721.5377);
  request = {};
  request.width_px = 640;
  request.height_px = 193;
  EXPECT_NEAR(load_calibration(file, request).camera.fx_px, 721.5377 * 640 / 1242, 1e-6);
}

TEST(LoadCalibration, ScalesAcrossAndDownWhereImagesAreSaidToBeResized) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.width_px = 1024;
  request.height_px = 320;
  request.images_are_resized = true;
  const std::string own = "fx_px: 721.5377\ncx_px: 609.5593\ncy_px: 172.854\nbaseline_m: 0.54\n";
  for (const auto& file : {folder.write("calib.txt", kKittiWithoutSize),
                           folder.write("calib.yaml", own + "width_px: 1242\nheight_px: 375\n")}) {
    const auto resized = load_calibration(file, request);
    EXPECT_NEAR(resized.camera.fx_px, 721.5377 * 1024 / 1242, 1e-6);
    EXPECT_NEAR(resized.camera.fy_px, 721.5377 * 320 / 375, 1e-6);
    EXPECT_NEAR(resized.camera.cy_px, 173.354 * 320 / 375 - 0.5, 1e-6);
    EXPECT_EQ(resized.camera.height_px, 320);
    EXPECT_THAT(texts(resized.notes),
                ::testing::Contains(HasSubstr("scaled by 0.8245 horizontally and 0.8533 vertically")));
  }
  const auto unsized =
      folder.write("own.txt", "P0: 700 0 500 0 0 700 170 0 0 0 1 0\nP1: 700 0 500 -350 0 700 170 0 0 0 1 0\n");
  EXPECT_THAT(error_of([&] { load_calibration(unsized, request); }),
              HasSubstr("the size that the images were resized from"));
  request.calibrated_width_px = 1000;
  request.calibrated_height_px = 340;
  EXPECT_NEAR(load_calibration(unsized, request).camera.fx_px, 700.0 * 1024 / 1000, 1e-6);
}

TEST(LoadCalibration, GoesOnWithImagesWhoseRowsWereCutOffAndSaysSo) {
  const TemporaryFolder folder;
  const std::string kitti =
      "P0: 721.5377 0 609.5593 0 0 721.5377 172.854 0 0 0 1 0\n"
      "P1: 721.5377 0 609.5593 -387.5744 0 721.5377 172.854 0 0 0 1 0\n";
  const std::string own =
      "fx_px: 721.5377\ncx_px: 609.5593\ncy_px: 172.854\nbaseline_m: 0.54\nwidth_px: 1242\nheight_px: 375\n";
  for (const auto& file : {folder.write("calib.txt", kitti), folder.write("calib.yaml", own)}) {
    CalibrationRequest request;
    request.width_px = 1242;
    request.height_px = 320;
    const auto cut = load_calibration(file, request);
    EXPECT_EQ(cut.camera.height_px, 320);
    EXPECT_EQ(cut.camera.cy_px, 172.854);
    EXPECT_THAT(texts(cut.notes),
                ::testing::Contains(::testing::AllOf(HasSubstr("the upper 320 rows"), HasSubstr("4.4 degrees down"))));
    request.height_px = 180;  // less than half: something else
    EXPECT_THAT(error_of([&] {
                  const auto calibration = load_calibration(file, request);
                  check_camera_fits(calibration.camera, 1242, 180, file);
                }),
                HasSubstr("cropped"));
  }
}

TEST(LoadCalibration, AsksWhetherImagesOfAnUnsizedCameraLieOnTheirSide) {
  const TemporaryFolder folder;
  const auto file = folder.write("calib.txt", kKittiWithoutSize);
  CalibrationRequest request;
  request.width_px = 375;
  request.height_px = 1242;
  EXPECT_THAT(error_of([&] { load_calibration(file, request); }), HasSubstr("turned by 90 degrees"));
}

TEST(CheckSizeOfUnsized, RefusesHalfTheSizeAndTakesTheWhole) {
  EXPECT_THAT(error_of([] { check_size_of_unsized(kCamera, 621, 187, "calib"); }), HasSubstr("--calib-size"));
  EXPECT_EQ(error_of([] { check_size_of_unsized(kCamera, 1242, 375, "calib"); }), "no error");
}

TEST(HasExchangedSize, TellsWidthForHeightFromImagesThatLieOnTheirSide) {
  StereoCamera exchanged = kCamera;
  std::swap(exchanged.width_px, exchanged.height_px);
  EXPECT_TRUE(has_exchanged_size(exchanged, 1242, 375));
  EXPECT_FALSE(has_exchanged_size(exchanged, 375, 1242));
  EXPECT_FALSE(has_exchanged_size(exchanged, 621, 187));
  EXPECT_FALSE(has_exchanged_size(kCamera, 375, 1242)) << "the images are turned, not the size";
  StereoCamera upright = kCamera;
  upright.width_px = 2048;
  upright.height_px = 2448;
  upright.cx_px = 1024;
  upright.cy_px = 1224;
  EXPECT_FALSE(has_exchanged_size(upright, 2448, 2048)) << "the camera stands on its side";
}

TEST(CheckFocalLength, LetsFisheyesBeShort) {
  StereoCamera camera = kCamera;
  camera.fx_px = camera.fy_px = 100.0;
  EXPECT_THAT(error_of([&] { check_focal_length(camera, "calib", "M1"); }), HasSubstr("M1: found 100 px"));
  EXPECT_THAT(check_focal_length(camera, "calib", "M1", true), ::testing::IsEmpty());
}

TEST(OneScale, FitsHalfTheSizeAndNotAStretchedOne) {
  EXPECT_NEAR(one_scale(1242, 375, 621, 187).value_or(0.0), 0.5, 1e-9);
  EXPECT_TRUE(one_scale(1242, 375, 1024, 309));
  EXPECT_FALSE(one_scale(1242, 375, 1024, 320));
  EXPECT_FALSE(one_scale(1242, 375, 1216, 368));  // cropped to multiples of 16
  EXPECT_FALSE(one_scale(1242, 375, 1246, 375));  // half of a file with a gap between the images
  EXPECT_FALSE(one_scale(1242, 375, 1242, 300));
}

TEST(OneScale, FitsHalvesOfOddSizesBothWays) {
  for (const int half_height_px : {187, 188}) {
    EXPECT_NEAR(one_scale(1242, 375, 621, half_height_px).value_or(0.0), 0.5, 1e-9) << half_height_px;
    EXPECT_NEAR(one_scale(621, half_height_px, 1242, 375).value_or(0.0), 2.0, 1e-9) << half_height_px;
  }
  EXPECT_TRUE(one_scale(310, 93, 1242, 375));
  EXPECT_TRUE(one_scale(311, 94, 1242, 375));
  EXPECT_FALSE(one_scale(621, 186, 1242, 375));
  EXPECT_FALSE(one_scale(621, 187, 1242, 376));  // exactly 188
  EXPECT_FALSE(one_scale(1248, 384, 1242, 375));
}

TEST(ScaledCamera, KeepsThePixelsUnderTheirRays) {
  const auto half = scaled_camera(kCamera, {0.5, 0.5}, 621, 187);
  EXPECT_DOUBLE_EQ(half.fx_px, 360.75);
  // The first pixel of the half picture covers columns 0 and 1 of the whole one, whose middle is 0.5.
  EXPECT_DOUBLE_EQ((0.0 - half.cx_px) / half.fx_px, (0.5 - kCamera.cx_px) / kCamera.fx_px);
}

TEST(CheckCameraMatrix, NamesTheTransposedOne) {
  EXPECT_THAT(error_of([] {
                check_camera_matrix({700, 0, 0, 0, 702, 0, 600, 180, 1}, "calib", "M1");
              }),
              HasSubstr("transposed"));
  EXPECT_EQ(error_of([] { check_camera_matrix({700, 0, 600, 0, 702, 180, 0, 0, 1}, "calib", "M1"); }), "no error");
}

TEST(CheckRotation, RefusesWhatIsNone) {
  EXPECT_THAT(error_of([] {
                check_rotation({1, 1, 1, 1, 1, 1, 1, 1, 1}, "calib", "R");
              }),
              HasSubstr("not a rotation matrix"));
  EXPECT_THAT(error_of([] {
                check_rotation({1, 0, 0, 0, 1, 0, 0, 0, -1}, "calib", "R");
              }),
              HasSubstr("not a rotation matrix"));
  EXPECT_EQ(error_of([] { check_rotation({1, 0, 0, 0, 1, 0, 0, 0, 1}, "calib", "R"); }), "no error");
}

TEST(PlainText, DropsMarksAndReadsUtf16AndUtf32) {
  using namespace std::string_literals;
  EXPECT_EQ(plain_text("\xEF\xBB\xBF"s + "a\r\nb"), "a\nb");
  EXPECT_EQ(plain_text("\xFF\xFE"s + "a\0\n\0"s), "a\n");
  EXPECT_EQ(plain_text("\xFE\xFF"s + "\0a"s), "a");
  EXPECT_EQ(plain_text("a\0b\0"s), "ab");
  EXPECT_EQ(plain_text("\xFF\xFE\0\0"s + "a\0\0\0\xB5\0\0\0"s), "a\xC2\xB5");
  EXPECT_EQ(plain_text("\0\0\xFE\xFF"s + "\0\0\0a"s), "a");
}

TEST(ParseNumberTable, TakesRowsThatGoOnBelowTheirKey) {
  const auto table = parse_number_table("P0: \n1 2 3\n-4 5 6\nP1:\n7 8\n", "calib");
  EXPECT_THAT(table.require("P0"), ::testing::ElementsAre(1, 2, 3, -4, 5, 6));
  EXPECT_THAT(table.require("P1"), ::testing::ElementsAre(7, 8));
}

TEST(LoadCalibration, ScalesToImagesOfOneScale) {
  const TemporaryFolder folder;
  const auto path = folder.write("camera.yaml", calibration_yaml(kCamera));
  CalibrationRequest request;
  request.width_px = 621;
  request.height_px = 187;
  const auto calibration = load_calibration(path, request);
  EXPECT_DOUBLE_EQ(calibration.camera.fx_px, 360.75);
  EXPECT_EQ(calibration.camera.width_px, 621);
  EXPECT_THAT(texts(calibration.notes), ::testing::Contains(HasSubstr("scaled by 0.5")));
}

}  // namespace
}  // namespace flies::detail
