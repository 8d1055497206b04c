// Steps so long that what moves may be anywhere: pairs of a slow camera, or of one that paused.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "flies/track/toy_sightings.hpp"
#include "flies/track/tracks.hpp"

namespace flies {
namespace {

using testing::at;
using testing::camera;
using testing::ids_of;
using testing::kDt_s;
using testing::standing;
using testing::standing_for;

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

}  // namespace
}  // namespace flies
