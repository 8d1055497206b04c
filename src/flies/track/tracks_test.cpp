#include "flies/track/tracks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"
#include "flies/track/toy_sightings.hpp"

namespace flies {
namespace {

using testing::at;
using testing::camera;
using ::testing::HasSubstr;
using testing::ids_of;
using testing::kDt_s;
using testing::standing;
using testing::standing_for;
using ::testing::ThrowsMessage;

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
