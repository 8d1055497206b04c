#include "flies/track/tracks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDt_s = 0.1;

StereoCamera camera() {
  return {.fx_px = 720,
          .fy_px = 720,
          .cx_px = 620,
          .cx_right_px = 620,
          .cy_px = 180,
          .baseline_m = 0.54,
          .width_px = 1242,
          .height_px = 375,
          .mount = {.height_m = 1.65}};
}

Sighting at(double x_m, double y_m, double width_m = 0.6) { return {x_m, y_m, width_m, 1.7, {}, std::nullopt}; }
EgoMotion standing() { return given_ego_motion(kDt_s, 0.0, 0.0, 0.0); }

TEST(Predict, KeepsStandingThingsStandingWhileTheCameraTurns) {
  GroundState state{.x_m = 10, .y_m = 2};
  for (int i = 0; i < 10; ++i) state = predict(state, given_ego_motion(kDt_s, 5.0, 0.0, 0.3), 1.0);
  EXPECT_EQ(state.vx_mps, 0.0);
  // An arc of 5 m with 0.3 rad: the way of the origin, then the turn.
  const double radius = 5.0 / 0.3, dx = 10 - radius * std::sin(0.3), dy = 2 - radius * (1 - std::cos(0.3));
  EXPECT_NEAR(state.x_m, std::cos(0.3) * dx + std::sin(0.3) * dy, 0.01);
  EXPECT_NEAR(state.y_m, -std::sin(0.3) * dx + std::cos(0.3) * dy, 0.01);
}

TEST(Predict, TakesOverWhatIsNotKnownOfTheCamera) {
  const GroundState state{.x_m = 10, .y_m = 0};
  const auto sure = predict(state, given_ego_motion(kDt_s, 5, 0, 0), 0.01);
  const auto unsure = predict(state, given_ego_motion(kDt_s, 5, 0, 0, {2.0, 0.0, 0.5}), 0.01);
  EXPECT_NEAR(unsure.covariance[0][0] - sure.covariance[0][0], 0.2 * 0.2, 1e-9);      // 2 m/s for 0.1 s
  EXPECT_NEAR(unsure.covariance[1][1] - sure.covariance[1][1], 0.475 * 0.475, 1e-9);  // 0.05 rad at 9.5 m
}

// Simulated as the filter assumes: the normalised squared error of four numbers is 4 on average.
TEST(Kalman, ItsCovarianceHasTheSizeOfItsErrors) {
  constexpr int kTrials = 300, kSteps = 15;
  const Covariance2 noise = {{{0.09, 0.0}, {0.0, 0.01}}};
  double distance = 0.0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    FlyRandom random(4, 0, trial, 0);
    GroundState truth{.x_m = 15, .y_m = 0, .vx_mps = 5 * random.normal(), .vy_mps = 5 * random.normal()};
    GroundState state;
    for (int step = 0; step < kSteps; ++step) {
      const GroundPosition measured{truth.x_m + 0.3 * random.normal(), truth.y_m + 0.1 * random.normal(), noise};
      if (step == 0) {
        state = {.x_m = measured.x_m, .y_m = measured.y_m};
        state.covariance[0][0] = 0.09;
        state.covariance[1][1] = 0.01;
        state.covariance[2][2] = state.covariance[3][3] = 25.0;
      } else {
        state = update(state, measured);
      }
      if (step + 1 == kSteps) break;
      const double ax = random.normal(), ay = random.normal();
      truth.x_m += truth.vx_mps * kDt_s + 0.5 * ax * kDt_s * kDt_s;
      truth.y_m += truth.vy_mps * kDt_s + 0.5 * ay * kDt_s * kDt_s;
      truth.vx_mps += ax * kDt_s;
      truth.vy_mps += ay * kDt_s;
      state = predict(state, standing(), 1.0);
    }
    // x and y are independent here: two blocks of two.
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto& p = state.covariance;
      const double e = axis == 0 ? state.x_m - truth.x_m : state.y_m - truth.y_m;
      const double ev = axis == 0 ? state.vx_mps - truth.vx_mps : state.vy_mps - truth.vy_mps;
      const double a = p[axis][axis], b = p[axis][axis + 2], c = p[axis + 2][axis + 2];
      distance += (c * e * e - 2 * b * e * ev + a * ev * ev) / (a * c - b * b);
    }
  }
  EXPECT_NEAR(distance / kTrials, 4.0, 0.6);  // standard error sqrt(8/300) = 0.16
}

