#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "flies/io/calibration.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::nested_aliases;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct BadCalibration {
  const char* name;
  std::string content;
  std::string complaint;  ///< must be part of the message, besides the file name
};

void PrintTo(const BadCalibration& bad, std::ostream* out) { *out << bad.name; }

class BadCalibrations : public ::testing::TestWithParam<BadCalibration> {};

TEST_P(BadCalibrations, NameFileAndFault) {
  const TemporaryFolder folder;
  const auto path = folder.write("the_calib", GetParam().content);
  EXPECT_THAT(error_of([&] { load_calibration(path); }),
              AllOf(HasSubstr("the_calib"), HasSubstr(GetParam().complaint), Not(HasSubstr("\n"))));
}

const std::string kP2 = "P2: 700 0 600 0 0 700 170 0 0 0 1 0\n";
const std::string kP3 = "P3: 700 0 600 -280 0 700 170 0 0 0 1 0\n";
const std::string kRect = "R0_rect: 1 0 0 0 1 0 0 0 1\n";
const std::string kOwn = "fx_px: 700\ncx_px: 600\ncy_px: 170\nbaseline_m: 0.5\nwidth_px: 1242\nheight_px: 375\n";
const std::string kCam0 = "cam0=[700 0 600; 0 700 170; 0 0 1]\n";
const std::string kCam1 = "cam1=[700 0 600; 0 700 170; 0 0 1]\n";
const std::string kOpenCvP1 = "%YAML:1.0\n---\nP1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n";
const std::string kRaw =
    "image_width: 640\nimage_height: 480\nM1: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n"
    "M2: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\nD1: [0, 0, 0, 0, 0]\nD2: [0, 0, 0, 0, 0]\n"
    "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadCalibrations,
    ::testing::Values(
        BadCalibration{"Empty", "", "is empty"},
        BadCalibration{"Prose", "It was a dark and stormy night.\n", "not recognised"},
        BadCalibration{"Binary",
                       std::string("\x7f"
                                   "ELF\2\1\1\0",
                                   8),
                       "not recognised"},
        BadCalibration{"Picture", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16), "is a picture"},
        BadCalibration{"Compressed", "\x1F\x8B\x08 and more", "is gzip-compressed: unpack it"},
        BadCalibration{"IndentedWithTabs", "camera:\n  fx_px: 700\n\tcx_px: 600\n",
                       "line 3: malformed YAML: is indented"},
        BadCalibration{"MalformedYaml", "fx_px: [1, 2\ncx_px: }", "malformed YAML"},
        BadCalibration{"MalformedXml", "<?xml version=\"1.0\"?>\n<opencv_storage>\n<P1><rows>", "malformed OpenCV XML"},
        BadCalibration{"KittiTruncatedMatrix", kP2 + kRect + "P3: 700 0 600 -280 0 700",
                       "P3: found 6 numbers, expected 12"},
        BadCalibration{"KittiMissingMatrix", kP2 + kRect, "P3: is missing"},
        BadCalibration{"KittiWord", kP2 + kRect + "P3: 700 0 six 0 0 700 170 0 0 0 1 0\n", "P3: found 'six'"},
        BadCalibration{"KittiTwice", kP2 + kP2 + kP3 + kRect, "P2: stands in the file twice"},
        BadCalibration{"KittiNan", "P2: nan 0 600 0 0 700 170 0 0 0 1 0\n" + kP3 + kRect, "P2: found nan"},
        BadCalibration{"KittiInfinite", "P2: 700 0 inf 0 0 700 170 0 0 0 1 0\n" + kP3 + kRect, "P2: found inf"},
        BadCalibration{"KittiZeroFocal", "P2: 0 0 600 0 0 0 170 0 0 0 1 0\n" + kP3 + kRect, "focal length of 0"},
        BadCalibration{"KittiSwapped",
                       kRect + "P2: 700 0 600 0 0 700 170 0 0 0 1 0\nP3: 700 0 600 280 0 700 170 0 0 0 1 0\n",
                       "left and right are swapped"},
        BadCalibration{"KittiSameCamera", kRect + kP2 + "P3: 700 0 600 0 0 700 170 0 0 0 1 0\n", "found 0 m"},
        BadCalibration{"KittiUnequalFocal", kRect + kP2 + "P3: 800 0 600 -280 0 800 170 0 0 0 1 0\n",
                       "expected the same in both"},
        BadCalibration{"KittiUnequalRow", kRect + kP2 + "P3: 700 0 600 -280 0 700 180 0 0 0 1 0\n",
                       "expected the same row"},
        BadCalibration{"KittiNotRectified", kRect + kP2 + "P3: 700 9 600 -280 0 700 170 0 0 0 1 0\n",
                       "expected a rectified camera"},
        BadCalibration{"MiddleburyNoBaseline", kCam0 + kCam1 + "width=1242\nheight=375\n", "baseline: is missing"},
        BadCalibration{"MiddleburyTruncated", kCam0 + "cam1=[700 0 600; 0 700",
                       "cam1: found no ']' at the end of its list"},
        BadCalibration{"MiddleburyFraction", kCam0 + kCam1 + "baseline=100\nwidth=12.5\nheight=375\n",
                       "width: found 12.5"},
        BadCalibration{"OwnMissingKey", "fx_px: 700\ncx_px: 600\n", "cy_px: is missing"},
        BadCalibration{"OwnUnknownKey", kOwn + "hight_m: 1.2\n", "did you mean 'height_m'"},
        BadCalibration{"OwnNan", "fx_px: .nan\n" + kOwn.substr(11), "fx_px: found nan"},
        BadCalibration{"OwnNegativeFocal", "fx_px: -700\n" + kOwn.substr(11), "fx_px (focal length): found -700"},
        BadCalibration{"OwnNegativeHeight", kOwn + "height_m: -1\n", "camera height"},
        BadCalibration{"OwnSteepPitch", kOwn + "pitch_deg: 80\n", "camera pitch"},
        BadCalibration{"OwnList", kOwn + "height_m: [1, 2]\n", "height_m: found 2 numbers, expected 1"},
        BadCalibration{"OwnTwice", kOwn + "cx_px: 3\n", "cx_px: stands in the file twice"},
        BadCalibration{"OpenCvTruncatedData", kOpenCvP1 + "   data: [ 500., 0., 320. ]\nP2: [1, 2]\n",
                       "P1: found 3 numbers, expected 12"},
        BadCalibration{"OpenCvNoSecond", kOpenCvP1 + "   data: [ 500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0 ]\n",
                       "P2: is missing"},
        BadCalibration{"RawNoTranslation", kRaw, "T: is missing"},
        BadCalibration{"RawSwapped", kRaw + "T: [0.3, 0, 0]\n", "left and right are swapped"},
        BadCalibration{"RawMillimetres", kRaw + "T: [-300, 0, 0]\n", "millimetres"},
        BadCalibration{"RawAbove", kRaw + "T: [0, -0.3, 0]\n", "one above the other"},
        BadCalibration{"RosOneCamera", "projection_matrix: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n",
                       "right camera: is missing"},
        BadCalibration{"AliasesOfEmptyLists", "%YAML:1.0\n---\n" + nested_aliases("[]", false), "aliases are unfolded"},
        BadCalibration{"AliasesOfEmptyMaps", nested_aliases("{}", true), "aliases are unfolded"},
        BadCalibration{"AliasesOfWords", nested_aliases("word", false), "aliases are unfolded"},
        BadCalibration{"DeeplyNestedYaml", "a: " + std::string(10000, '[') + std::string(10000, ']'), "the_calib"},
        BadCalibration{"DamagedOpenCvTag",
                       "%YAML:1.0\n---\nR1: !!opencv-m`trix\n   rows: 3\nP1: !!opencv-matrix\n   :::cols: 4\n"
                       "Q: !!openc=v-matrix\n   data: [ 1.0, 0, 0,P0 -315.\xff\xfe<opencv_storage>_ 555.2 ]\n",
                       "malformed YAML"},
        BadCalibration{"DeeplyNestedXml", "<opencv_storage>" + repeated("<a>", 50000) + repeated("</a>", 50000),
                       "the_calib"},
        BadCalibration{"OpenCvXmlTwice", "<opencv_storage><P1>1</P1><P1>2</P1></opencv_storage>",
                       "P1: stands in the file twice"},
        BadCalibration{"SelfContainingYaml", "a: &a\n  b: *a\n", "the_calib"},
        BadCalibration{"TransposedProjections",
                       "%YAML:1.0\n---\nP1: [500, 0, 0, 0, 500, 0, 320, 240, 1, 0, 0, 0]\n"
                       "P2: [500, 0, 0, 0, 500, 0, 320, 240, 1, -150, 0, 0]\n",
                       "P1: is transposed"},
        BadCalibration{"PrincipalPointFarOut", kOwn.substr(0, 11) + "cx_px: 60000\n" + kOwn.substr(22),
                       "cx_px (principal point)"}),
    [](const auto& test) { return test.param.name; });

