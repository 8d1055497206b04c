#include "flies/video/frame_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/video/told.hpp"

namespace flies {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using testing::file_options;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::Told;

/// Gives frames of rising grey levels, then what the test says.
class ToyReader final : public FrameReader {
 public:
  enum class Then { end, block };
  ToyReader(int first, int count, Then then = Then::end, int broken = -1)
      : next_(first), end_(first + count), then_(then), broken_(broken) {}
  bool read(SourceFrame& frame) override {
    if (next_ == end_) {
      if (then_ == Then::block) std::this_thread::sleep_for(3s);
      return false;
    }
    const int n = next_++;
    if (n == broken_) throw InputError("toy", "frame", "is broken");
    frame.images.left = {2, 2, std::vector<std::uint8_t>(4, static_cast<std::uint8_t>(n))};
    if (pace.count() > 0) std::this_thread::sleep_for(pace);
    return true;
  }
  double rate_hz() const override { return 200.0; }

  std::chrono::milliseconds pace{0};

 private:
  int next_, end_;
  Then then_;
  int broken_;
};

std::vector<int> levels_until(FrameStream& stream, std::size_t most, FrameStream::Answer last) {
  std::vector<int> levels;
  SourceFrame frame;
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (levels.size() < most && std::chrono::steady_clock::now() < until) {
    const auto answer = stream.next(frame, 50ms);
    if (answer == FrameStream::Answer::frame)
      levels.push_back(frame.images.left.pixels[0]);
    else if (answer == last)
      break;
  }
  return levels;
}

FrameStreamOptions living_options() {
  FrameStreamOptions options;
  options.name = "toy";
  options.is_living = true;
  options.first_pause_s = 0.02;
  options.stuck_s = 0.1;
  return options;
}

TEST(FrameStream, FileIsReadToItsEndInItsOwnTime) {
  Told told;
  const auto began = std::chrono::steady_clock::now();
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 10); }, file_options(), told.tell(), began);
  SourceFrame frame;
  std::vector<double> times;
  while (stream.next(frame, 1s) == FrameStream::Answer::frame) times.push_back(frame.time_s);
  ASSERT_THAT(times, SizeIs(10));
  EXPECT_NEAR(times[9], 9 / 200.0, 1e-9);
  EXPECT_NEAR(frame.step_s, 1 / 200.0, 1e-9);
  EXPECT_GE(std::chrono::steady_clock::now() - began, 45ms);
  EXPECT_EQ(stream.next(frame, 0ms), FrameStream::Answer::ended);
  EXPECT_THAT(told.sentences(), SizeIs(0));
}

TEST(FrameStream, LoopGoesOnInTime) {
  Told told;
  auto options = file_options();
  options.is_looped = options.is_patient = true;
  options.rate_hz = 10.0;
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 2); }, options, told.tell(),
                     std::chrono::steady_clock::now());
  SourceFrame frame;
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(stream.next(frame, 1s), FrameStream::Answer::frame);
    EXPECT_EQ(frame.images.left.pixels[0], i % 2);
    EXPECT_NEAR(frame.time_s, i / 10.0, 1e-9);
  }
}

TEST(FrameStream, BrokenFrameIsLeftOutAndToldOnce) {
  Told told;
  std::atomic<int> opened = 0;
  auto options = file_options();
  options.is_patient = options.is_looped = true;
  FrameStream stream(
      [&] {
        ++opened;
        return std::make_unique<ToyReader>(0, 3, ToyReader::Then::end, 1);
      },
      options, told.tell(), std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 4, FrameStream::Answer::ended), ElementsAre(0, 2, 0, 2));
  EXPECT_GE(stream.counts().broken, 2U);
  EXPECT_THAT(told.sentences(), ElementsAre(HasSubstr("toy: frame: is broken; it is left out")));
}

TEST(FrameStream, LoopWithoutAUsableFrameEnds) {
  Told told;
  auto options = file_options();
  options.is_patient = options.is_looped = true;
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 1, ToyReader::Then::end, 0); }, options, told.tell(),
                     std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 1, FrameStream::Answer::ended), SizeIs(0));
  SourceFrame frame;
  EXPECT_EQ(stream.next(frame, 0ms), FrameStream::Answer::ended);
  EXPECT_EQ(stream.counts().broken, 1U);
}

TEST(FrameStream, ListenerThatThrowsEndsTheStreamOnly) {
  auto options = file_options();
  options.is_patient = true;
  const auto tell = [](const std::string&) { throw std::runtime_error("does not listen"); };
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 3, ToyReader::Then::end, 1); }, options, tell,
                     std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 3, FrameStream::Answer::ended), ElementsAre(0));
  SourceFrame frame;
  EXPECT_EQ(stream.next(frame, 0ms), FrameStream::Answer::ended);
}

