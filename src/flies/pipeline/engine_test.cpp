#include "flies/pipeline/engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <thread>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 320, kHeight_px = 120;
constexpr auto kLong = 60s;

StereoCamera camera() {
  return {.fx_px = 300,
          .fy_px = 300,
          .cx_px = 160,
          .cx_right_px = 160,
          .cy_px = 50,
          .baseline_m = 0.5,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.5}};
}

/// A wall of noise.
struct Wall {
  std::vector<std::uint8_t> left, right;

  explicit Wall(int disparity_px) : left(kWidth_px * kHeight_px), right(kWidth_px * kHeight_px) {
    for (int v = 0; v < kHeight_px; ++v)
      for (int u = 0; u < kWidth_px; ++u) {
        const auto gray = [&](int column) {
          return static_cast<std::uint8_t>(
              FlyRandom(4, 0, static_cast<std::uint32_t>(v / 3), static_cast<std::uint32_t>((column + 300) / 3))
                  .below(256));
        };
        left[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u);
        right[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u + disparity_px);
      }
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

DetectorOptions few_flies() {
  DetectorOptions options;
  options.evolve.flies = 300;
  return options;
}

TEST(Engine, KnowsNothingBeforeItsFirstPair) {
  const Engine engine(camera(), few_flies(), {}, nullptr);
  const auto snapshot = engine.snapshot();
  ASSERT_NE(snapshot, nullptr);
  EXPECT_EQ(snapshot->number, 0U);
  EXPECT_TRUE(snapshot->tracking.tracks.empty());
  EXPECT_TRUE(std::isnan(snapshot->age_s()));
  EXPECT_EQ(engine.wait(0, 1ms)->number, 0U);
}

TEST(Engine, WaitsForAResultHoweverLongItMay) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  engine.submit(Wall(10).pair(), 0.0);
  EXPECT_EQ(engine.wait(0, std::chrono::milliseconds::max())->number, 1U);
  engine.submit(Wall(11).pair(), 0.1);
  EXPECT_EQ(engine.wait_for_next(1, std::chrono::milliseconds::max())->number, 2U);
}

TEST(Engine, NothingHasAnAgeUntilAPairCouldBeUsed) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  const Wall wall(10);
  engine.submit({wall.pair().left, wall.pair().left}, 0.0);
  const auto refused = engine.wait(0, kLong);
  EXPECT_FALSE(refused->error.empty());
  EXPECT_TRUE(std::isnan(refused->age_s()));
  engine.submit(wall.pair(), 0.1);
  EXPECT_GT(engine.wait(1, kLong)->age_s(), 0.0);
}

TEST(Engine, GivesWhatATrackerGives) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  Tracker tracker(camera(), few_flies(), {}, nullptr);
  for (int i = 0; i < 4; ++i) {
    const Wall wall(10 + i);
    const double time_s = 0.1 * i;
    const Tracking expected = tracker.process(wall.pair(), time_s);
    engine.submit(wall.pair(), time_s);
    const auto snapshot = engine.wait(static_cast<std::uint64_t>(i), kLong);
    ASSERT_EQ(snapshot->number, static_cast<std::uint64_t>(i) + 1);
    EXPECT_EQ(snapshot->tracking.time_s, time_s);
    EXPECT_EQ(snapshot->tracking.detection.scan.ranges_m.size(), expected.detection.scan.ranges_m.size());
    EXPECT_EQ(snapshot->tracking.detection.evolved.flies.x_m, expected.detection.evolved.flies.x_m);
    ASSERT_EQ(snapshot->tracking.tracks.size(), expected.tracks.size());
    for (std::size_t t = 0; t < expected.tracks.size(); ++t)
      EXPECT_EQ(snapshot->tracking.tracks[t].state.x_m, expected.tracks[t].state.x_m);
    EXPECT_GE(snapshot->age_s() * 1e3, snapshot->latency_ms);
    EXPECT_EQ(snapshot->dropped, 0U);
  }
}

TEST(Engine, ASnapshotIsNotChangedByLaterPairs) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  engine.submit(Wall(10).pair(), 0.0);
  const auto first = engine.wait(0, kLong);
  const auto flies = first->tracking.detection.evolved.flies.x_m;
  engine.submit(Wall(20).pair(), 0.1);
  const auto second = engine.wait(1, kLong);
  ASSERT_EQ(second->number, 2U);
  EXPECT_EQ(first->tracking.time_s, 0.0);
  EXPECT_EQ(first->tracking.detection.evolved.flies.x_m, flies);
}

