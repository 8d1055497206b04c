#include "flies/synth/sequence.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/synth/bicycle.hpp"
#include "flies/synth/chance.hpp"
#include "flies/synth/street.hpp"
#include "flies/synth/vehicle.hpp"

namespace flies {
namespace {

using namespace synth;

constexpr float kPi = std::numbers::pi_v<float>;

// The story of the header, before it varies: who is where when. Our car starts at x = 0 in the middle of its lane.
constexpr float kOurSpeed_mps = 7.0F, kLeader_m = 19.0F, kCrossing_m = 26.0F;
constexpr float kCrossingSpeed_mps = 1.4F, kSteppingOut_s = 1.0F;
constexpr float kOncoming_m = 52.0F, kOncomingLane_m = 3.3F;

/// A stream of its own for everybody and everything that moves.
FlyRandom mover_random(const SceneOptions& options, std::uint32_t mover) {
  return FlyRandom(options.seed, kMoversPurpose, 0, mover);
}
enum MoverNumber : std::uint32_t { kOurCar, kLeader, kOncoming, kCyclist, kCrossing, kHidden, kFirstWalker };

/// The way is covered in steps of this length, both legs counted.
float step_cycle_m(const PersonLook& look) { return 0.8F * look.height_m; }
constexpr float kPedalCycle_m = 5.0F;

SceneObject from_vehicle(const SceneObject& object, const Placement& world_in_vehicle) {
  SceneObject seen = object;
  seen.mesh = placed(object.mesh, world_in_vehicle);
  const float c = std::cos(world_in_vehicle.yaw_rad), s = std::sin(world_in_vehicle.yaw_rad);
  seen.x_m = c * object.x_m - s * object.y_m + world_in_vehicle.position.x;
  seen.y_m = s * object.x_m + c * object.y_m + world_in_vehicle.position.y;
  seen.yaw_rad = object.yaw_rad + world_in_vehicle.yaw_rad;
  seen.vx_mps = c * object.vx_mps - s * object.vy_mps;
  seen.vy_mps = s * object.vx_mps + c * object.vy_mps;
  return seen;
}

Path our_path(const SceneOptions& options) {
  FlyRandom random = mover_random(options, kOurCar);
  const float speed = kOurSpeed_mps * between(random, 0.9, 1.05), brake_s = between(random, 1.1, 1.3);
  const float side_s = between(random, 5.3, 5.7);
  return {{},
          {{brake_s, speed}, {brake_s + 1.4F, 1.8F}, {5.2F, 1.8F}, {7.5F, 6.0F}},
          {side_s, side_s + 2.6F, between(random, 2.6, 3.3)}};
}

}  // namespace

StreetSequence::StreetSequence(const SceneOptions& options) : ego_(our_path(options)) {
  if (options.kind != SceneKind::street)
    throw InputError("scene options", "kind", "is no street, expected street: sequences take place in one");
  FlyRandom random = mover_random(options, kCrossing);
  const float crossing_x_m = kCrossing_m + between(random, -1.5, 1.5);
  standing_.lighting = lighting_of(options);
  standing_.objects = standing_street(options, crossing_x_m);
  add_vehicles(options);
  add_people(options, crossing_x_m);
}

void StreetSequence::add_vehicles(const SceneOptions& options) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom leader = mover_random(options, kLeader);
  const float brake_s = between(leader, 1.8, 2.4);
  movers_.push_back({ObjectClass::car,
                     car(leader, contrast),
                     {},
                     {{{kLeader_m + between(leader, -1.5, 1.5), 0, 0}, 0.0F},
                      {{brake_s, kOurSpeed_mps}, {brake_s + between(leader, 2.0, 2.6), 0.0F}}}});
  FlyRandom oncoming = mover_random(options, kOncoming);
  movers_.push_back(
      {ObjectClass::car,
       car(oncoming, contrast),
       {},
       {{{kOncoming_m + between(oncoming, -4, 4), kOncomingLane_m, 0}, kPi}, {{0.0F, between(oncoming, 7.5, 9.0)}}}});
  FlyRandom cyclist = mover_random(options, kCyclist);
  movers_.push_back({ObjectClass::cyclist,
                     {},
                     random_look(cyclist, false, contrast),
                     {{{between(cyclist, -5, -3), between(cyclist, 1.2, 1.4), 0}, 0.0F},
                      {{2.5F, between(cyclist, 8.0, 9.5)}, {5.0F, between(cyclist, 4.0, 6.0)}}}});
}

