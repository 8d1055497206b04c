#include <array>
#include <numbers>

#include "flies/synth/chance.hpp"
#include "flies/synth/places.hpp"
#include "flies/synth/placing.hpp"
#include "flies/synth/street.hpp"
#include "flies/synth/street_parts.hpp"
#include "flies/synth/things.hpp"

namespace flies::synth {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kBehind_m = -3.0F;  // floors and walls begin behind the camera

Mesh floor_of(FlyRandom& random, float end_m, float half_width_m, float contrast, bool is_store) {
  Material material = wood(random, contrast);
  const double pick = random.uniform();
  if (is_store) {
    material = {Pattern::asphalt, {0.30F, 0.30F, 0.29F}, {}, contrast, 0.1F, 0.05F, random.bits()};
  } else if (pick < 0.3) {
    material = {Pattern::slabs, {0.35F, 0.33F, 0.30F}, {}, contrast, 0.3F, 0.05F, random.bits()};
  } else if (pick < 0.6) {
    material = {Pattern::speckle, {0.22F, 0.16F, 0.14F}, {}, contrast, 0.12F, 0.0F, random.bits()};
  }
  return quad({kBehind_m, -half_width_m, 0}, {end_m - kBehind_m, 0, 0}, {0, 2.0F * half_width_m, 0}, material);
}

/// Ceiling with rows of lamps.
Mesh ceiling(FlyRandom& random, float end_m, float half_width_m, float height_m, float contrast) {
  const Material white{Pattern::plaster, {0.62F, 0.61F, 0.58F}, {}, 0.6F * contrast, 0.1F, 0.0F, random.bits()};
  const Material lamp{Pattern::plain, {3.0F, 3.0F, 2.9F}, {}, 0.0F, 0.1F, 0.0F, random.bits()};  // shines by itself
  Mesh mesh = quad({kBehind_m, -half_width_m, height_m}, {0, 2.0F * half_width_m, 0}, {end_m - kBehind_m, 0, 0}, white);
  for (float x = 1.0F; x < end_m - 1.0F; x += 2.5F)
    mesh.add(box({x, -0.6F, height_m - 0.05F}, {x + 0.25F, 0.6F, height_m - 0.001F}, lamp));
  return mesh;
}

/// Wall of a room from x = 0 to `length_m`, face y = 0 seen from +y: skirting board, pictures, at times a door.
Mesh room_wall(FlyRandom& random, float length_m, float height_m, float contrast) {
  constexpr std::array<Vec3, 4> kPaper = {
      {{0.55F, 0.50F, 0.40F}, {0.38F, 0.45F, 0.42F}, {0.50F, 0.38F, 0.33F}, {0.58F, 0.57F, 0.54F}}};
  Material paper{Pattern::plaster, kPaper[random.below(kPaper.size())], {}, contrast, 0.1F, 0.0F, random.bits()};
  if (random.uniform() < 0.35) {
    paper.pattern = Pattern::brick;
    paper.second = paper.colour * 0.6F;
  }
  Mesh mesh = box({0, -0.2F, 0}, {length_m, 0, height_m}, paper);
  mesh.add(box({0, 0, 0}, {length_m, 0.015F, 0.08F}, wood(random, contrast)));
  for (float x = between(random, 0.8, 1.8); x < length_m - 1.0F;) {
    if (random.uniform() < 0.25) {
      mesh.add(box({x - 0.45F, 0, 0}, {x + 0.45F, 0.04F, 2.05F}, wood(random, contrast, 0.3F)));
    } else {
      const Vec3 centre{x, 0, between(random, 1.3, 1.8)};
      mesh.add(picture(random, centre, contrast));
    }
    x += between(random, 1.5, 2.6);
  }
  return mesh;
}

/// A thing of a room, by chance.
Thing thing_of_room(FlyRandom& random, float contrast) {
  const double pick = random.uniform();
  Thing thing{.kind = ObjectClass::furniture, .mesh = {}};
  thing.yaw_rad = between(random, -kPi, kPi);
  if (pick < 0.3) {
    thing.mesh = table(random, contrast);
  } else if (pick < 0.55) {
    thing.mesh = chair(random, contrast);
  } else if (pick < 0.65) {
    thing.kind = ObjectClass::pole;
    thing.mesh = floor_lamp(random, contrast);
  } else {
    const Vec3 size{between(random, 0.2, 0.6), between(random, 0.2, 0.5), between(random, 0.12, 0.5)};
    thing.kind = ObjectClass::box;
    thing.mesh = carton(random, size, contrast);
  }
  return thing;
}

/// What stands in an aisle, by chance.
Thing thing_of_aisle(FlyRandom& random, float contrast) {
  const double pick = random.uniform();
  Thing thing{.kind = ObjectClass::pallet, .mesh = {}};
  const float askew_rad = between(random, -0.1, 0.1);
  thing.yaw_rad = askew_rad + (random.uniform() < 0.5 ? 0.0F : 0.5F * kPi);
  if (pick < 0.4) {
    thing.mesh = pallet(random, random.uniform() < 0.7, contrast);
  } else {
    const Vec3 size{between(random, 0.15, 0.6), between(random, 0.15, 0.5), between(random, 0.08, 0.5)};
    thing.kind = ObjectClass::box;
    thing.mesh = carton(random, size, contrast);
  }
  return thing;
}

void place_things(const SceneOptions& options, Thing (*draw)(FlyRandom&, float), const FreeGround& ground, Taken& taken,
                  std::vector<SceneObject>& objects) {
  for (std::uint32_t i = 0; static_cast<int>(i) < options.things; ++i) {
    FlyRandom random(options.seed, kThingsPurpose, 0, i);
    const Thing thing = draw(random, static_cast<float>(options.texture_contrast));
    find_place(random, thing, ground, taken, objects);
  }
}

}  // namespace

