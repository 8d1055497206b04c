#include "flies/video/pair_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/video/toy_video.hpp"

namespace flies {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

constexpr int kJpegError = 4;

struct ToyFilm {
  std::string name;
  int count = 0;
  double rate_hz = 60.0;
  int broken = -1, wide = -1;  ///< pictures that are damaged or of another size
  std::vector<double> stamps_s = {};
};

/// Pictures of rising grey levels.
class ToyReader final : public FrameReader {
 public:
  explicit ToyReader(ToyFilm film) : film_(std::move(film)) {}
  bool read(SourceFrame& frame) override {
    if (next_ == film_.count) return false;
    const int n = next_++;
    if (n == film_.broken) throw InputError(film_.name, "frame", "is broken");
    const int width = n == film_.wide ? 4 : 2;
    frame.images.left = {width, 1, std::vector<std::uint8_t>(static_cast<std::size_t>(width), std::uint8_t(n))};
    frame.left_name = film_.name;
    if (!film_.stamps_s.empty()) frame.stamp_s = film_.stamps_s[static_cast<std::size_t>(n)];
    return true;
  }
  double rate_hz() const override { return film_.rate_hz; }

 private:
  ToyFilm film_;
  int next_ = 0;
};

struct PairStreamTest : ::testing::Test {
  PairStreamTest() { setenv("FLIES_MODULES", FLIES_MODULES, 1); }

  Tell tell() {
    return [this](const std::string& sentence) {
      const std::lock_guard lock(mutex);
      told.push_back(sentence);
    };
  }

  /// @param middle_width_px of the second pair
  std::vector<PairPaths> three_pairs(int middle_width_px = 128) const {
    std::vector<PairPaths> pairs;
    for (int i = 0; i < 3; ++i) {
      const std::string name = std::to_string(i) + ".png";
      const PairPaths paths{folder.file("l" + name), folder.file("r" + name)};
      const int width = i == 1 ? middle_width_px : 128;
      cv::imwrite(paths.left, testing::toy_picture(20 + 10 * i, width, 64));
      cv::imwrite(paths.right, testing::toy_picture(30 + 10 * i, width, 64));
      pairs.push_back(paths);
    }
    return pairs;
  }

  std::vector<StereoFrame> all_of(const PairStreamRequest& request, std::size_t most = 100) {
    PairStream stream(request, tell());
    return all_of(stream, most);
  }

  std::vector<StereoFrame> all_of(const ToyFilm& left, const ToyFilm& right, std::size_t most = 100) {
    const auto opener = [](const ToyFilm& film) { return [film] { return std::make_unique<ToyReader>(film); }; };
    PairStream stream({.sources = {left.name, right.name}, .is_looped = is_looped, .is_patient = true},
                      {opener(left), opener(right)}, tell());
    return all_of(stream, most);
  }

  std::vector<StereoFrame> all_of(PairStream& stream, std::size_t most) {
    std::vector<StereoFrame> frames;
    StereoFrame frame;
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (frames.size() < most && std::chrono::steady_clock::now() < until) {
      const auto answer = stream.next(frame, 100ms);
      has_ended = answer == FrameStream::Answer::ended;
      if (has_ended) break;
      if (answer == FrameStream::Answer::frame) frames.push_back(std::move(frame));
    }
    counts = stream.counts();
    return frames;
  }