void StreetSequence::add_people(const SceneOptions& options, float crossing_x_m) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  const auto add = [&](const PersonLook& look, Path path) {
    movers_.push_back({ObjectClass::pedestrian, {}, look, std::move(path)});
  };
  FlyRandom crossing(options.seed, kMoversPurpose, 1, kCrossing);
  PersonLook look = random_look(crossing, false, contrast);
  look.stride = 1.0F;
  const float start_s = kSteppingOut_s + between(crossing, -0.2, 0.2);
  add(look, {{{crossing_x_m, kKerbRight_m - 0.3F, 0}, kPi / 2},
             {{start_s, 0.0F}, {start_s + 0.3F, kCrossingSpeed_mps * between(crossing, 0.9, 1.1)}}});

  FlyRandom hidden = mover_random(options, kHidden);
  look = random_look(hidden, false, contrast);
  look.stride = 0.1F;
  add(look, {{{between(hidden, 32, 40), kKerbLeft_m + 0.7F, kKerbHeight_m}, -kPi / 2}, {{0.0F, 0.0F}}});

  for (int i = 0; i < options.people; ++i) {
    FlyRandom random = mover_random(options, kFirstWalker + static_cast<std::uint32_t>(i));
    const bool is_child = random.uniform() < options.children, is_left = i % 2 == 1, goes_on = random.uniform() < 0.5;
    look = random_look(random, is_child, contrast);
    const float speed = look.stride < 0.5F ? 0.0F : between(random, 0.9, 1.6) * std::min(1.0F, look.height_m / 1.5F);
    // Clear of trees and poles, and each on a line of its own.
    const float out_m = 1.5F + 0.4F * static_cast<float>((i / 2) % 4) + between(random, -0.1, 0.1);
    const float y = is_left ? kKerbLeft_m + out_m : kKerbRight_m - out_m;
    add(look, {{{between(random, options.people_min_range_m, options.people_max_range_m + 20.0), y, kKerbHeight_m},
                goes_on ? 0.0F : kPi},
               {{0.0F, speed}}});
  }
}

SceneObject StreetSequence::object_at(const Mover& mover, float time_s) const {
  const Placement place = mover.path.at(time_s);
  const float turn_rad = 2.0F * kPi * mover.path.travelled_m(time_s);
  PersonLook look = mover.look;
  SceneObject object;
  if (mover.kind == ObjectClass::pedestrian) {
    look.phase_rad += turn_rad / step_cycle_m(look);
    object = stand(mover.kind, person(look), place);
  } else if (mover.kind == ObjectClass::cyclist) {
    look.phase_rad += turn_rad / kPedalCycle_m;
    object = stand(mover.kind, cyclist(look), place);
  } else {
    object = stand(mover.kind, mover.mesh, place);
  }
  const Vec3 velocity = mover.path.velocity_at(time_s);
  object.vx_mps = velocity.x;
  object.vy_mps = velocity.y;
  return object;
}

SyntheticScene StreetSequence::scene_at(double time_s) const {
  const auto time = static_cast<float>(time_s);
  const Placement world_in_vehicle = inverse(ego_.at(time));
  SyntheticScene scene{{}, standing_.lighting};
  scene.lighting.to_sun = placed_direction(standing_.lighting.to_sun, world_in_vehicle);
  for (const auto& object : standing_.objects) scene.objects.push_back(from_vehicle(object, world_in_vehicle));
  for (const auto& mover : movers_) scene.objects.push_back(from_vehicle(object_at(mover, time), world_in_vehicle));
  return scene;
}

VehiclePose StreetSequence::pose_at(double time_s) const {
  const Placement place = ego_.at(static_cast<float>(time_s));
  return {place.position.x, place.position.y, place.yaw_rad};
}

}  // namespace flies