TEST(LikelyVelocity, TellsNoiseFromMotion) {
  GroundState state{.x_m = 10, .y_m = 0, .vx_mps = 1.0, .vy_mps = 0.0};
  state.covariance[2][2] = state.covariance[3][3] = 1.0;
  const auto noise = likely_velocity(state, 0.15, 5.0);
  EXPECT_LT(noise.moving_probability, 0.1);
  EXPECT_LT(noise.vx_mps, 0.1);
  state.covariance[2][2] = state.covariance[3][3] = 0.02;
  const auto motion = likely_velocity(state, 0.15, 5.0);
  EXPECT_GT(motion.moving_probability, 0.99);
  EXPECT_NEAR(motion.vx_mps, 1.0, 0.01);
}

TEST(SightingsOf, JoinsAPersonWithHisObstacle) {
  std::vector<Obstacle> obstacles(2);
  obstacles[0].x_m = obstacles[1].x_m = 10;
  obstacles[1].y_m = 3;
  std::vector<Pedestrian> people(2);
  people[0].x_m = 10.3;
  people[0].y_m = 3.1;
  people[0].probability = 0.9;
  people[1].x_m = 20;
  people[1].probability = 0.8;
  const auto sightings = sightings_of(obstacles, people);
  ASSERT_EQ(sightings.size(), 3U);
  EXPECT_FALSE(sightings[0].person_probability);
  EXPECT_EQ(sightings[1].person_probability, 0.9);
  EXPECT_EQ(sightings[2].x_m, 20);
}

TEST(TrackKeeper, FollowsAWalkerAcrossAndKnowsHisVelocity) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 15; ++i) {
    FlyRandom random(2, 0, 0, static_cast<std::uint32_t>(i));
    auto person = at(10 + 0.05 * random.normal(), -2 + 1.5 * kDt_s * i + 0.05 * random.normal());
    person.person_probability = 0.9;
    tracks = keeper.step(standing(), std::vector<Sighting>{person, at(20, 5)});
    ASSERT_EQ(tracks.size(), 2U) << i;
    EXPECT_EQ(tracks[0].id, 1U);
  }
  EXPECT_NEAR(tracks[0].velocity.vy_mps, 1.5, 0.3);
  EXPECT_NEAR(tracks[0].velocity.vx_mps, 0.0, 0.4);
  EXPECT_EQ(tracks[0].kind, TrackClass::person);
  EXPECT_EQ(tracks[1].kind, TrackClass::other);
  EXPECT_LT(std::hypot(tracks[1].velocity.vx_mps, tracks[1].velocity.vy_mps), 0.1);
  EXPECT_NEAR(tracks[0].age_s, 1.4, 1e-9);
}

TEST(TrackKeeper, ReportsInAllOfFivePairsWhatIsSeenInThree) {
  for (const auto& seen : {std::vector<int>{1, 1, 0, 0, 1}, std::vector<int>{1, 0, 1, 0, 1},
                           std::vector<int>{1, 1, 0, 1, 0}, std::vector<int>{1, 1, 1, 0, 0}}) {
    TrackKeeper keeper(camera());
    for (const int is_seen : seen) {
      const auto tracks = keeper.step(standing(), is_seen ? std::vector{at(10, 0)} : std::vector<Sighting>{});
      ASSERT_EQ(tracks.size(), 1U);
      EXPECT_EQ(tracks[0].id, 1U);
    }
  }
}

