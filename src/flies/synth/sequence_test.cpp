#include "flies/synth/sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

SceneOptions small_street(std::uint64_t seed) {
  SceneOptions options;
  options.seed = seed;
  options.width_px = 310;
  options.height_px = 94;
  options.focal_px = 180.0;
  options.samples_per_side = 1;
  return options;
}

int count(const SyntheticScene& scene, ObjectClass kind) {
  return static_cast<int>(std::count_if(scene.objects.begin(), scene.objects.end(),
                                        [&](const SceneObject& object) { return object.kind == kind; }));
}

/// In the vehicle frame of time 0.
Point3 in_world(const VehiclePose& pose, double x_m, double y_m) {
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  return {pose.x_m + c * x_m - s * y_m, pose.y_m + s * x_m + c * y_m, 0.0};
}

TEST(StreetSequence, HoldsEverybodyOfItsStory) {
  const StreetSequence sequence(small_street(1));
  const auto scene = sequence.scene_at(0.0);
  EXPECT_EQ(count(scene, ObjectClass::cyclist), 1);
  EXPECT_EQ(count(scene, ObjectClass::pedestrian), 8);  // six of the pavements, the crossing and the hidden one
  EXPECT_GE(count(scene, ObjectClass::car), 5);
}

TEST(StreetSequence, IdentitiesStayAndVelocitiesAreChangesOfPlace) {
  const StreetSequence sequence(small_street(3));
  for (const double t : {0.5, 2.0, 4.0, 6.5}) {
    const auto before = sequence.scene_at(t - 0.02), here = sequence.scene_at(t), after = sequence.scene_at(t + 0.02);
    ASSERT_FALSE(here.objects.empty());
    ASSERT_EQ(before.objects.size(), here.objects.size());
    ASSERT_EQ(after.objects.size(), here.objects.size());
    const VehiclePose pose = sequence.pose_at(t);
    for (std::size_t i = 0; i < here.objects.size(); ++i) {
      if (here.objects[i].kind == ObjectClass::pedestrian) continue;  // whose middle sways with the steps
      const auto a = in_world(sequence.pose_at(t - 0.02), before.objects[i].x_m, before.objects[i].y_m);
      const auto b = in_world(sequence.pose_at(t + 0.02), after.objects[i].x_m, after.objects[i].y_m);
      const double vx = here.objects[i].vx_mps, vy = here.objects[i].vy_mps;
      const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
      const double tolerance = here.objects[i].kind == ObjectClass::cyclist ? 0.5 : 0.1;
      EXPECT_NEAR((b.x_m - a.x_m) / 0.04, c * vx - s * vy, tolerance) << i;
      EXPECT_NEAR((b.y_m - a.y_m) / 0.04, s * vx + c * vy, tolerance) << i;
    }
  }
}

TEST(StreetSequence, NobodyRunsIntoAnybody) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const StreetSequence sequence(small_street(seed));
    for (double t = 0.0; t <= StreetSequence::kLongest_s; t += 0.25) {
      const auto scene = sequence.scene_at(t);
      ASSERT_GE(count(scene, ObjectClass::pedestrian), 1);
      ASSERT_GE(count(scene, ObjectClass::car), 1);
      for (const auto& mover : scene.objects) {
        if (std::hypot(mover.vx_mps, mover.vy_mps) < 0.5 || mover.kind == ObjectClass::pedestrian) continue;
        EXPECT_GT(std::hypot(std::max(0.0, std::abs(mover.x_m) - mover.length_m / 2), mover.y_m), 0.6)
            << "seed " << seed << ", " << t << " s: our car meets a " << kObjectClassNames[size_t(mover.kind)];
      }
      for (const auto& person : scene.objects) {
        if (person.kind != ObjectClass::pedestrian) continue;
        EXPECT_GT(std::hypot(person.x_m, person.y_m), 0.8) << "seed " << seed << ", " << t << " s: our car";
        for (const auto& other : scene.objects) {
          if (other.kind != ObjectClass::car && other.kind != ObjectClass::cyclist) continue;
          const double c = std::cos(other.yaw_rad), s = std::sin(other.yaw_rad);
          const double dx = person.x_m - other.x_m, dy = person.y_m - other.y_m;
          const bool inside = std::abs(c * dx + s * dy) < other.length_m / 2 + 0.1 &&
                              std::abs(-s * dx + c * dy) < other.width_m / 2 + 0.1;
          EXPECT_FALSE(inside) << "seed " << seed << ", " << t << " s: a person in a "
                               << kObjectClassNames[size_t(other.kind)];
        }
      }
    }
  }
}

TEST(StreetSequence, ShowsTheCrossingPersonComeFromBehindTheParkedCar) {
  const StreetSequence sequence(small_street(2));
  const auto options = small_street(2);
  const StereoCamera camera = synthetic_camera(options);
  const auto share_hidden = [&](double time_s) {
    const auto pair = render_pair(sequence.scene_at(time_s), camera, options);
    for (const auto& object : pair.objects)
      if (object.kind == ObjectClass::pedestrian && std::hypot(object.vx_mps, object.vy_mps) > 0.5 &&
          std::abs(object.vy_mps) > std::abs(object.vx_mps))
        return object.occlusion;
    return 1.0;
  };
  EXPECT_GT(share_hidden(1.4), 0.5);
  EXPECT_LT(share_hidden(4.0), 0.2);
}

TEST(StreetSequence, RefusesAnotherKindOfScene) {
  SceneOptions options = small_street(1);
  options.kind = SceneKind::wall;
  EXPECT_THROW(StreetSequence{options}, InputError);
}

}  // namespace
}  // namespace flies