TEST(FrameStream, RestartedFileBeginsAgain) {
  Told told;
  auto options = file_options();
  options.is_patient = true;
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 9); }, options, told.tell(),
                     std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 2, FrameStream::Answer::ended), ElementsAre(0, 1));
  stream.restart(std::chrono::steady_clock::now());
  SourceFrame frame;
  ASSERT_EQ(stream.next(frame, 1s), FrameStream::Answer::frame);
  EXPECT_EQ(frame.images.left.pixels[0], 0);
  EXPECT_EQ(frame.time_s, 0.0);
  EXPECT_THAT(levels_until(stream, 20, FrameStream::Answer::ended), SizeIs(8));
  stream.restart(std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 20, FrameStream::Answer::ended), SizeIs(9));
}

TEST(FrameStream, LivingSourceThatGoesAwayIsOpenedAgain) {
  Told told;
  std::atomic<int> opened = 0;
  FrameStream stream(
      [&]() -> std::unique_ptr<FrameReader> {
        const int time = opened++;
        if (time == 1 || time == 2) throw InputError("toy", "", "is not there");
        return std::make_unique<ToyReader>(10 * time, 2);
      },
      living_options(), told.tell(), std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 4, FrameStream::Answer::ended), ElementsAre(0, 1, 30, 31));
  EXPECT_GE(stream.counts().losses, 1U);
  ASSERT_GE(told.sentences().size(), 2U);
  EXPECT_EQ(told.sentences()[0], "toy: gives no more pictures; trying again");
  EXPECT_EQ(told.sentences()[1], "toy: is back");
}

TEST(FrameStream, LossesInARowAreToldOnce) {
  Told told;
  std::atomic<int> opened = 0;
  FrameStream stream([&] { return std::make_unique<ToyReader>(opened++, 1); }, living_options(), told.tell(),
                     std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 4, FrameStream::Answer::ended), SizeIs(4));
  EXPECT_GE(stream.counts().losses, 3U);
  const auto sentences = told.sentences();
  EXPECT_EQ(std::count(sentences.begin(), sentences.end(), "toy: gives no more pictures; trying again"), 1);
  EXPECT_EQ(std::count(sentences.begin(), sentences.end(), "toy: is back"), 1);
}

TEST(FrameStream, WaitsForAFrameHoweverLongItMay) {
  Told told;
  const auto late = [] {
    auto reader = std::make_unique<ToyReader>(7, 8);
    reader->pace = 100ms;
    return reader;
  };
  FrameStream stream(late, {.name = "toy", .is_living = true}, told.tell(), std::chrono::steady_clock::now());
  SourceFrame frame;
  EXPECT_EQ(stream.next(frame, std::chrono::milliseconds::max()), FrameStream::Answer::frame);
}

TEST(FrameStream, StuckSourceIsOpenedBesideAndEndsAtOnce) {
  Told told;
  std::atomic<int> opened = 0;
  const auto began = std::chrono::steady_clock::now();
  {
    FrameStream stream([&] { return std::make_unique<ToyReader>(10 * opened++, 1, ToyReader::Then::block); },
                       living_options(), told.tell(), began);
    EXPECT_THAT(levels_until(stream, 2, FrameStream::Answer::ended), ElementsAre(0, 10));
    EXPECT_THAT(told.sentences().at(0), HasSubstr("toy: has given no picture for 0.1 s"));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s);  // the blocked reads take three
}

TEST(FrameStream, SourceThatHangsAgainIsOpenedAgain) {
  Told told;
  std::atomic<int> opened = 0;
  FrameStream stream(
      [&] {
        const int time = opened++;
        return std::make_unique<ToyReader>(10 * time, time == 1 ? 0 : 1, ToyReader::Then::block);
      },
      living_options(), told.tell(), std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 2, FrameStream::Answer::ended), ElementsAre(0, 20));
  EXPECT_GE(stream.counts().losses, 2U);
  EXPECT_THAT(told.sentences(), ElementsAre(HasSubstr("toy: has given no picture for 0.1 s"), "toy: is back"));
}

TEST(FrameStream, TooManyHangingAttemptsAreToldOnce) {
  Told told;
  auto options = living_options();
  options.stuck_s = 0.02;
  FrameStream stream([] { return std::make_unique<ToyReader>(0, 0, ToyReader::Then::block); }, options, told.tell(),
                     std::chrono::steady_clock::now());
  const auto times_told = [&] {
    const auto sentences = told.sentences();
    return std::count_if(sentences.begin(), sentences.end(),
                         [](const auto& sentence) { return sentence.starts_with("toy: hangs in 4 attempts"); });
  };
  SourceFrame frame;
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (times_told() == 0 && std::chrono::steady_clock::now() < until) stream.next(frame, 10ms);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(stream.next(frame, 10ms), FrameStream::Answer::nothing_yet);
  EXPECT_EQ(times_told(), 1);
}

