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
constexpr float kBehind_m = -5.0F;

Mesh ground_strip(float x1, float y0, float y1, float z, const Material& material) {
  return quad({kBehind_m, y0, z}, {x1 - kBehind_m, 0, 0}, {0, y1 - y0, 0}, material);
}

/// The edge of the wood, too far away to count.
SceneObject edge_of_woods(FlyRandom& random, float contrast) {
  constexpr float kAway_m = 75.0F, kLength_m = 200.0F, kHeight_m = 12.0F;
  return scenery(placed(hedge(random, kLength_m, kHeight_m, contrast), {{kAway_m, -0.5F * kLength_m, 0}, 0.5F * kPi}),
                 ObjectClass::backdrop);
}

// The pavement across, from right to left: hedge, grass, kerb, asphalt on which the rover drives, kerb, slabs, houses.
constexpr float kKerbOnRight_m = -2.4F, kKerbOnLeft_m = 1.5F, kEnd_m = 45.0F, kCurb_m = 0.12F;

Material concrete(FlyRandom& random, float contrast) {
  return {Pattern::plaster, {0.30F, 0.295F, 0.285F}, {}, contrast, 0.1F, 0.0F, random.bits()};
}

std::vector<SceneObject> pavement_ground(const SceneOptions& options) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom random(options.seed, kHousesPurpose, 2, 0);
  const Material tar{Pattern::asphalt, {0.085F, 0.084F, 0.082F}, {}, contrast, 0.1F, 0.0F, random.bits()};
  const Material slab{Pattern::slabs, {0.22F, 0.215F, 0.205F}, {}, contrast, 0.45F, 0.0F, random.bits()};
  const Material grass{Pattern::speckle, {0.10F, 0.15F, 0.045F}, {}, contrast, 0.2F, 0.0F, random.bits()};
  const Material stone = concrete(random, contrast);
  Mesh mesh = ground_strip(kEnd_m + 20.0F, kKerbOnRight_m, kKerbOnLeft_m, 0.0F, tar);
  mesh.add(ground_strip(kEnd_m + 20.0F, kKerbOnLeft_m + 0.14F, 12.0F, kCurb_m - 0.01F, slab));
  mesh.add(ground_strip(kEnd_m + 20.0F, -30.0F, kKerbOnRight_m - 0.14F, kCurb_m - 0.02F, grass));
  std::vector<SceneObject> objects;
  objects.push_back(scenery(std::move(mesh)));
  for (const float y : {kKerbOnRight_m - 0.14F, kKerbOnLeft_m})
    objects.push_back(stand(ObjectClass::kerb, box({kBehind_m, y, -0.2F}, {kEnd_m, y + 0.14F, kCurb_m}, stone), {}));
  return objects;
}

void add_houses(const SceneOptions& options, std::vector<SceneObject>& objects) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom random(options.seed, kHousesPurpose, 0, 0);
  const float houses_m = between(random, 4.0, 5.5), hedge_m = between(random, -5.5, -4.2);
  for (float x = kBehind_m; x < kEnd_m;) {
    const float length_m = between(random, 9.0, 15.0), height_m = between(random, 6.5, 11.0);
    objects.push_back(stand(ObjectClass::wall, house_front(random, length_m, height_m, contrast),
                            {{x + length_m, houses_m, kCurb_m - 0.02F}, kPi}));
    x += length_m;
  }
  objects.push_back(stand(ObjectClass::hedge, hedge(random, kEnd_m - kBehind_m, between(random, 1.0, 1.6), contrast),
                          {{kBehind_m, hedge_m, kCurb_m - 0.03F}, 0.0F}));
  Mesh far;
  for (float y = -40.0F; y < 40.0F; y += 12.0F)
    far.add(placed(house_front(random, 12.0F, 9.0F, contrast), {{kEnd_m + 15.0F, y, 0}, 0.5F * kPi}));
  objects.push_back(scenery(std::move(far), ObjectClass::backdrop));
}

