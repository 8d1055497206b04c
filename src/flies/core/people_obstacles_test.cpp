#include "flies/core/people_obstacles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flies {
namespace {

using testing::ElementsAre;
using testing::Optional;

Obstacle obstacle_at(double x_m, double y_m) {
  Obstacle obstacle;
  obstacle.x_m = x_m;
  obstacle.y_m = y_m;
  obstacle.range_m = std::hypot(x_m, y_m);
  return obstacle;
}

Pedestrian person_at(double x_m, double y_m) {
  Pedestrian person;
  person.x_m = x_m;
  person.y_m = y_m;
  person.range_m = std::hypot(x_m, y_m);
  return person;
}

TEST(ObstaclesOfPeople, TakesTheNearestAndEachOnce) {
  const std::vector<Obstacle> obstacles = {obstacle_at(10, 0), obstacle_at(10, 0.6), obstacle_at(20, 5)};
  const std::vector<Pedestrian> people = {person_at(10.1, 0.5), person_at(10, 0.4), person_at(30, 0)};
  EXPECT_THAT(obstacles_of_people(obstacles, people), ElementsAre(Optional(1U), Optional(0U), std::nullopt));
}

TEST(ObstaclesOfPeople, LooksFromTheMiddleOfAWideOne) {
  Obstacle wide = obstacle_at(10, 0);
  wide.middle_offset_m = 2.0;  // a wall whose nearest point is not its middle
  EXPECT_THAT(obstacles_of_people(std::vector{wide}, std::vector{person_at(10, 0)}), ElementsAre(std::nullopt));
  EXPECT_THAT(obstacles_of_people(std::vector{wide}, std::vector{person_at(10, 2)}), ElementsAre(Optional(0U)));
  EXPECT_NEAR(middle_of(wide).y_m, 2.0, 0.05);
}

TEST(ObstaclesOfPeople, APlaceThatIsNoNumberIsNobodys) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Obstacle> obstacles = {obstacle_at(kNan, 0), obstacle_at(10, 0)};
  EXPECT_THAT(obstacles_of_people(obstacles, std::vector{person_at(10, 0), person_at(kNan, 0)}),
              ElementsAre(Optional(1U), std::nullopt));
}

}  // namespace
}  // namespace flies