TEST(FrameStream, LateFailureOfAStuckReadingIsNotTheEnd) {
  class LateFailure final : public FrameReader {
   public:
    bool read(SourceFrame&) override {
      std::this_thread::sleep_for(300ms);
      throw std::runtime_error("the driver failed");
    }
    double rate_hz() const override { return 0.0; }
  };
  Told told;
  std::atomic<int> opened = 0;
  FrameStream stream(
      [&]() -> std::unique_ptr<FrameReader> {
        if (opened++ == 0) return std::make_unique<LateFailure>();
        auto reader = std::make_unique<ToyReader>(10, 100);
        reader->pace = 10ms;
        return reader;
      },
      living_options(), told.tell(), std::chrono::steady_clock::now());
  EXPECT_THAT(levels_until(stream, 60, FrameStream::Answer::ended), SizeIs(60));
}

TEST(FrameStream, LivingSourceTellsItsUsualStep) {
  Told told;
  FrameStream stream(
      [] {
        auto reader = std::make_unique<ToyReader>(0, 20, ToyReader::Then::block);
        reader->pace = 5ms;
        return reader;
      },
      living_options(), told.tell(), std::chrono::steady_clock::now());
  SourceFrame frame;
  do {
    ASSERT_EQ(stream.next(frame, 2s), FrameStream::Answer::frame);
  } while (frame.images.left.pixels[0] < 15);
  EXPECT_GE(frame.step_s, 0.004);
  EXPECT_LT(frame.step_s, frame.time_s);
}

TEST(FrameStream, StampsOfASourceCountMoreThanWhenItsFramesCome) {
  /// Takes a frame every 10 ms by its stamps, and delivers it some ms later, now more and now less.
  struct StampedReader final : FrameReader {
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    bool is_by_another_clock = false;
    int next = 0;
    bool read(SourceFrame& frame) override {
      if (next == 12) std::this_thread::sleep_for(3s);
      const auto taken = start + next * 10ms;
      std::this_thread::sleep_until(taken + (next % 2 == 0 ? 8ms : 1ms));
      frame.images.left = {1, 1, {static_cast<std::uint8_t>(next++)}};
      frame.taken_at = is_by_another_clock ? taken - 1h : taken;
      return true;
    }
    double rate_hz() const override { return 0.0; }
  };
  for (const bool is_by_another_clock : {false, true}) {
    Told told;
    FrameStream stream(
        [&] {
          auto reader = std::make_unique<StampedReader>();
          reader->is_by_another_clock = is_by_another_clock;
          return reader;
        },
        living_options(), told.tell(), std::chrono::steady_clock::now());
    std::vector<double> times_s;
    std::vector<int> levels;
    SourceFrame frame;
    while (levels.empty() || levels.back() < 11) {
      ASSERT_EQ(stream.next(frame, 2s), FrameStream::Answer::frame);
      times_s.push_back(frame.time_s);
      levels.push_back(frame.images.left.pixels[0]);
    }
    for (std::size_t i = 1; i < times_s.size(); ++i) {
      const double steps = levels[i] - levels[i - 1];
      if (is_by_another_clock)
        EXPECT_GT(times_s[i], times_s[i - 1]) << "as they came";
      else
        EXPECT_NEAR(times_s[i] - times_s[i - 1], 0.01 * steps, 1e-6);
    }
  }
}

TEST(FrameStream, LivingSourceGivesTheNewest) {
  Told told;
  FrameStream stream(
      [] {
        auto reader = std::make_unique<ToyReader>(0, 20, ToyReader::Then::block);
        reader->pace = 1ms;
        return reader;
      },
      living_options(), told.tell(), std::chrono::steady_clock::now());
  std::this_thread::sleep_for(80ms);
  SourceFrame frame;
  ASSERT_EQ(stream.next(frame, 1s), FrameStream::Answer::frame);
  EXPECT_EQ(frame.images.left.pixels[0], 17);  // three wait
  EXPECT_EQ(stream.counts().skipped, 17U);
  EXPECT_EQ(frame.skipped, 17U);
}

TEST(FrameStream, SourceThatCannotBeOpenedAtFirstIsAnError) {
  EXPECT_THROW(FrameStream([]() -> std::unique_ptr<FrameReader> { throw InputError("toy", "", "is not there"); },
                           living_options(), [](const std::string&) {}, std::chrono::steady_clock::now()),
               InputError);
}

TEST(FrameStream, FrozenPictureIsTold) {
  class Frozen final : public FrameReader {
   public:
    bool read(SourceFrame& frame) override {
      frame.images.left = {1, 1, {7}};
      std::this_thread::sleep_for(20ms);
      return true;
    }
    double rate_hz() const override { return 50.0; }
  };
  Told told;
  auto options = living_options();
  options.stuck_s = 5.0;
  FrameStream stream([] { return std::make_unique<Frozen>(); }, options, told.tell(), std::chrono::steady_clock::now());
  const auto until = std::chrono::steady_clock::now() + 8s;
  while (told.sentences().empty() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(20ms);
  EXPECT_THAT(told.sentences(), ElementsAre(HasSubstr("does the camera hang?")));
}

}  // namespace
}  // namespace flies