  testing::TemporaryFolder folder;
  bool is_looped = false, has_ended = false;
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

TEST_F(PairStreamTest, LostPictureCostsNoPairButItsOwn) {
  const auto frames = all_of({.name = "left", .count = 10}, {.name = "right", .count = 10, .broken = 3});
  ASSERT_THAT(frames, SizeIs(9));
  for (const auto& frame : frames) EXPECT_EQ(frame.images.left.pixels, frame.images.right.pixels);
  EXPECT_EQ(counts.unpaired, 1U);
}

TEST_F(PairStreamTest, GapInTheStampsOfOneFilmCostsOnlyThosePairs) {
  const ToyFilm left{.name = "l", .count = 4, .rate_hz = 10.0, .stamps_s = {0.0, 0.1, 0.4, 0.5}};
  const ToyFilm right{.name = "r", .count = 6, .rate_hz = 10.0};
  const auto pairs = all_of(left, right);
  ASSERT_THAT(pairs, SizeIs(4));
  EXPECT_EQ(pairs[2].images.right.pixels[0], 4);
  EXPECT_EQ(pairs[3].images.right.pixels[0], 5);
  EXPECT_EQ(counts.unpaired, 2U);
}

TEST_F(PairStreamTest, NearestPictureOfAFasterSourceIsTaken) {
  const auto frames =
      all_of({.name = "left", .count = 10, .rate_hz = 100.0}, {.name = "right", .count = 5, .rate_hz = 50.0});
  ASSERT_THAT(frames, SizeIs(5));
  for (const auto& frame : frames) EXPECT_EQ(frame.images.left.pixels[0], 2 * frame.images.right.pixels[0]);
}

TEST_F(PairStreamTest, HalfAStepApartIsAPair) {
  const auto frames = all_of({.name = "left", .count = 2, .rate_hz = 50.0},
                             {.name = "right", .count = 3, .rate_hz = 100.0, .broken = 0});
  ASSERT_THAT(frames, SizeIs(2));
  EXPECT_NEAR(frames[0].skew_s, 0.01, 1e-9);
  EXPECT_NEAR(frames[1].skew_s, 0.0, 1e-9);
}

TEST_F(PairStreamTest, SkewThatComesLaterIsToldOnce) {
  all_of({.name = "left", .count = 120, .rate_hz = 100.0}, {.name = "right", .count = 120, .rate_hz = 99.0}, 120);
  EXPECT_EQ(std::count_if(told.begin(), told.end(),
                          [](const auto& sentence) { return sentence.find("trigger both cameras") != sentence.npos; }),
            1);
  EXPECT_THAT(told, Contains(HasSubstr("4.5 ms apart (median of 30)")));
}

TEST_F(PairStreamTest, FilmsOfUnequalLengthBeginAgainTogether) {
  is_looped = true;
  const auto frames = all_of({.name = "left", .count = 3}, {.name = "right", .count = 5}, 8);
  ASSERT_THAT(frames, SizeIs(8));
  for (int i = 0; i < 8; ++i) {
    const auto& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.images.left.pixels[0], i % 3);
    EXPECT_EQ(frame.images.right.pixels[0], i % 3);
    EXPECT_NEAR(frame.time_s, i / 60.0, 1e-9);
    EXPECT_EQ(frame.skew_s, 0.0);
  }
  EXPECT_EQ(counts.unpaired, 0U);
}

TEST_F(PairStreamTest, LoopWithoutAPairEnds) {
  is_looped = true;
  EXPECT_THAT(all_of({.name = "left", .count = 1, .broken = 0}, {.name = "right", .count = 3}), SizeIs(0));
  EXPECT_TRUE(has_ended);
}

TEST_F(PairStreamTest, OnlyThePictureOfAnotherSizeIsNamed) {
  ASSERT_THAT(all_of({.name = "left", .count = 3}, {.name = "right", .count = 3, .wide = 1}), SizeIs(2));
  EXPECT_THAT(told, Contains(HasSubstr("right: size: found 4 x 1 px, expected 2 x 1 px as before")));
}

TEST_F(PairStreamTest, FolderSkipsADamagedPair) {
  const auto pairs = three_pairs();
  folder.write("l1.png", "damaged");
  const auto frames = all_of({.folder = pairs, .rate_hz = 100.0});
  ASSERT_THAT(frames, SizeIs(2));
  EXPECT_EQ(frames[1].left_name, pairs[2].left);
  EXPECT_NEAR(frames[1].time_s, 0.02, 1e-9);
  EXPECT_EQ(counts.broken, 1U);
  EXPECT_THAT(told, Contains(HasSubstr("l1.png")));
}

TEST_F(PairStreamTest, FolderComesInItsOwnTimes) {
  const auto pairs = three_pairs();
  folder.write("l2.png", "damaged");
  const auto frames = all_of(
      {.folder = pairs, .times_s = {100.0, 100.25, 100.4}, .rate_hz = 5.0, .is_looped = true, .is_patient = true}, 4);
  std::vector<double> times_s;
  for (const auto& frame : frames) times_s.push_back(frame.time_s);
  // A damaged last pair takes its time, and a usual step lies between the rounds.
  EXPECT_THAT(times_s, Pointwise(DoubleNear(1e-9), {0.0, 0.25, 0.6, 0.85}));
}

TEST_F(PairStreamTest, PicturesOvertakenUnreadAreCountedWithEveryPair) {
  const auto opener = [] {
    struct Burst final : FrameReader {
      int next = 0;
      bool read(SourceFrame& frame) override {
        if (next++ == 10) std::this_thread::sleep_for(3s);
        frame.images.left = {4, 1, std::vector<std::uint8_t>(4, static_cast<std::uint8_t>(next))};
        return true;
      }
      double rate_hz() const override { return 0.0; }
    };
    return std::make_unique<Burst>();
  };
  // A pipeline lives: it does not wait for who reads it.
  PairStream stream({.sources = {"both ! x"}}, {opener}, tell());
  std::this_thread::sleep_for(300ms);
  StereoFrame frame;
  ASSERT_EQ(stream.next(frame, 1s), FrameStream::Answer::frame);
  EXPECT_EQ(frame.skipped, 7U) << "three of ten wait";
}

TEST_F(PairStreamTest, PictureOfAnotherSizeIsLeftOut) {
  const auto pairs = three_pairs(96);
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
