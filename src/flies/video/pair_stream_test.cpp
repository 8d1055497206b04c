#include "flies/video/pair_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/video/toy_video.hpp"

namespace flies {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr int kJpegError = 4;

struct PairStreamTest : ::testing::Test {
  PairStreamTest() { setenv("FLIES_MODULES", FLIES_MODULES, 1); }

  std::vector<StereoFrame> all_of(const PairStreamRequest& request, std::size_t most = 100) {
    PairStream stream(request, [this](const std::string& sentence) {
      const std::lock_guard lock(mutex);
      told.push_back(sentence);
    });
    std::vector<StereoFrame> frames;
    StereoFrame frame;
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (frames.size() < most && std::chrono::steady_clock::now() < until) {
      const auto answer = stream.next(frame, 100ms);
      if (answer == FrameStream::Answer::ended) break;
      if (answer == FrameStream::Answer::frame) frames.push_back(std::move(frame));
    }
    counts = stream.counts();
    return frames;
  }

  testing::TemporaryFolder folder;
  std::mutex mutex;
  std::vector<std::string> told;
  PairStreamCounts counts;
};

TEST_F(PairStreamTest, FilmSideBySideIsSplit) {
  const std::string path = folder.file("both.avi");
  testing::write_toy_film(path, 4);
  const auto frames = all_of({.sources = {path}, .is_patient = true});
  ASSERT_THAT(frames, SizeIs(4));
  for (int i = 0; i < 4; ++i) {
    const auto& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.images.left.width_px, 64);
    EXPECT_EQ(frame.images.right.height_px, 48);
    EXPECT_NEAR(frame.images.left.view().at(60, 40), 20 + 10 * i, kJpegError);
    EXPECT_NEAR(frame.images.right.view().at(3, 40), 60 + 10 * i, kJpegError);
    EXPECT_NEAR(frame.time_s, i / 50.0, 1e-6);
    EXPECT_EQ(frame.skew_s, 0.0);
  }
}

TEST_F(PairStreamTest, TopAndBottomAreSplit) {
  GrayImage both{2, 4, {1, 2, 3, 4, 5, 6, 7, 8}};
  const GrayPair pair = split_picture(both, PairLayout::top_bottom, "film");
  EXPECT_EQ(pair.left.pixels, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(pair.right.pixels, (std::vector<std::uint8_t>{5, 6, 7, 8}));
  const GrayPair beside = split_picture(both, PairLayout::side_by_side, "film");
  EXPECT_EQ(beside.left.pixels, (std::vector<std::uint8_t>{1, 3, 5, 7}));
}

TEST_F(PairStreamTest, OddPictureIsTold) {
  GrayImage both{3, 2, std::vector<std::uint8_t>(6)};
  EXPECT_THAT([&] { split_picture(both, PairLayout::side_by_side, "film"); },
              ThrowsMessage<InputError>(HasSubstr("film: width: found 3 px, expected an even number")));
}

TEST_F(PairStreamTest, TwoFilmsPairUp) {
  const std::string left = folder.file("left.avi"), right = folder.file("right.avi");
  testing::write_toy_film(left, 5, 50.0);
  testing::write_toy_film(right, 5, 50.0);
  const auto frames = all_of({.sources = {left, right}, .is_patient = true});
  ASSERT_THAT(frames, SizeIs(5));
  for (const auto& frame : frames) {
    EXPECT_EQ(frame.images.left.pixels, frame.images.right.pixels);
    EXPECT_EQ(frame.skew_s, 0.0);
  }
}

TEST_F(PairStreamTest, UnequalRatesPairByTime) {
  const std::string left = folder.file("left.avi"), right = folder.file("right.avi");
  testing::write_toy_film(left, 10, 50.0);
  testing::write_toy_film(right, 5, 25.0);
  const auto frames = all_of({.sources = {left, right}, .is_patient = true, .max_skew_s = 0.005});
  ASSERT_THAT(frames, SizeIs(5));
  for (int i = 0; i < 5; ++i) {
    const auto& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_NEAR(frame.time_s, i / 25.0, 1e-6);
    EXPECT_NEAR(frame.images.left.view().at(10, 10), 20 + 20 * i, kJpegError);
    EXPECT_NEAR(frame.images.right.view().at(10, 10), 20 + 10 * i, kJpegError);
  }
  EXPECT_EQ(counts.unpaired, 4U);
}

TEST_F(PairStreamTest, FolderSkipsADamagedPair) {
  std::vector<PairPaths> pairs;
  for (int i = 0; i < 3; ++i) {
    const PairPaths paths{folder.file("l" + std::to_string(i) + ".png"), folder.file("r" + std::to_string(i) + ".png")};
    cv::imwrite(paths.left, testing::toy_picture(20 + 10 * i, 128, 64));
    cv::imwrite(paths.right, testing::toy_picture(30 + 10 * i, 128, 64));
    pairs.push_back(paths);
  }
  folder.write("l1.png", "damaged");
  const auto frames = all_of({.folder = pairs, .rate_hz = 100.0});
  ASSERT_THAT(frames, SizeIs(2));
  EXPECT_EQ(frames[1].left_name, pairs[2].left);
  EXPECT_NEAR(frames[1].time_s, 0.02, 1e-9);
  EXPECT_EQ(counts.broken, 1U);
  EXPECT_THAT(told, Contains(HasSubstr("l1.png")));
}

TEST_F(PairStreamTest, PictureOfAnotherSizeIsLeftOut) {
  std::vector<PairPaths> pairs;
  for (int i = 0; i < 3; ++i) {
    const PairPaths paths{folder.file("l" + std::to_string(i) + ".png"), folder.file("r" + std::to_string(i) + ".png")};
    const int width = i == 1 ? 96 : 128;
    cv::imwrite(paths.left, testing::toy_picture(20 + 10 * i, width, 64));
    cv::imwrite(paths.right, testing::toy_picture(30 + 10 * i, width, 64));
    pairs.push_back(paths);
  }
  ASSERT_THAT(all_of({.folder = pairs, .is_patient = true}), SizeIs(2));
  EXPECT_THAT(told, Contains(HasSubstr("found 96 x 64 px, expected 128 x 64 px as before")));
}

TEST_F(PairStreamTest, TwoPipelinesPairByTheTimeTheyCame) {
  if (!testing::has_gstreamer()) GTEST_SKIP() << "GStreamer's test sources are not there";
  const std::string source = "videotestsrc is-live=true ! video/x-raw,width=128,height=64,framerate=30/1";
  const auto frames = all_of({.sources = {source, source}, .max_skew_s = 0.02}, 10);
  ASSERT_THAT(frames, SizeIs(10));
  for (const auto& frame : frames) EXPECT_LE(std::abs(frame.skew_s), 0.02);
  EXPECT_GT(frames[9].time_s, frames[0].time_s + 0.1);
}

TEST_F(PairStreamTest, PipelineThatEndsIsStartedAgain) {
  if (!testing::has_gstreamer()) GTEST_SKIP() << "GStreamer's test sources are not there";
  const auto frames =
      all_of({.sources = {"videotestsrc num-buffers=2 ! video/x-raw,width=128,height=64"}, .first_pause_s = 0.05}, 5);
  EXPECT_THAT(frames, SizeIs(5));
  EXPECT_GE(counts.losses, 2U);
  EXPECT_THAT(told, Contains(HasSubstr("gives no more pictures; trying again")));
}

}  // namespace
}  // namespace flies
