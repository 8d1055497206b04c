#include "flies/pipeline/detector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 480, kHeight_px = 200;

StereoCamera camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 240,
          .cx_right_px = 240,
          .cy_px = 80,
          .baseline_m = 0.5,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.5}};
}

/// A board of noise, 1 m wide and 1.6 m tall, 10 m ahead on a uniform ground; disparity 20 px.
struct Board {
  std::vector<std::uint8_t> left, right;

  Board() : left(kWidth_px * kHeight_px, 120), right(kWidth_px * kHeight_px, 120) {
    for (int v = 76; v < 140; ++v)
      for (int u = 220; u < 260; ++u) {
        const auto gray = static_cast<std::uint8_t>(
            FlyRandom(8, 0, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(u)).below(256));
        left[static_cast<std::size_t>(v * kWidth_px + u)] = gray;
        right[static_cast<std::size_t>(v * kWidth_px + u - 20)] = gray;
      }
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

TEST(Detector, FindsABoardAhead) {
  for (const auto preset : {Preset::standard, Preset::paper}) {
    const auto found = Detector(camera(), preset_options(preset)).process(Board().pair());
    ASSERT_FALSE(found.obstacles.empty()) << enum_name(preset);
    for (const auto& obstacle : found.obstacles) {
      EXPECT_NEAR(obstacle.range_m, 10.0, 0.05 * 10.0) << enum_name(preset);
      EXPECT_NEAR(obstacle.y_m, 0.0, 0.7) << enum_name(preset);
    }
    EXPECT_EQ(found.obstacles.size(), found.concentrate.obstacles.size());
    EXPECT_EQ(found.roi_scores.size(), found.rois.size());
  }
}

TEST(Detector, ReportsOneObstacleWithItsSizeByDefault) {
  const auto found = Detector(camera()).process(Board().pair());
  ASSERT_EQ(found.obstacles.size(), 1U);
  EXPECT_NEAR(found.obstacles[0].width_m, 1.0, 0.25);
  EXPECT_NEAR(found.obstacles[0].height_m, 1.6, 0.25);
}

TEST(Detector, SaysThatItWasMovedFrom) {
  Detector detector(camera(), {}, nullptr);
  Detector other = std::move(detector);
  EXPECT_FALSE(other.process(Board().pair()).obstacles.empty());
  EXPECT_THAT([&] { detector.process(Board().pair()); },  // NOLINT(bugprone-use-after-move)
              ThrowsMessage<std::logic_error>(HasSubstr("moved from")));
  EXPECT_THAT([&] { detector.find(Board().pair()); }, ThrowsMessage<std::logic_error>(HasSubstr("moved from")));
  detector = other;
  EXPECT_FALSE(detector.process(Board().pair()).obstacles.empty());
}

TEST(Detector, FindsNothingInAUniformPair) {
  const std::vector<std::uint8_t> gray(kWidth_px * kHeight_px, 90);
  const GrayView view{gray.data(), kWidth_px, kHeight_px, kWidth_px};
  const auto found = Detector(camera()).process({view, view});
  EXPECT_TRUE(found.obstacles.empty());
  EXPECT_TRUE(found.pedestrians.empty());
}

TEST(Detector, DoesNotDependOnTheNumberOfThreads) {
  const Board board;
  const auto with_threads = [&](int threads) {
    DetectorOptions options;
    options.threads = threads;
    return Detector(camera(), options).process(board.pair());
  };
  const auto one = with_threads(1);
  ASSERT_FALSE(one.obstacles.empty() || one.roi_scores.empty());
  for (const int threads : {2, 4}) {
    const auto several = with_threads(threads);
    EXPECT_EQ(several.evolved.flies.x_m, one.evolved.flies.x_m) << threads;
    EXPECT_EQ(several.roi_scores, one.roi_scores) << threads;
    ASSERT_EQ(several.obstacles.size(), one.obstacles.size()) << threads;
    for (std::size_t i = 0; i < one.obstacles.size(); ++i)
      EXPECT_EQ(several.obstacles[i].x_m, one.obstacles[i].x_m) << threads;
  }
}

TEST(Detector, ReadsRowsWithAStride) {
  const Board board;
  constexpr int kStride = kWidth_px + 24;
  std::vector<std::uint8_t> left(kStride * kHeight_px, 255), right(kStride * kHeight_px, 0);
  for (int v = 0; v < kHeight_px; ++v) {
    std::copy_n(board.left.begin() + v * kWidth_px, kWidth_px, left.begin() + v * kStride);
    std::copy_n(board.right.begin() + v * kWidth_px, kWidth_px, right.begin() + v * kStride);
  }
  const auto padded = Detector(camera()).process(
      {{left.data(), kWidth_px, kHeight_px, kStride}, {right.data(), kWidth_px, kHeight_px, kStride}});
  const auto dense = Detector(camera()).process(board.pair());
  EXPECT_EQ(padded.evolved.flies.fitness, dense.evolved.flies.fitness);
  EXPECT_EQ(padded.roi_scores, dense.roi_scores);
}

TEST(Detector, TakesViewsWithoutAStrideAsPacked) {
  const Board board;
  auto pair = board.pair();
  pair.left.stride = pair.right.stride = 0;
  const auto packed = Detector(camera()).process(pair), told = Detector(camera()).process(board.pair());
  EXPECT_EQ(packed.evolved.flies.fitness, told.evolved.flies.fitness);
  EXPECT_EQ(packed.obstacles.size(), told.obstacles.size());
}

TEST(Detector, RefusesSwappedImagesAndOneTwice) {
  Board wall;  // of squares of 6 x 6 px that fills both images
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) {
      const auto gray = [v](int column) {
        return static_cast<std::uint8_t>(
            FlyRandom(8, 0, static_cast<std::uint32_t>(v / 6), static_cast<std::uint32_t>(column / 6)).below(256));
      };
      wall.left[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u);
      wall.right[static_cast<std::size_t>(v * kWidth_px + u)] = gray(u + 20);
    }
  const auto pair = wall.pair();
  Detector detector(camera());
  const auto process_swapped = [&] { detector.process({pair.right, pair.left}); };
  EXPECT_THAT(process_swapped, ThrowsMessage<InputError>(HasSubstr("swapped")));
  constexpr int kAskedEvery = 32;
  for (int i = 0; i < kAskedEvery; ++i) EXPECT_NO_THROW(detector.process(pair));
  for (int i = 0; i < 3; ++i) EXPECT_THAT(process_swapped, ThrowsMessage<InputError>(HasSubstr("swapped")));
  EXPECT_NO_THROW(detector.process(pair));
  EXPECT_THAT([&] { detector.process({pair.left, pair.left}); }, ThrowsMessage<InputError>(HasSubstr("identical")));
}

TEST(Detector, RefusesCamerasInOtherUnits) {
  const auto fault = [](double focal_px, double baseline_m) {
    auto other = camera();
    other.fx_px = other.fy_px = focal_px;
    other.baseline_m = baseline_m;
    try {
      Detector{other};
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const double focal_px = camera().fx_px;
  EXPECT_THAT(fault(focal_px, 120.0), HasSubstr("is it in millimetres (0.12 m)"));
  EXPECT_THAT(fault(focal_px, 0.00012), HasSubstr("wants millimetres (0.12 m)"));
  EXPECT_THAT(fault(4.2, 0.12), HasSubstr("is it in millimetres"));
}

TEST(Detector, RefusesWhatItCannotUse) {
  const Board board;
  auto crooked = camera();
  crooked.baseline_m = -1.0;
  EXPECT_THAT([&] { Detector{crooked}; }, ThrowsMessage<InputError>(HasSubstr("baseline_m")));

  DetectorOptions options;
  options.fitness.half_width_px = 99;
  EXPECT_THAT([&] { Detector(camera(), options); }, ThrowsMessage<InputError>(HasSubstr("fitness.half_width_px")));
  options = {};
  options.field.x_max_m = 2.0;
  EXPECT_THAT([&] { Detector(camera(), options); }, ThrowsMessage<InputError>(HasSubstr("field.x_min_m")));

  Detector detector(camera());
  EXPECT_THAT([&] { detector.process({}); }, ThrowsMessage<InputError>(HasSubstr("left image")));
  auto other_size = camera();
  other_size.width_px = 640;
  EXPECT_THAT([&] { Detector(other_size).process(board.pair()); }, ThrowsMessage<InputError>(HasSubstr("640 x 200")));
}

TEST(Detector, LooksForNobodyWithoutAClassifier) {
  const Board board;
  const auto found = Detector(camera(), {}, nullptr).process(board.pair());
  EXPECT_FALSE(found.obstacles.empty());
  EXPECT_TRUE(found.pedestrians.empty());
  ASSERT_FALSE(found.rois.empty());
  EXPECT_EQ(found.roi_scores, std::vector<double>(found.rois.size(), 0.0));
}

TEST(Detector, WorksBesideOthersAndPairAfterPair) {
  const Board board;
  const auto process_two = [&] {
    Detector detector(camera());
    detector.process(board.pair());
    return detector.process(board.pair());
  };
  const Detection alone = process_two();
  std::vector<Detection> side_by_side(4);
  {
    std::vector<std::jthread> threads;
    for (auto& found : side_by_side) threads.emplace_back([&] { found = process_two(); });
  }
  EXPECT_NE(alone.evolved.flies.x_m, Detector(camera()).process(board.pair()).evolved.flies.x_m);
  for (const auto& found : side_by_side) {
    EXPECT_EQ(found.evolved.flies.x_m, alone.evolved.flies.x_m);
    EXPECT_EQ(found.roi_scores, alone.roi_scores);
  }
}

TEST(DetectorDeathTest, AUseDuringAnotherIsAFaultOfTheProgram) {
#ifdef NDEBUG
  GTEST_SKIP() << "this build has no assertions, which alone tell it";
#else
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // the detector has worker threads
  const Board board;
  Detector detector(camera());
  const MotionSource during = [&] {
    detector.reset();
    return std::optional<PlanarMotion>();
  };
  EXPECT_DEATH(detector.process(board.pair(), during), "must not be used from two threads at once");
#endif
}

TEST(Detector, MayBeUsedAgainAfterAPairThatItRefused) {
  const Board board;
  Detector detector(camera());
  EXPECT_THROW(detector.process({}), InputError);
  EXPECT_FALSE(detector.process(board.pair()).obstacles.empty());
}

TEST(Detector, StartsAnewAfterAReset) {
  const Board board;
  Detector detector(camera());
  const Detection first = detector.process(board.pair());
  EXPECT_NE(detector.process(board.pair()).evolved.flies.x_m, first.evolved.flies.x_m);
  detector.reset();
  const Detection again = detector.process(board.pair());
  EXPECT_EQ(again.evolved.flies.x_m, first.evolved.flies.x_m);
  EXPECT_EQ(again.scan.confidence, first.scan.confidence);
}

TEST(Detector, FindsTheSameWithoutIntermediateResults) {
  const Board board;
  const DetectionSummary light = Detector(camera()).find(board.pair());
  const Detection whole = Detector(camera()).process(board.pair());
  ASSERT_FALSE(light.obstacles.empty());
  ASSERT_EQ(light.obstacles.size(), whole.obstacles.size());
  EXPECT_EQ(light.obstacles[0].x_m, whole.obstacles[0].x_m);
  EXPECT_EQ(light.pedestrians.size(), whole.pedestrians.size());
  EXPECT_EQ(light.scan.confidence, whole.scan.confidence);
}

/// Answers what it is told to.
class Answering final : public PeopleClassifier {
 public:
  explicit Answering(std::vector<double> answer) : answer_(std::move(answer)) {}
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox>) const override { return answer_; }

 private:
  std::string name_ = "answering";
  std::vector<double> answer_;
};

TEST(Detector, RefusesAClassifierThatDoesNotAnswerForEveryWindow) {
  const Board board;
  const auto process_with = [&](std::vector<double> answer) {
    Detector(camera(), {}, std::make_shared<Answering>(std::move(answer))).process(board.pair());
  };
  const std::size_t windows = Detector(camera(), {}, nullptr).process(board.pair()).rois.size();
  EXPECT_NO_THROW(process_with(std::vector<double>(windows, 0.1)));
  EXPECT_THAT([&] { process_with({0.9}); }, ThrowsMessage<InputError>(HasSubstr("answering: probabilities: found 1")));
  EXPECT_THAT([&] { process_with(std::vector<double>(windows, std::nan(""))); },
              ThrowsMessage<InputError>(HasSubstr("answering: probability: found nan")));
}

/// Sees a person in every window.
class Credulous final : public PeopleClassifier {
 public:
  const std::string& name() const override { return name_; }
  double threshold() const override { return 0.5; }
  std::vector<double> classify(const GrayView&, std::span<const ImageBox> windows) const override {
    return std::vector<double>(windows.size(), 0.999);
  }

 private:
  std::string name_ = "credulous";
};

TEST(Detector, LooksWhereSomebodyWasInThePairBeforeWhenTheMotionIsKnown) {
  const Board board;
  const std::vector<std::uint8_t> gray(kWidth_px * kHeight_px, 90);
  const GrayView nothing{gray.data(), kWidth_px, kHeight_px, kWidth_px};
  Detector seen(camera(), {}, std::make_shared<Credulous>());
  const auto first = seen.process(board.pair());
  ASSERT_FALSE(first.pedestrians.empty());
  Detector blind = seen, restarted = seen;
  restarted.reset();

  constexpr PlanarMotion kForward{.forward_m = 1.0};
  const auto next = seen.process({nothing, nothing}, kForward);
  EXPECT_TRUE(next.concentrate.obstacles.empty());
  ASSERT_FALSE(next.rois.empty());
  ASSERT_FALSE(next.pedestrians.empty());
  EXPECT_NEAR(next.pedestrians[0].x_m, first.pedestrians[0].x_m - 1.0, 0.5);
  EXPECT_NEAR(next.pedestrians[0].y_m, first.pedestrians[0].y_m, 0.5);

  EXPECT_TRUE(blind.process({nothing, nothing}).rois.empty());
  EXPECT_TRUE(restarted.process({nothing, nothing}, kForward).rois.empty());
}

/// Soft texture all over, farther away than is reported: it matches 1 px beside its place nearly as well.
TEST(Detector, ReportsNothingAtTheFarEndOfWhatStandsBeyond) {
  constexpr int kShift_px = 1, kSoft_px = 8;
  std::vector<std::uint8_t> left(kWidth_px * kHeight_px), right(left);
  const auto level = [](int u, int v) {
    unsigned sum = 0;
    for (int i = 0; i < kSoft_px; ++i)
      sum += FlyRandom(8, 0, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(u + i)).below(256);
    return static_cast<std::uint8_t>(std::min(255U, sum / kSoft_px));
  };
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) {
      left[static_cast<std::size_t>(v * kWidth_px + u)] = level(u, v);
      right[static_cast<std::size_t>(v * kWidth_px + u)] = level(u + kShift_px, v);
    }
  StereoCamera short_baseline = camera();
  short_baseline.baseline_m = 0.05;  // 20 px m: 20 m away
  DetectorOptions options;
  options.field.x_max_m = 8.0;
  Detector detector(short_baseline, options, nullptr);
  const auto found = detector.process(
      {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}});
  EXPECT_TRUE(found.obstacles.empty());
  EXPECT_TRUE(found.concentrate.obstacles.empty());
}

TEST(Detector, GivesRangesTheirDeviation) {
  const auto found = Detector(camera()).process(Board().pair());
  ASSERT_FALSE(found.obstacles.empty());
  EXPECT_DOUBLE_EQ(found.obstacles[0].range_sd_m, range_deviation_m(camera(), found.obstacles[0].range_m));
  EXPECT_GT(found.obstacles[0].range_sd_m, 0.0);
}

}  // namespace
}  // namespace flies
