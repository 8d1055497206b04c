#include "flies/video/film.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/video/capture.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

struct FilmTest : ::testing::Test {
  FilmTest() { setenv("FLIES_MODULES", FLIES_MODULES, 1); }
};

int files_in(const TemporaryFolder& folder) {
  int count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.file("."))) ++count;
  return count;
}

TEST_F(FilmTest, CanBeReadAgain) {
  const TemporaryFolder folder;
  const std::string path = folder.file("film.mp4");
  {
    Film film(path, 10.0);
    for (int i = 0; i < 5; ++i) film.add(cv::Mat(121, 161, CV_8UC3, cv::Scalar::all(40 * i)));  // odd: cut to even
    EXPECT_FALSE(fs::exists(path)) << "before it is complete";
    film.commit();
  }
  EXPECT_EQ(files_in(folder), 1);
  const auto capture = open_capture({.source = path});
  GrayImage image;
  int count = 0;
  for (; capture->read(image); ++count) {
    EXPECT_EQ(image.width_px, 160);
    EXPECT_EQ(image.height_px, 120);
    EXPECT_NEAR(image.pixels[1000], 40 * count, 6);
  }
  EXPECT_EQ(count, 5);
  EXPECT_NEAR(capture->rate_hz(), 10.0, 0.01);
}

TEST_F(FilmTest, LeavesNothingBehindUnlessItIsComplete) {
  const TemporaryFolder folder;
  {
    Film film(folder.file("film.mp4"), 10.0);
    film.add(cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(90)));
    EXPECT_EQ(files_in(folder), 1);
  }
  EXPECT_EQ(files_in(folder), 0);
}

TEST_F(FilmTest, TakesOverWhatAKilledRunLeft) {
  const TemporaryFolder folder;
  folder.write("film.mp4.part.mp4", "half");
  {
    Film film(folder.file("film.mp4"), 10.0);
    film.add(cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(90)));
  }
  EXPECT_EQ(files_in(folder), 0);
}

TEST_F(FilmTest, IsWrittenByOneRunAtATime) {
  const TemporaryFolder folder;
  const cv::Mat picture(120, 160, CV_8UC3, cv::Scalar::all(90));
  Film film(folder.file("film.mp4"), 10.0);
  film.add(picture);
  {
    Film other(folder.file("film.mp4"), 10.0);
    EXPECT_THAT(error_of([&] { other.add(picture); }), HasSubstr("film.mp4: another run is writing it"));
  }
  film.add(picture);
  film.commit();
  EXPECT_EQ(files_in(folder), 1);
  Film next(folder.file("film.mp4"), 10.0);
  next.add(picture);
  next.commit();
  EXPECT_EQ(files_in(folder), 1);
}

TEST_F(FilmTest, RefusesWhatItCannotBe) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { Film(folder.file("film.avi"), 10.0); }), HasSubstr("film.avi: has another ending"));
  EXPECT_THAT(error_of([&] { Film(folder.file("none/film.mp4"), 10.0); }), HasSubstr("its folder does not exist"));
  EXPECT_THAT(error_of([&] { Film(folder.file("film.mp4"), 10.0).commit(); }), HasSubstr("no picture came"));
  EXPECT_THAT(error_of([&] {
                Film film(folder.file("film.mp4"), 10.0);
                film.add(cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(90)));
                film.add(cv::Mat(100, 160, CV_8UC3, cv::Scalar::all(90)));
              }),
              HasSubstr("found a picture of 160 x 100 px after ones of 160 x 120 px"));
  EXPECT_EQ(files_in(folder), 0);
}

}  // namespace
}  // namespace flies
