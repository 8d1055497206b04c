// What people get wrong in files of raw cameras, and the words that it is told in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/toy_rig.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// OpenCV's names: two alike lenses, the right one 0.12 m to the right.
struct Raw {
  std::string size = "image_width: 640\nimage_height: 480\n";
  std::string m1 = "M1: [460, 0, 320, 0, 460, 240, 0, 0, 1]\n", m2 = "M2: [460, 0, 320, 0, 460, 240, 0, 0, 1]\n";
  std::string d = "0, 0, 0, 0, 0", r = "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n", t = "T: [-0.12, 0, 0]\n";
  std::string text() const { return size + m1 + "D1: [" + d + "]\n" + m2 + "D2: [" + d + "]\n" + r + t; }
};

TEST(RawMistakes, TheFirstWordsNameTheCause) {
  const TemporaryFolder folder;
  const auto error = [&](const Raw& raw) { return error_of([&] { load_calibration(folder.write("c", raw.text())); }); };
  Raw before, twice, tiny, alone, unsized;
  before.t = "T: [0, 0, -0.12]\n";
  EXPECT_THAT(error(before), HasSubstr("one before the other"));
  before.t = "T: [0, -0.12, 0]\n";
  EXPECT_THAT(error(before), HasSubstr("one above the other"));
  twice.m2 = "M2: [920, 0, 640, 0, 920, 480, 0, 0, 1]\n";
  EXPECT_THAT(error(twice),
              HasSubstr("c: the focal lengths of M1 and M2 are 460 and 920 px, expected nearly the same"));
  tiny.t = "T: [-0.00012, 0.0008, 0.0005]\n";
  EXPECT_THAT(error(tiny), HasSubstr("is the translation, or one of its numbers, in another unit?"));
  alone.r = alone.t = "";
  EXPECT_THAT(error(alone), AllOf(HasSubstr("R: is missing"), HasSubstr("--right-calib")));
  unsized.size = "";
  EXPECT_THAT(error(unsized), HasSubstr("--size W,H"));
}

TEST(RawMistakes, APrincipalPointIsToldOnce) {
  const TemporaryFolder folder;
  Raw raw;
  raw.m1 = "M1: [460, 0, 220, 0, 460, 240, 0, 0, 1]\n";
  raw.m2 = "M2: [460, 0, 220, 0, 460, 240, 0, 0, 1]\n";
  int told = 0;
  for (const auto& note : texts(load_calibration(folder.write("c", raw.text())).notes))
    told += note.find("principal point") != std::string::npos;
  EXPECT_EQ(told, 1);
}

TEST(RawMistakes, ALensThatFoldsBackWithinTheImageIsTold) {
  const TemporaryFolder folder;
  const auto notes = [&](const std::string& d) {
    Raw raw;
    raw.d = d;
    return texts(load_calibration(folder.write("c", raw.text())).notes);
  };
  EXPECT_THAT(notes("-8, 40, 0, 0, -90"), Contains(HasSubstr("M1: with its distortion coefficients nothing is seen")));
  for (const char* good : {"0, 0, 0, 0, 0", "-0.2834, 0.074, 0.0002, 0, 0", "-0.3729, 0.2037, 0.0022, 0.0014, -0.0723"})
    EXPECT_THAT(notes(good), Not(Contains(HasSubstr("nothing is seen"))));
}

}  // namespace
}  // namespace flies