std::vector<SceneObject> room(const SceneOptions& options) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom random(options.seed, kHousesPurpose, 0, 0);
  const float depth_m = between(random, 4.0, 8.0), left_m = between(random, 1.8, 3.5);
  const float right_m = between(random, 1.8, 3.5), height_m = between(random, 2.5, 2.9);
  std::vector<SceneObject> objects;
  objects.push_back(scenery(floor_of(random, depth_m + 0.2F, 4.0F, contrast, false)));
  objects.push_back(scenery(ceiling(random, depth_m + 0.2F, 4.0F, height_m, contrast), ObjectClass::backdrop));
  const float side_m = depth_m - kBehind_m;
  const auto add_wall = [&](float length_m, const Placement& place) {
    objects.push_back(stand(ObjectClass::wall, room_wall(random, length_m, height_m, contrast), place));
  };
  add_wall(side_m, {{kBehind_m, -right_m, 0}, 0.0F});
  add_wall(side_m, {{depth_m, left_m, 0}, kPi});
  add_wall(left_m + right_m, {{depth_m, -right_m, 0}, 0.5F * kPi});

  Taken taken;
  FlyRandom cupboards(options.seed, kShelvesPurpose, 0, 0);
  for (const float y : {-0.5F * right_m, 0.5F * left_m}) {  // along the wall ahead
    const Mesh mesh = cupboard(cupboards, contrast);
    if (cupboards.uniform() < 0.3) continue;
    objects.push_back(stand(ObjectClass::furniture, mesh, {{depth_m - 0.01F, y, 0}, kPi}));
    taken.circles.push_back({depth_m - 0.3F, y, 0.7F});
  }
  const FreeGround ground{1.2F, depth_m - 0.7F, -right_m + 0.5F, left_m - 0.5F, half_view_of(options)};
  place_people(options, ground, taken, objects);
  place_things(options, thing_of_room, ground, taken, objects);
  return objects;
}

std::vector<SceneObject> aisle(const SceneOptions& options) {
  constexpr float kBay_m = 2.4F, kHall_m = 4.5F, kHalfHall_m = 6.0F;
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom random(options.seed, kHousesPurpose, 0, 0);
  const float end_m = between(random, 14.0, 18.0), left_m = between(random, 1.0, 1.4),
              right_m = between(random, 1.0, 1.4);
  std::vector<SceneObject> objects;
  objects.push_back(scenery(floor_of(random, end_m, kHalfHall_m, contrast, true)));
  objects.push_back(scenery(ceiling(random, end_m, kHalfHall_m, kHall_m, contrast), ObjectClass::backdrop));
  objects.push_back(stand(ObjectClass::wall, wall(random, 2.0F * kHalfHall_m, kHall_m, 0.3F, contrast),
                          {{end_m, -kHalfHall_m, 0}, 0.5F * kPi}));
  for (const float y : {-kHalfHall_m, kHalfHall_m}) {  // seen through gaps between the shelves
    const Material plaster{Pattern::plaster, {0.5F, 0.5F, 0.48F}, {}, contrast, 0.1F, 0.0F, random.bits()};
    objects.push_back(
        scenery(quad({kBehind_m, y, 0}, {end_m - kBehind_m, 0, 0}, {0, 0, kHall_m}, plaster), ObjectClass::backdrop));
  }
  for (std::uint32_t i = 0; kBay_m * static_cast<float>(i) < end_m - kBay_m; ++i) {
    FlyRandom shelves(options.seed, kShelvesPurpose, 0, i);
    const float x = -1.2F + kBay_m * static_cast<float>(i);
    objects.push_back(stand(ObjectClass::shelf, rack(shelves, kBay_m, contrast), {{x, -right_m, 0}, 0.0F}));
    objects.push_back(stand(ObjectClass::shelf, rack(shelves, kBay_m, contrast), {{x + kBay_m, left_m, 0}, kPi}));
  }
  Taken taken;
  const FreeGround ground{1.0F, end_m - 2.0F, -right_m + 0.35F, left_m - 0.35F, half_view_of(options)};
  place_people(options, ground, taken, objects);
  place_things(options, thing_of_aisle, ground, taken, objects);
  return objects;
}

}  // namespace flies::synth
