#include "flies/eval/track_measures.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace flies {
namespace {

/// A car 20 m ahead that drives off at 5 m/s before a camera that follows at 3 m/s; its track is one metre short of its
/// middle, and says 4 m/s.
std::vector<TrackedTruth> sequence(int frames) {
  std::vector<TrackedTruth> all;
  for (int i = 0; i < frames; ++i) {
    TrackedTruth frame;
    frame.true_ego = i == 0 ? EgoMotion{} : given_ego_motion(0.1, 3.0, 0.0, 0.0);
    LabelledObject car;
    car.track = 7;
    car.footprint = {20 + 0.2 * i, 0, 0, 4.0, 1.8};
    frame.truth.objects = {car};
    Track track;
    track.id = 3;
    track.state.x_m = 19 + 0.2 * i;
    track.velocity.vx_mps = 4.0;
    track.age_s = 0.1 * i;
    for (std::size_t k = 0; k < 4; ++k) track.state.covariance[k][k] = 0.25;
    track.state.vx_mps = 4.0;
    frame.tracks = {track};
    frame.time_s = 0.1 * i;
    all.push_back(frame);
  }
  return all;
}

TEST(MeasureTracks, TakesTheVelocityOverGround) {
  const auto m = measure_tracks(sequence(12));
  EXPECT_EQ(m.objects, 12);
  EXPECT_EQ(m.found, 12);
  EXPECT_EQ(m.identity_switches, 0);
  ASSERT_EQ(m.moving_errors_mps.size(), 6U);  // from 0.5 s on, the last has no pair after it
  for (const double error : m.moving_errors_mps) EXPECT_NEAR(error, 1.0, 1e-9);
  EXPECT_TRUE(m.standing_errors_mps.empty());
}

TEST(MeasureTracks, CountsSwitchesAndFragments) {
  auto frames = sequence(12);
  frames[4].tracks.clear();
  for (std::size_t i = 8; i < 12; ++i) frames[i].tracks[0].id = 9;
  const auto m = measure_tracks(frames);
  EXPECT_EQ(m.found, 11);
  EXPECT_EQ(m.identity_switches, 1);
  EXPECT_EQ(m.fragments, 1);
}

TEST(MeasureTracks, CountsFalseMotionOfWhatStands) {
  auto frames = sequence(12);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].truth.objects[0].footprint.x_m = 30 - 0.3 * static_cast<double>(i);
    frames[i].tracks[0].state.x_m = 29 - 0.3 * static_cast<double>(i);
  }
  const auto m = measure_tracks(frames);
  EXPECT_EQ(m.standing, 6);
  EXPECT_EQ(m.false_motion, 6);
}

TEST(MeasureTracks, TellsWhenAThingHasItsFirstTrackAndVelocity) {
  auto frames = sequence(12);
  for (std::size_t i = 0; i < 3; ++i) frames[i].tracks.clear();
  for (std::size_t i = 3; i < 12; ++i) frames[i].tracks[0].velocity.vx_mps = i < 7 ? 3.5 : 4.5;  // it is 5 m/s
  const auto m = measure_tracks(frames);
  ASSERT_EQ(m.first_report_s.size(), 1U);
  EXPECT_NEAR(m.first_report_s[0], 0.3, 1e-9);
  ASSERT_EQ(m.first_velocity_s.size(), 1U);
  EXPECT_NEAR(m.first_velocity_s[0], 0.7, 1e-9);
  EXPECT_EQ(m.never_reported, 0);
  for (auto& frame : frames) frame.tracks.clear();
  const auto nothing = measure_tracks(frames);
  EXPECT_TRUE(nothing.first_report_s.empty());
  EXPECT_EQ(nothing.never_reported, 1);
  EXPECT_EQ(nothing.never_with_velocity, 1);
}

// The near face is at 18 m + 0.2 i, the track 1 m behind it; the velocity is 1 m/s too low; the variances are 0.25.
TEST(MeasureTracks, NormalisesErrorsByTheirCovariances) {
  const auto m = measure_tracks(sequence(12));
  ASSERT_EQ(m.position_nees.size(), 7U);  // settled from 0.5 s on
  for (const double nees : m.position_nees) EXPECT_NEAR(nees, 4.0, 1e-9);
  ASSERT_EQ(m.velocity_nees.size(), 6U);
  for (const double nees : m.velocity_nees) EXPECT_NEAR(nees, 4.0, 1e-9);
}

TEST(MeasureTracks, DoesNotAskForWhatCannotBeSeen) {
  auto frames = sequence(12);
  for (auto& frame : frames) frame.truth.objects[0].visible = false;
  EXPECT_EQ(measure_tracks(frames).objects, 0);
}

}  // namespace
}  // namespace flies