TEST(TrackKeeper, ForgetsWithinThreePairsWhatIsGone) {
  TrackKeeper keeper(camera());
  for (int i = 0; i < 30; ++i) keeper.step(standing(), std::vector{at(10, 0)});
  keeper.step(standing(), {});
  keeper.step(standing(), {});
  EXPECT_TRUE(keeper.step(standing(), {}).empty());
}

TEST(TrackKeeper, CoastsBehindSomethingNearerAndComesBackWithItsIdentity) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 30; ++i) {
    const double y_m = -3 + 2.0 * kDt_s * i;  // behind a car 8 m ahead for 10 pairs
    std::vector<Sighting> sightings = {at(8, 0, 1.6)};
    if (std::abs(y_m) >= 1.0) sightings.push_back(at(12, y_m));
    tracks = keeper.step(standing(), sightings);
    ASSERT_EQ(tracks.size(), 2U) << i;
    EXPECT_EQ(tracks[1].id, 2U) << i;
  }
}

EgoMotion standing_for(double dt_s) { return given_ego_motion(dt_s, 0.0, 0.0, 0.0); }

std::vector<std::uint64_t> ids_of(const std::vector<Track>& tracks) {
  std::vector<std::uint64_t> ids;
  for (const auto& track : tracks) ids.push_back(track.id);
  return ids;
}

TEST(TrackKeeper, GoesOnWithWhatStandsWhereItStoodHoweverLongTheStep) {
  TrackKeeper keeper(camera());
  const std::vector<Sighting> things = {at(8, -1), at(8.2, 1), at(15, 3), at(30, -6)};
  const auto first = ids_of(keeper.step(standing(), things));
  for (const double dt_s : {2.1, 5.0, 60.0, 0.1, 2.5, 3600.0})
    EXPECT_EQ(ids_of(keeper.step(standing_for(dt_s), things)), first) << dt_s;
}

TEST(TrackKeeper, KeepsIdentitiesWhenTheCameraDrivesThroughALongStep) {
  TrackKeeper keeper(camera());
  std::vector<Sighting> things = {at(40, -3), at(50, 2)};
  const auto first = ids_of(keeper.step(standing(), things));
  for (auto& thing : things) thing.x_m -= 20.0;
  EXPECT_EQ(ids_of(keeper.step(given_ego_motion(2.5, 8.0, 0.0, 0.0), things)), first);
}

TEST(TrackKeeper, GoesOnWithWhatIsKnownToMoveAfterALongStep) {
  TrackKeeper keeper(camera());
  for (int i = 0; i < 20; ++i) keeper.step(standing(), std::vector{at(15, -4 + 2.0 * kDt_s * i)});
  const double then_y_m = -4 + 2.0 * kDt_s * 19;
  EXPECT_EQ(ids_of(keeper.step(standing_for(2.2), std::vector{at(15, then_y_m + 4.4)})),
            (std::vector<std::uint64_t>{1}));
}

TEST(TrackKeeper, TakesNothingElseForTheSameAfterALongStep) {
  TrackKeeper keeper(camera());
  for (int i = 0; i < 10; ++i) keeper.step(standing(), std::vector{at(12, -1), at(20, 4)});
  // What it would reach at a walk or braking hard is within what the filter thinks possible, but may be anybody.
  const auto after = keeper.step(standing_for(2.3), std::vector{at(12, 2), at(20, 4)});
  EXPECT_EQ(ids_of(after), (std::vector<std::uint64_t>{3, 2}));
  EXPECT_EQ(after[0].sightings, 1);
}

TEST(TrackKeeper, DoesNotExchangeNeighboursInALongStep) {
  TrackKeeper keeper(camera());
  const std::vector<Sighting> wide_and_narrow = {at(10, 0, 2.0), at(10, 1.4, 0.3)};
  const auto first = ids_of(keeper.step(standing(), wide_and_narrow));
  const auto after = keeper.step(standing_for(4.0), wide_and_narrow);
  EXPECT_EQ(ids_of(after), first);
  EXPECT_NEAR(after[0].state.y_m, 0.0, 0.1);
}