TEST(LoadCalibration, NamesMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { load_calibration(folder.file("nowhere.txt")); }),
              AllOf(HasSubstr("nowhere.txt"), HasSubstr("No such file")));
  EXPECT_THAT(error_of([&] { load_calibration(folder.file("")); }), HasSubstr("is a folder"));
}

TEST(LoadCalibration, NamesTheRosFileLookedFor) {
  const TemporaryFolder folder;
  const auto path = folder.write("left.yaml", "projection_matrix: [400, 0, 320, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n");
  EXPECT_THAT(error_of([&] { load_calibration(path); }), HasSubstr("right.yaml"));
}

TEST(LoadCalibration, RejectsSizesThatNoImageHas) {
  const TemporaryFolder folder;
  const auto path = folder.write("c", kP2 + kP3 + kRect);
  for (const auto [width_px, height_px] : {std::array{-5, 3}, {640, 0}, {0, 480}, {2'000'000'000, 480}}) {
    CalibrationRequest of_images, of_file;
    of_images.width_px = of_file.calibrated_width_px = width_px;
    of_images.height_px = of_file.calibrated_height_px = height_px;
    const auto found = fmt::format("found {} x {} px", width_px, height_px);
    EXPECT_THAT(error_of([&] { load_calibration(path, of_images); }), HasSubstr("image size: " + found));
    EXPECT_THAT(error_of([&] { load_calibration(path, of_file); }), HasSubstr("calibrated size: " + found));
  }
}

TEST(LoadCalibration, RejectsImagesOfAnotherSize) {
  const TemporaryFolder folder;
  CalibrationRequest request;
  request.width_px = 320;
  request.height_px = 240;
  EXPECT_THAT(error_of([&] { load_calibration(folder.write("c", kP2 + kP3 + kRect), request); }),
              HasSubstr("another size"));
}

}  // namespace
}  // namespace flies
