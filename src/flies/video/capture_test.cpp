#include "flies/video/capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/video/lazy_module.hpp"
#include "flies/video/toy_video.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct CaptureTest : ::testing::Test {
  CaptureTest() { setenv("FLIES_MODULES", FLIES_MODULES, 1); }
  testing::TemporaryFolder folder;
};

TEST_F(CaptureTest, SourcesAreToldApart) {
  EXPECT_EQ(source_kind("0"), SourceKind::device);
  EXPECT_EQ(source_kind("/dev/video2"), SourceKind::device);
  EXPECT_EQ(source_kind("videotestsrc ! videoconvert"), SourceKind::stream);
  EXPECT_EQ(source_kind("rtsp://camera/1"), SourceKind::stream);
  EXPECT_EQ(source_kind("film.mp4"), SourceKind::file);
  EXPECT_EQ(source_kind("2011"), SourceKind::file);
}

TEST_F(CaptureTest, FilmIsReadAsGrey) {
  const std::string path = folder.file("film.avi");
  testing::write_toy_film(path, 3);
  const auto capture = open_capture({.source = path});
  EXPECT_NEAR(capture->rate_hz(), 50.0, 0.1);
  GrayImage image;
  constexpr int kJpegError = 4;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(capture->read(image)) << i;
    EXPECT_EQ(image.width_px, 128);
    EXPECT_EQ(image.height_px, 48);
    EXPECT_NEAR(image.view().at(10, 10), 20 + 10 * i, kJpegError);
    EXPECT_NEAR(image.view().at(120, 40), 60 + 10 * i, kJpegError);
  }
  EXPECT_FALSE(capture->read(image));
}

TEST_F(CaptureTest, WhatCannotBeOpenedIsToldByKind) {
  const std::string text = folder.file("text.avi");
  std::ofstream(text) << "no film";
  EXPECT_THAT([&] { open_capture({.source = text}); },
              ThrowsMessage<InputError>(HasSubstr("text.avi: cannot be read as")));
  EXPECT_THAT([&] { open_capture({.source = folder.file("absent.avi")}); },
              ThrowsMessage<InputError>(HasSubstr("absent.avi: does not exist")));
  EXPECT_THAT([&] { open_capture({.source = "/dev/video987"}); },
              ThrowsMessage<InputError>(HasSubstr("/dev/video987: no camera")));
  EXPECT_THAT([&] { open_capture({.source = "nosuchelement ! videoconvert", .patience_s = 2.0}); },
              ThrowsMessage<InputError>(HasSubstr("gst-launch-1.0")));
  EXPECT_THAT([&] { open_capture({.source = ""}); }, ThrowsMessage<InputError>(HasSubstr("source: is empty")));
}

TEST_F(CaptureTest, OpeningDoesNotWaitForEver) {
  if (!testing::has_gstreamer()) GTEST_SKIP() << "GStreamer's test sources are not there";
  // Nothing ever comes out of this one, and videoio would wait for it.
  EXPECT_THAT([&] { open_capture({.source = "appsrc ! videoconvert ! appsink", .patience_s = 0.3}); },
              ThrowsMessage<InputError>(HasSubstr("was not open after 0.3 s")));
}

TEST_F(CaptureTest, PipelineGetsItsSink) {
  if (!testing::has_gstreamer()) GTEST_SKIP() << "GStreamer's test sources are not there";
  const auto capture =
      open_capture({.source = "videotestsrc num-buffers=2 pattern=white ! video/x-raw,width=96,height=64"});
  GrayImage image;
  ASSERT_TRUE(capture->read(image));
  EXPECT_EQ(image.width_px, 96);
  EXPECT_EQ(image.height_px, 64);
  EXPECT_GT(image.view().at(5, 5), 240);
}

TEST_F(CaptureTest, MissingModuleAndFunctionAreNamed) {
  EXPECT_THAT([] { module_function("flies_video", "no_such_function"); },
              ThrowsMessage<InputError>(HasSubstr("flies_video.so: no_such_function: ")));
  setenv("FLIES_MODULES", folder.file("").c_str(), 1);
  EXPECT_THAT([] { module_function("flies_video", kOpenCaptureName); },
              ThrowsMessage<InputError>(HasSubstr("flies_video.so: is missing")));
}

}  // namespace
}  // namespace flies