TEST(TrackKeeper, EndsInALongStepWhatIsNotSeenAtItsEnd) {
  TrackKeeper keeper(camera());
  for (int i = 0; i < 10; ++i) keeper.step(standing(), std::vector{at(10, 0)});
  EXPECT_TRUE(keeper.step(standing_for(2.1), {}).empty());
  EXPECT_EQ(ids_of(keeper.step(standing(), std::vector{at(10, 0)})), (std::vector<std::uint64_t>{2}));
}

TEST(TrackKeeper, EndsInALongStepWhatIsNotSeenAtItsEndHoweverLongItMayCoast) {
  TrackOptions patient;
  patient.max_coast_s = 10.0;
  TrackKeeper keeper(camera(), patient);
  for (int i = 0; i < 10; ++i) keeper.step(standing(), std::vector{at(12, -1)});
  EXPECT_TRUE(keeper.step(standing_for(2.5), {}).empty());
  EXPECT_EQ(ids_of(keeper.step(standing(), std::vector{at(14, 3)})), (std::vector<std::uint64_t>{2}));
}

TEST(TrackKeeper, FollowsWhatEveryPairShowsWhereNothingMayCoast) {
  TrackOptions options;
  options.max_coast_s = 0.0;
  TrackKeeper keeper(camera(), options);
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(ids_of(keeper.step(standing(), std::vector{at(10, 0.2 * i)})), (std::vector<std::uint64_t>{1})) << i;
  EXPECT_TRUE(keeper.step(standing(), {}).empty());
}

TEST(TrackKeeper, EndsAllTracksWhenTheCameraIsLost) {
  TrackKeeper keeper(camera());
  keeper.step(standing(), std::vector{at(10, 0), at(15, 3)});
  const auto tracks = keeper.step({}, std::vector{at(10, 0)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 3U);
}

TEST(TrackKeeper, EndsTracksThatLeaveTheView) {
  TrackKeeper keeper(camera());
  keeper.step(standing(), std::vector{at(3, 2)});
  EXPECT_TRUE(keeper.step(given_ego_motion(kDt_s, 12.0, 0.0, 0.0), {}).empty());
}

TEST(TrackKeeper, FollowsWhatIsNearerThanAMetre) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 8; ++i) tracks = keeper.step(standing(), std::vector{at(1.15 - 0.1 * i, 0.05, 0.1)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 1U);
  EXPECT_NEAR(tracks[0].state.vx_mps, -1.0, 0.3);
  EXPECT_LT(std::sqrt(tracks[0].state.covariance[1][1]), std::sqrt(tracks[0].state.covariance[0][0]))
      << "bearings are surer than ranges";
}