TEST(Engine, AReaderWhoIsALittleLateMissesNoResult) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  constexpr std::uint64_t kPairs = 12, kKept = 8;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    engine.submit(Wall(10).pair(), 0.1 * static_cast<double>(i));
    ASSERT_EQ(engine.wait(i, kLong)->number, i + 1);
  }
  EXPECT_EQ(engine.wait(0, kLong)->number, kPairs);
  for (std::uint64_t number = kPairs - kKept; number < kPairs; ++number)
    EXPECT_EQ(engine.wait_for_next(number, kLong)->number, number + 1);
  EXPECT_EQ(engine.wait_for_next(0, kLong)->number, kPairs - kKept + 1);
  EXPECT_EQ(engine.wait_for_next(kPairs, std::chrono::milliseconds(1))->number, kPairs);
}

TEST(Engine, ABurstCostsOldPairsWhichAreCounted) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  const Wall wall(10);
  constexpr int kPairs = 200;
  for (int i = 0; i < kPairs; ++i) engine.submit(wall.pair(), 0.01 * i);
  std::shared_ptr<const Snapshot> snapshot = engine.snapshot();
  while (snapshot->tracking.time_s != 0.01 * (kPairs - 1)) {
    const auto next = engine.wait(snapshot->number, kLong);
    ASSERT_GT(next->number, snapshot->number);
    snapshot = next;
  }
  EXPECT_EQ(snapshot->submitted, static_cast<std::uint64_t>(kPairs));
  EXPECT_EQ(snapshot->number + snapshot->dropped, static_cast<std::uint64_t>(kPairs));
  EXPECT_GT(snapshot->dropped, 0U);
}

TEST(Engine, RefusesAtTheDoor) {
  Engine engine(camera(), few_flies(), {}, nullptr);
  const Wall wall(10);
  engine.submit(wall.pair(), 1.0);
  EXPECT_THAT([&] { engine.submit(wall.pair(), 1.0); }, ThrowsMessage<InputError>(HasSubstr("not later than 1 s")));
  EXPECT_THAT([&] { engine.submit(wall.pair(), std::numeric_limits<double>::quiet_NaN()); },
              ThrowsMessage<InputError>(HasSubstr("time")));
  EXPECT_THAT([&] { engine.submit(wall.pair(), std::numeric_limits<double>::infinity()); },
              ThrowsMessage<InputError>(HasSubstr("time")));
  EXPECT_THROW(engine.submit({}, 2.0), InputError);
  RectifiedPair small = wall.pair();
  small.left.width_px = small.right.width_px = 200;
  EXPECT_THROW(engine.submit(small, 2.0), InputError);
  engine.submit(wall.pair(), 2.0);  // none of these did harm
  std::shared_ptr<const Snapshot> snapshot = engine.wait(0, kLong);
  if (snapshot->tracking.time_s != 2.0) snapshot = engine.wait(snapshot->number, kLong);
  EXPECT_EQ(snapshot->tracking.time_s, 2.0);
  EXPECT_EQ(snapshot->submitted, 2U);
}

TEST(Engine, EndsAtAnyMoment) {
  const Wall wall(10);
  for (int i = 0; i < 20; ++i) {
    Engine engine(camera(), few_flies(), {}, nullptr);
    for (int k = 0; k < i % 4; ++k) engine.submit(wall.pair(), 0.1 * k);
    std::this_thread::sleep_for(std::chrono::microseconds(300 * i));
  }
}

/// FLIES_SOAK_SECONDS makes it longer.
TEST(Engine, ServesManyReadersAndAFastWriter) {
  const char* asked = std::getenv("FLIES_SOAK_SECONDS");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(asked ? std::atof(asked) : 1.0);
  Engine engine(camera(), few_flies(), {}, nullptr);
  std::atomic<bool> is_over{false};
  std::atomic<int> faults{0};
  std::vector<std::thread> readers;
  for (int i = 0; i < 8; ++i)
    readers.emplace_back([&, is_stalled = i == 0] {
      std::shared_ptr<const Snapshot> last = engine.snapshot();
      while (!is_over) {
        const auto now = engine.snapshot();
        if (now->number < last->number || now->tracking.time_s < last->tracking.time_s || !now->error.empty() ||
            now->number + now->dropped > now->submitted)
          ++faults;
        last = now;
        std::this_thread::sleep_for(is_stalled ? 200ms : 1ms);
      }
    });
  const std::vector<Wall> walls = {Wall(8), Wall(10), Wall(12)};
  std::size_t pairs = 0;
  // A machine may be too busy for any result in that time: then as long as it takes for two.
  for (; std::chrono::steady_clock::now() < end || engine.snapshot()->number < 2; ++pairs) {
    engine.submit(walls[pairs % walls.size()].pair(), 0.002 * static_cast<double>(pairs));
    std::this_thread::sleep_for(2ms);
  }
  is_over = true;
  for (auto& reader : readers) reader.join();
  EXPECT_EQ(faults, 0);
  EXPECT_GT(engine.snapshot()->number, 1U);
}

}  // namespace
}  // namespace flies
