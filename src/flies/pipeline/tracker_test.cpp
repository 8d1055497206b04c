#include "flies/pipeline/tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
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

/// A backdrop of noise in the upper half, at three depths so that no turn of the camera looks like a step aside, and a
/// board 10 m ahead (20 px) shifted to the left by `shift_px`.
struct Scene {
  std::vector<std::uint8_t> left, right;

  explicit Scene(int shift_px, std::uint64_t seed = 8)
      : left(kWidth_px * kHeight_px, 120), right(kWidth_px * kHeight_px, 120) {
    const auto put = [&](int u, int v, int disparity_px, std::uint32_t layer, int texture_u) {
      const auto gray = static_cast<std::uint8_t>(
          FlyRandom(seed, layer, static_cast<std::uint32_t>(v / 4), static_cast<std::uint32_t>(texture_u / 4))
              .below(256));
      left[static_cast<std::size_t>(v * kWidth_px + u)] = gray;
      if (u >= disparity_px) right[static_cast<std::size_t>(v * kWidth_px + u - disparity_px)] = gray;
    };
    for (int v = 0; v < 76; ++v)
      for (int u = 0; u < kWidth_px; ++u) put(u, v, u < 150 ? 14 : u < 330 ? 6 : 10, 0, u);
    for (int v = 76; v < 140; ++v)
      for (int u = 220; u < 260; ++u) put(u - shift_px, v, 20, 1, u);
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

TEST(Tracker, GivesAMovingBoardItsVelocityBeforeAStandingBackdrop) {
  Tracker tracker(camera(), {}, {}, nullptr);  // none: noise may look like a person
  Tracking now;
  std::uint64_t id = 0;
  for (int i = 0; i < 12; ++i) {
    now = tracker.process(Scene(8 * i).pair(), 0.1 * i);  // 8 px at 10 m: 0.2 m in 0.1 s
    EXPECT_EQ(now.ego.is_known, i > 0);
    ASSERT_FALSE(now.tracks.empty()) << i;
    if (i == 0) id = now.tracks[0].id;
    EXPECT_EQ(now.tracks[0].id, id) << i;
  }
  EXPECT_LT(std::hypot(now.ego.vx_mps, now.ego.vy_mps), 0.2) << "the camera stands";
  EXPECT_NEAR(now.tracks[0].velocity.vy_mps, 2.0, 0.4);
  EXPECT_NEAR(now.tracks[0].velocity.vx_mps, 0.0, 0.6);
}

TEST(Tracker, CountsNoTimeTwice) {
  DetectorOptions options;
  options.threads = 1;  // one stage after the other
  Tracker tracker(camera(), options, {}, nullptr);
  for (int i = 0; i < 4; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const Tracking now = tracker.process(Scene(8 * i).pair(), 0.1 * i);
    const std::chrono::duration<double, std::milli> whole = std::chrono::steady_clock::now() - start;
    const auto& stages = now.detection.stage_ms;
    EXPECT_GT(now.ego_ms, 0.0);
    for (const double stage_ms : stages) EXPECT_GE(stage_ms, 0.0);
    EXPECT_LE(std::accumulate(stages.begin(), stages.end(), now.ego_ms + now.track_ms), whole.count());
  }
}

TEST(Tracker, ReportsNothingOfTheOldSceneAfterACut) {
  Tracker tracker(camera());
  for (int i = 0; i < 5; ++i) tracker.process(Scene(0).pair(), 0.1 * i);
  const std::vector<std::uint8_t> gray(kWidth_px * kHeight_px, 90);
  const GrayView view{gray.data(), kWidth_px, kHeight_px, kWidth_px};
  const auto after = tracker.process({view, view}, 0.5);
  EXPECT_FALSE(after.ego.is_known);
  EXPECT_TRUE(after.tracks.empty());
}

TEST(Tracker, TakesAMotionThatAnotherSensorKnows) {
  Tracker tracker(camera());
  tracker.process(Scene(0).pair(), 0.0);
  const auto now = tracker.process(Scene(0).pair(), 0.1, given_ego_motion(0.1, 3.0, 0.0, 0.0));
  EXPECT_EQ(now.ego.vx_mps, 3.0);
}

TEST(Tracker, RefusesTimeThatStandsStill) {
  Tracker tracker(camera());
  tracker.process(Scene(0).pair(), 1.0);
  EXPECT_THAT([&] { tracker.process(Scene(0).pair(), 1.0); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
}

TEST(Tracker, RefusesTimeThatStandsStillWithAKnownMotionToo) {
  Tracker tracker(camera());
  const EgoMotion known = given_ego_motion(0.1, 3.0, 0.0, 0.0);
  tracker.process(Scene(0).pair(), 1.0, known);
  EXPECT_THAT([&] { tracker.process(Scene(0).pair(), 1.0, known); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
  EXPECT_THAT([&] { tracker.process(Scene(0).pair(), 0.5); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
}

TEST(Tracker, MeasuresNoMotionOverPairsWhoseMotionWasGiven) {
  Tracker tracker(camera());
  const Scene scene(0);
  for (int i = 0; i < 2; ++i) tracker.process(scene.pair(), 0.1 * i);
  tracker.process(scene.pair(), 0.2, given_ego_motion(0.1, 3.0, 0.0, 0.0));
  EXPECT_FALSE(tracker.process(scene.pair(), 0.3).ego.is_known) << "would be since 0.1 s";
  const auto after = tracker.process(scene.pair(), 0.4);
  EXPECT_TRUE(after.ego.is_known);
  EXPECT_NEAR(after.ego.dt_s, 0.1, 1e-9);
}

/// What three pairs of the moving board become, each track as its number, place and velocity.
std::vector<std::array<double, 5>> tracks_of(Tracker& tracker) {
  std::vector<std::array<double, 5>> tracks;
  for (int i = 0; i < 3; ++i)
    for (const Track& track : tracker.process(Scene(8 * i).pair(), 0.1 * i).tracks)
      tracks.push_back({static_cast<double>(track.id), track.state.x_m, track.state.y_m, track.velocity.vx_mps,
                        track.velocity.vy_mps});
  return tracks;
}

TEST(Tracker, DoesNotDependOnTheNumberOfThreads) {
  Tracker one(camera());
  const auto expected = tracks_of(one);
  ASSERT_FALSE(expected.empty());
  for (const int threads : {2, 4}) {
    DetectorOptions options;
    options.threads = threads;
    Tracker several(camera(), options);
    EXPECT_EQ(tracks_of(several), expected) << threads;
  }
}

TEST(Tracker, MeasuresTheMotionEvenIfNobodyAsksForIt) {
  DetectorOptions blind;
  blind.scan.enable = false;
  Tracker tracker(camera(), blind, {}, nullptr);
  tracker.process(Scene(0).pair(), 0.0);
  EXPECT_TRUE(tracker.process(Scene(0).pair(), 0.1).ego.is_known);
}

TEST(Tracker, APairThatIsRefusedChangesNothing) {
  Tracker refused(camera()), undisturbed(camera());
  const Scene scene(0), later(30);
  for (Tracker* tracker : {&refused, &undisturbed}) tracker->process(scene.pair(), 0.0);
  EXPECT_THROW(refused.process(later.pair(), 0.0), InputError) << "time stands still";
  EXPECT_THROW(refused.process({later.pair().left, later.pair().left}, 0.1), InputError) << "one image twice";
  const auto after = refused.process(Scene(8).pair(), 0.1), expected = undisturbed.process(Scene(8).pair(), 0.1);
  EXPECT_EQ(after.ego.dt_s, expected.ego.dt_s);
  EXPECT_EQ(after.ego.followed, expected.ego.followed);
  EXPECT_EQ(after.ego.vx_mps, expected.ego.vx_mps);
  EXPECT_EQ(after.detection.evolved.flies.x_m, expected.detection.evolved.flies.x_m);
}

TEST(Tracker, WhatTheDetectorRemembersMovesOnOverRefusedPairs) {
  const Scene scene(0), later(8);
  const auto moved_for = [](double dt_s) { return given_ego_motion(dt_s, 20.0, 0.0, 0.5); };
  Tracker refused(camera()), undisturbed(camera());
  for (Tracker* tracker : {&refused, &undisturbed}) tracker->process(scene.pair(), 0.0, moved_for(0.1));
  EXPECT_THROW(refused.process({later.pair().left, later.pair().left}, 0.1, moved_for(0.1)), InputError);
  EXPECT_THROW(refused.process({}, 0.2, moved_for(0.1)), InputError);
  const auto after = refused.process(later.pair(), 0.3, moved_for(0.1)).detection;
  EgoMotion at_once = moved_for(0.3);
  const RigidMotion step = moved_for(0.1).current_from_previous;
  at_once.current_from_previous.shift = step(step(step({0, 0, 0})));
  const auto expected = undisturbed.process(later.pair(), 0.3, at_once).detection;
  ASSERT_EQ(after.scan.size(), expected.scan.size());
  for (std::size_t i = 0; i < expected.scan.size(); ++i) {
    EXPECT_EQ(after.scan.states[i], expected.scan.states[i]) << i;
    EXPECT_NEAR(after.scan.confidence[i], expected.scan.confidence[i], 1e-6) << i;
  }
}

TEST(Tracker, ARefusedPairWhoseMotionIsUnknownEndsAllTracks) {
  const Scene scene(0);
  Tracker tracker(camera(), {}, {}, nullptr);
  const EgoMotion standing = given_ego_motion(0.1, 0.0, 0.0, 0.0);
  const auto first = tracker.process(scene.pair(), 0.0, standing);
  ASSERT_FALSE(first.tracks.empty());
  EXPECT_THROW(tracker.process({}, 0.1, EgoMotion{}), InputError);
  const auto after = tracker.process(scene.pair(), 0.2, standing);
  ASSERT_FALSE(after.tracks.empty());
  EXPECT_GT(after.tracks[0].id, first.tracks.size()) << "nothing says where the camera is";
}

std::string complaint(Tracker& tracker, double time_s, const EgoMotion& measured) {
  try {
    tracker.process(Scene(0).pair(), time_s, measured);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Tracker, RefusesAMotionThatIsNone) {
  const EgoMotion standing = given_ego_motion(0.1, 0.0, 0.0, 0.0);
  Tracker tracker(camera(), {}, {}, nullptr);
  const auto first = tracker.process(Scene(0).pair(), 0.0, standing);
  ASSERT_FALSE(first.tracks.empty());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kEndless = std::numeric_limits<double>::infinity();
  EgoMotion wrong = standing;
  wrong.vx_mps = kNan;
  EXPECT_THAT(complaint(tracker, 0.1, wrong), HasSubstr("measured motion: vx_mps: found nan, expected -400 to 400"));
  wrong = standing;
  wrong.dt_s = kEndless;
  EXPECT_THAT(complaint(tracker, 0.1, wrong), HasSubstr("measured motion: dt_s: found inf"));
  wrong = standing;
  wrong.current_from_previous.shift.x_m = kNan;
  EXPECT_THAT(complaint(tracker, 0.1, wrong), HasSubstr("measured motion: current_from_previous.shift"));
  EXPECT_THAT(complaint(tracker, 0.1, given_ego_motion(100.0, 0.0, 0.0, 0.0)),
              HasSubstr("measured motion: dt_s: found 100 s, but the pair before was 0.1 s earlier"));
  EXPECT_THAT(complaint(tracker, 0.1, given_ego_motion(0.2, 0.0, 0.0, 0.0)), HasSubstr("found 0.2 s"));
  const auto again = tracker.process(Scene(0).pair(), 0.1, given_ego_motion(0.09, 0.0, 0.0, 0.0));
  EXPECT_EQ(again.tracks.at(0).id, first.tracks[0].id) << "a refused motion changes nothing";
}

TEST(Tracker, AMotionSinceAPairThatWasRefusedWithItsOwnIsNotEnough) {
  const EgoMotion standing = given_ego_motion(0.1, 0.0, 0.0, 0.0);
  Tracker tracker(camera(), {}, {}, nullptr);
  const auto first = tracker.process(Scene(0).pair(), 0.0, standing);
  EgoMotion wrong = standing;
  wrong.yaw_rate_rps = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint(tracker, 0.1, wrong), HasSubstr("yaw_rate_rps"));
  const auto next = tracker.process(Scene(0).pair(), 0.2, standing);
  EXPECT_FALSE(next.ego.is_known);
  EXPECT_NEAR(next.ego.dt_s, 0.2, 1e-12);
  EXPECT_GT(next.tracks.at(0).id, first.tracks.size());
  EXPECT_TRUE(tracker.process(Scene(0).pair(), 0.3, standing).ego.is_known);
}

TEST(Tracker, GivesNumbersHoweverShortTheStep) {
  Tracker tracker(camera(), {}, {}, nullptr);
  tracker.process(Scene(0).pair(), 0.0);
  EXPECT_THROW(tracker.process(Scene(0).pair(), 1e-300), InputError);
  for (const double time_s : {1e-8, 2e-8, 3e-8, 0.1}) {
    const auto now = tracker.process(Scene(0).pair(), time_s);
    EXPECT_FALSE(now.tracks.empty());
    for (const Track& track : now.tracks) {
      EXPECT_TRUE(std::isfinite(track.state.x_m) && std::isfinite(track.state.vx_mps) &&
                  std::isfinite(track.velocity.vx_mps))
          << time_s;
      for (const auto& row : track.state.covariance)
        for (const double entry : row) EXPECT_TRUE(std::isfinite(entry)) << time_s;
    }
  }
}

TEST(Tracker, SaysThatItWasMovedFrom) {
  Tracker tracker(camera(), {}, {}, nullptr);
  tracker.process(Scene(0).pair(), 0.0);
  Tracker other = std::move(tracker);
  EXPECT_TRUE(other.process(Scene(0).pair(), 0.1).ego.is_known);
  EXPECT_THAT([&] { tracker.process(Scene(0).pair(), 0.1); },  // NOLINT(bugprone-use-after-move)
              ThrowsMessage<std::logic_error>(HasSubstr("moved from")));
  tracker = Tracker(camera(), {}, {}, nullptr);
  EXPECT_FALSE(tracker.process(Scene(0).pair(), 0.0).tracks.empty());
}

}  // namespace
}  // namespace flies