TEST(TrackKeeper, KnowsWhatACameraThatLooksDownSees) {
  StereoCamera mast = camera();
  mast.mount = {.height_m = 3.0, .pitch_rad = radians(25)};
  TrackKeeper keeper(mast);
  // A level camera would see it 20 px beside the image.
  const double edge_y_m = 4.0 * 620.0 / 720.0 + 0.1;
  for (int i = 0; i < 3; ++i) keeper.step(standing(), std::vector{at(4.0, edge_y_m)});
  const auto tracks = keeper.step(standing(), std::vector{at(4.0, edge_y_m)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 1U);
}

TEST(TrackKeeper, ReportsSureTracksOnlyWhenAskedToAndEndsNoneForThat) {
  TrackOptions sure;
  sure.min_probability = 0.95;
  TrackKeeper keeper(camera(), sure);
  EXPECT_TRUE(keeper.step(standing(), std::vector{at(10, 0)}).empty());
  for (int i = 0; i < 5; ++i) keeper.step(standing(), std::vector{at(10, 0)});
  keeper.step(standing(), {});
  keeper.step(standing(), std::vector{at(10, 0)});
  const auto tracks = keeper.step(standing(), std::vector{at(10, 0)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 1U);
}

TEST(TrackKeeper, CornersOnARoadThatRisesAreNotOnTheThingThere) {
  const RoadPlane hill{.slope = 0.05};
  const auto speed_with = [&](double corner_above_road_m) {
    TrackKeeper keeper(camera());
    EgoMotion ego = standing();
    Sighting thing = at(15, 0);
    thing.box = {500, 100, 200, 200};
    for (int i = 0; i < 20; ++i)
      ego.corners.push_back({600, 200, 15, 0, hill.z_m(15, 0) + corner_above_road_m, 5.0, 0.0});
    std::vector<Track> tracks;
    for (int i = 0; i < 5; ++i) tracks = keeper.step(ego, std::vector{thing}, hill);
    return tracks.at(0).state.vx_mps;
  };
  EXPECT_GT(speed_with(1.0), 2.0);
  EXPECT_NEAR(speed_with(0.1), 0.0, 0.5);
}

TEST(TrackKeeper, KeepsTwoThatCrossApart) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 40; ++i) {
    const double way_m = 1.5 * kDt_s * i;
    tracks = keeper.step(standing(), std::vector{at(10, -3 + way_m), at(11.2, 3 - way_m)});
    ASSERT_EQ(tracks.size(), 2U) << i;
  }
  EXPECT_EQ(tracks[0].id, 1U);
  EXPECT_GT(tracks[0].state.y_m, 2.0);
}

// A hedge of which every pair shows a piece farther along: its corners stand still.
TEST(TrackKeeper, TakesTheVelocityOfCornersOnAThing) {
  const auto speed = [](bool with_corners) {
    TrackKeeper keeper(camera());
    std::vector<Track> tracks;
    for (int i = 0; i < 10; ++i) {
      auto hedge = at(10, 0.3 * i, 1.0);
      hedge.box = {500, 100, 200, 150};
      EgoMotion ego = standing();
      for (int k = 0; with_corners && k < 10; ++k)
        ego.corners.push_back({.u_px = 510.0 + 10 * k, .v_px = 120, .x_m = 10, .y_m = 0.3 * i, .z_m = 1});
      ego.corners.push_back({.u_px = 600, .v_px = 120, .x_m = 30, .z_m = 1, .vx_mps = 9});  // behind it
      tracks = keeper.step(ego, std::vector{hedge});
    }
    return tracks.empty() ? 0.0 : std::hypot(tracks[0].velocity.vx_mps, tracks[0].velocity.vy_mps);
  };
  EXPECT_GT(speed(false), 1.5);
  EXPECT_LT(speed(true), 0.5);
}

TEST(TrackKeeper, TakesNoVelocityFromTheRoadBeforeAThing) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 10; ++i) {
    auto walker = at(10, 0.3 * i);
    walker.box = {500, 100, 200, 150};
    EgoMotion ego = standing();
    for (int k = 0; k < 10; ++k)
      ego.corners.push_back({.u_px = 510.0 + 10 * k, .v_px = 240, .x_m = 10, .y_m = 0.3 * i, .z_m = 0.05});
    tracks = keeper.step(ego, std::vector{walker});
  }
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_GT(tracks[0].velocity.vy_mps, 2.0);
}

TEST(TrackKeeper, TrustsCornersThatDisagreeLess) {
  const auto sd_mps = [](double spread_mps) {
    TrackKeeper keeper(camera());
    auto thing = at(10, 0);
    thing.box = {500, 100, 200, 150};
    EgoMotion ego = standing();
    for (int k = 0; k < 9; ++k)
      ego.corners.push_back({.u_px = 510.0 + 10 * k, .v_px = 120, .x_m = 10, .z_m = 1, .vy_mps = spread_mps * (k - 4)});
    return std::sqrt(keeper.step(ego, std::vector{thing}).at(0).state.covariance[3][3]);
  };
  EXPECT_GT(sd_mps(1.0), 2.0 * sd_mps(0.0));
}