/// What stands before the rover, by chance.
Thing thing_of_pavement(FlyRandom& random, float contrast) {
  const double pick = random.uniform();
  Thing thing{.kind = ObjectClass::box, .mesh = {}};
  thing.yaw_rad = between(random, -kPi, kPi);
  if (pick < 0.5) {
    const float height_m = between(random, 0.05, 0.4);
    const Vec3 size{between(random, 0.8, 1.6) * height_m + 0.05F, between(random, 0.8, 1.6) * height_m + 0.05F,
                    height_m};
    thing.mesh = carton(random, size, contrast);
  } else if (pick < 0.7) {
    thing.kind = ObjectClass::pole;
    thing.mesh = bollard(random);
  } else {
    thing.kind = ObjectClass::furniture;
    thing.mesh = pick < 0.8 ? table(random, contrast) : chair(random, contrast);
  }
  return thing;
}

/// A traffic island across a part of the way.
SceneObject island(FlyRandom& random, float contrast, Taken& taken) {
  const float x = between(random, 5.0, 9.0), y = between(random, -1.6, -0.2), half_m = between(random, 0.4, 0.7);
  for (float at = -half_m; at <= half_m; at += 0.2F) taken.circles.push_back({x, y + at, 0.4F});
  const float height_m = between(random, 0.08, 0.14);
  return stand(ObjectClass::kerb, box({-0.35F, -half_m, 0}, {0.35F, half_m, height_m}, concrete(random, contrast)),
               {{x, y, 0}, 0.0F});
}

}  // namespace

std::vector<SceneObject> woods(const SceneOptions& options) {
  constexpr TreeSizes kTall{
      .height_m = {9.0, 16.0}, .fork_m = {4.0, 9.0}, .radius_m = {0.14, 0.3}, .crown_m = {1.0, 2.2}, .tufts = 60};
  constexpr float kNearest_m = 6.5F, kFarthest_m = 26.0F;  // of trunks; crowns reach nearer
  const auto contrast = static_cast<float>(options.texture_contrast);
  FlyRandom random(options.seed, kHousesPurpose, 0, 0);
  const Material grass{Pattern::speckle, {0.10F, 0.15F, 0.045F}, {}, contrast, 0.6F, 0.0F, random.bits()};
  std::vector<SceneObject> objects;
  objects.push_back(scenery(ground_strip(900.0F, -900.0F, 900.0F, 0.0F, grass)));
  objects.push_back(edge_of_woods(random, contrast));
  Taken taken;
  const FreeGround ground{kNearest_m, kFarthest_m, -14.0F, 14.0F, half_view_of(options, 0.0F)};
  for (std::uint32_t i = 0; static_cast<int>(i) < options.trees; ++i) {
    FlyRandom one(options.seed, kTreesPurpose, 0, i);
    Thing thing{.kind = ObjectClass::tree, .mesh = tree(one, contrast, kTall), .in_sight = false};
    thing.yaw_rad = between(one, -kPi, kPi);
    find_place(one, thing, ground, taken, objects);
  }
  return objects;
}

std::vector<SceneObject> pavement(const SceneOptions& options) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  std::vector<SceneObject> objects = pavement_ground(options);
  add_houses(options, objects);
  Taken taken;
  FlyRandom random(options.seed, kShelvesPurpose, 0, 0);
  objects.push_back(island(random, contrast, taken));
  const FreeGround asphalt{1.0F, 10.0F, kKerbOnRight_m + 0.4F, kKerbOnLeft_m - 0.4F, half_view_of(options)};
  place_people(options, asphalt, taken, objects);
  for (std::uint32_t i = 0; static_cast<int>(i) < options.things; ++i) {
    FlyRandom one(options.seed, kThingsPurpose, 0, i);
    find_place(one, thing_of_pavement(one, contrast), asphalt, taken, objects);
  }
  return objects;
}

}  // namespace flies::synth
