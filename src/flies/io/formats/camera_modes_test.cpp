// Which numbers of a file that has some for several sizes of images are taken.
#include "flies/io/formats/camera_modes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/for_images.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies::detail {
namespace {

using flies::testing::error_of;
using flies::testing::for_images;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// HD sees more to the side than the others, which are cut out of the sensor.
const std::vector<CameraMode> kModes = {{1280, 720, 670.0}, {1920, 1080, 1370.0}, {2208, 1242, 1370.0}};

CalibrationRequest for_calibration(CalibrationRequest request, int width_px, int height_px) {
  request.calibrated_width_px = width_px;
  request.calibrated_height_px = height_px;
  return request;
}

std::size_t chosen(const CalibrationRequest& request) { return choose_mode(kModes, request, "calib").index; }

TEST(ChooseMode, TakesThatOfTheImagesOrElseTheOneTheyAreAWholeFractionOf) {
  EXPECT_EQ(chosen(for_images(2208, 1242)), 2U);
  EXPECT_EQ(chosen(for_images(960, 540)), 1U);
  EXPECT_EQ(chosen(for_images(1104, 621)), 2U);
  EXPECT_EQ(chosen(for_images(640, 360)), 0U) << "a half before a third";
  EXPECT_EQ(chosen(for_images(800, 450)), 0U) << "the first where none is a whole fraction";
  EXPECT_EQ(chosen({}), 0U);
}

TEST(ChooseMode, TakesTheOneThatIsSaid) {
  EXPECT_EQ(chosen(for_calibration(for_images(960, 540), 2208, 1242)), 2U);
  EXPECT_EQ(chosen(for_calibration(for_images(1280, 720), 1920, 1080)), 1U) << "whatever size the images have";
  EXPECT_EQ(chosen(for_calibration({}, 1920, 1080)), 1U);
  EXPECT_THAT(error_of([] { chosen(for_calibration(for_images(960, 540), 1000, 500)); }),
              HasSubstr("found 1000 x 500 px in --calib-size, which is none of the modes of this file: 1280 x 720, "
                        "1920 x 1080, 2208 x 1242"));
}

TEST(ChooseMode, NamesTheOthersWhereRangesWouldDiffer) {
  const auto notes = texts(choose_mode(kModes, for_images(960, 540), "calib").notes);
  // 670 / 1280 over 1370 / 1920, and 1370 / 2208 over it
  EXPECT_THAT(notes, Contains(AllOf(HasSubstr("from the mode of 1920 x 1080 px"),
                                    HasSubstr("from 1280 x 720 or 2208 x 1242 instead"),
                                    HasSubstr("0.734 or 0.87 times"), HasSubstr("--calib-size"))));
  EXPECT_THAT(choose_mode(kModes, for_calibration(for_images(960, 540), 1920, 1080), "calib").notes, IsEmpty());
  EXPECT_THAT(choose_mode(kModes, for_images(1280, 720), "calib").notes, IsEmpty());
  EXPECT_THAT(choose_mode({{1280, 720, 640.0}, {640, 360, 320.2}}, for_images(320, 180), "calib").notes, IsEmpty())
      << "of one view";
}

TEST(ChooseMode, OfASavedZedFileIsTheOneThatIsSaid) {
  const TemporaryFolder folder;
  std::string text;
  for (const char* side : {"LEFT", "RIGHT"})
    text += fmt::format(
        "[{0}_CAM_HD]\nfx=670\nfy=670\ncx=640\ncy=360\nk1=0\nk2=0\n[{0}_CAM_FHD]\nfx=1370\nfy=1370\ncx=960\ncy=540\n"
        "k1=0\nk2=0\n",
        side);
  text += "[STEREO]\nBaseline=120\nCV_HD=0\nRX_HD=0\nRZ_HD=0\nCV_FHD=0\nRX_FHD=0\nRZ_FHD=0\n";
  const auto path = folder.write("SN1.conf", text);
  EXPECT_NEAR(load_calibration(path, for_images(960, 540)).camera.fx_px, 685.0, 1e-6);
  const auto said = load_calibration(path, for_calibration(for_images(960, 540), 1280, 720));
  EXPECT_NEAR(said.camera.fx_px, 502.5, 1e-6);
}

}  // namespace
}  // namespace flies::detail