TEST(TrackKeeper, ReportsTheErrorThatAllSightingsShare) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 200; ++i) tracks = keeper.step(standing(), std::vector{at(10, 0, 2.0)});
  ASSERT_EQ(tracks.size(), 1U);
  const TrackOptions options;
  EXPECT_GT(std::sqrt(tracks[0].state.covariance[1][1]), options.common_sd_share * options.across_sd_share * 2.0);
}

TEST(TrackKeeper, SaysThatAThingMovesOnlyAfterSeveralSightings) {
  const auto first_motion = [](int moving_sightings) {
    TrackOptions options;
    options.moving_sightings = moving_sightings;
    TrackKeeper keeper(camera(), options);
    for (int i = 0; i < 20; ++i) {
      const auto tracks = keeper.step(standing(), std::vector{at(10, -3 + 2.0 * kDt_s * i)});
      if (tracks.size() == 1 && tracks[0].velocity.vy_mps > 1.0) return i;
    }
    return -1;
  };
  const int at_once = first_motion(1);
  EXPECT_GT(at_once, 0);
  EXPECT_EQ(first_motion(6), at_once + 5);
}

TEST(TrackKeeper, JoinsTwoTracksOfOneThingUnderTheOlderNumber) {
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 4; ++i) keeper.step(standing(), std::vector{at(10, 0)});
  keeper.step(standing(), std::vector{at(10, 0), at(10.2, 0.1)});  // seen twice
  for (int i = 0; i < 3; ++i) tracks = keeper.step(standing(), std::vector{at(10.2, 0.1)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 1U);
  EXPECT_NEAR(tracks[0].age_s, 0.7, 1e-9);
}

TEST(TrackKeeper, DoesNotJoinNeighbours) {
  TrackKeeper keeper(camera());
  for (int i = 0; i < 5; ++i) keeper.step(standing(), std::vector{at(10, 0), at(10, 0.9)});
  EXPECT_EQ(keeper.step(standing(), std::vector{at(10, 0.9)}).size(), 2U) << "one was only missed";
}

TEST(TrackKeeper, PassesOverSightingsThatAreNoNumbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  TrackKeeper keeper(camera());
  std::vector<Track> tracks;
  for (int i = 0; i < 3; ++i)
    tracks = keeper.step(
        i == 0 ? EgoMotion{} : standing(),
        std::vector{at(kNan, 0), at(10, 1), at(10, std::numeric_limits<double>::infinity()), at(10, 1, kNan)});
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].sightings, 3);
  EXPECT_NEAR(tracks[0].state.x_m, 10, 0.1);
}

TEST(TrackKeeper, EndsTracksThatAMotionWithoutNumbersMoves) {
  StereoCamera any_size = camera();
  any_size.width_px = any_size.height_px = 0;
  TrackKeeper keeper(any_size);
  keeper.step({}, std::vector{at(10, 1), at(12, -1)});
  for (const double dt_s : {kDt_s, 3.0}) {
    EgoMotion no_number = standing_for(dt_s);
    no_number.current_from_previous.shift.x_m = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(keeper.step(no_number, {}).empty());
    keeper.step({}, std::vector{at(10, 1), at(12, -1)});
    EXPECT_EQ(keeper.step(no_number, std::vector{at(10, 1)}).at(0).sightings, 1);
  }
}

TEST(TrackKeeper, RefusesOptionsOutOfRange) {
  TrackOptions options;
  options.gate = 0.0;
  EXPECT_THAT([&] { TrackKeeper(camera(), options); }, ThrowsMessage<InputError>(HasSubstr("gate")));
}

}  // namespace
}  // namespace flies
