#include "flies/synth/street.hpp"

#include <array>
#include <numbers>

#include "flies/synth/chance.hpp"
#include "flies/synth/person.hpp"
#include "flies/synth/street_parts.hpp"
#include "flies/synth/taken.hpp"
#include "flies/synth/vehicle.hpp"

namespace flies::synth {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// The street across, from right (negative y) to left: house, pavement, parking lane, our lane, oncoming lane,
// parking lane, pavement, house. The camera drives in the middle of its lane, y = 0.
constexpr float kStart_m = -10.0F, kEnd_m = 130.0F;
constexpr float kCentreLine_m = 1.65F, kOurEdge_m = -1.65F, kOncomingEdge_m = 4.95F;
constexpr float kHousesRight_m = -7.2F, kHousesLeft_m = 10.6F;
constexpr float kParkedRight_m = -2.75F, kParkedLeft_m = 6.05F;

/// Height of the ground of the street at y.
float ground_z_m(float y) { return y < kKerbRight_m || y > kKerbLeft_m ? kKerbHeight_m : 0.0F; }

Mesh flat(float x0, float x1, float y0, float y1, float z, const Material& material) {
  return quad({x0, y0, z}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, material);
}

Material asphalt(std::uint64_t seed, float contrast) {
  return {Pattern::asphalt, {0.085F, 0.084F, 0.082F}, {}, contrast, 0.1F, 0.0F, static_cast<std::uint32_t>(seed)};
}

Material road_paint(std::uint64_t seed, float contrast) {
  return {Pattern::worn, {0.55F, 0.55F, 0.53F},           {0.085F, 0.084F, 0.082F}, contrast, 0.1F,
          0.0F,          static_cast<std::uint32_t>(seed)};
}

/// Dashes along the road. They lie 4 mm above it to be hit before it.
constexpr float kPaint_m = 0.004F;
Mesh dashes(float y, float dash_m, float gap_m, const Material& paint) {
  Mesh mesh;
  for (float x = 2.0F; x < kEnd_m; x += dash_m + gap_m)
    mesh.add(flat(x, x + dash_m, y - 0.06F, y + 0.06F, kPaint_m, paint));
  return mesh;
}

Mesh street_ground(const SceneOptions& options, float zebra_x_m) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  const Material paint = road_paint(options.seed, contrast);
  Mesh mesh = flat(kStart_m, kEnd_m + 20.0F, kKerbRight_m, kKerbLeft_m, 0.0F, asphalt(options.seed, contrast));
  mesh.add(dashes(kCentreLine_m, 3.0F, 4.5F, paint));
  mesh.add(dashes(kOurEdge_m, 1.0F, 1.0F, paint));
  mesh.add(dashes(kOncomingEdge_m, 1.0F, 1.0F, paint));
  if (options.kind == SceneKind::crossing)
    for (float y = kKerbRight_m + 0.4F; y < kKerbLeft_m - 0.5F; y += 1.0F)
      mesh.add(flat(zebra_x_m - 1.75F, zebra_x_m + 1.75F, y, y + 0.5F, 2.0F * kPaint_m, paint));

  const Material slab{Pattern::slabs,
                      {0.22F, 0.215F, 0.205F},
                      {},
                      contrast,
                      0.45F,
                      0.0F,
                      static_cast<std::uint32_t>(options.seed) + 11};
  Material kerb = slab;
  kerb.pattern = Pattern::plaster;
  kerb.colour = {0.30F, 0.295F, 0.285F};
  for (const bool left : {false, true}) {
    const float edge = left ? kKerbLeft_m : kKerbRight_m, out = left ? 1.0F : -1.0F;
    const float stone_end = edge + out * 0.14F, far_end = edge + out * 12.0F;
    mesh.add(box({kStart_m, std::min(edge, stone_end), -0.2F},
                 {kEnd_m + 20.0F, std::max(edge, stone_end), kKerbHeight_m}, kerb));
    mesh.add(flat(kStart_m, kEnd_m + 20.0F, std::min(stone_end, far_end), std::max(stone_end, far_end),
                  kKerbHeight_m - 0.01F, slab));
  }
  return mesh;
}

/// House beside house along both sides, each set back a little differently.
std::vector<SceneObject> houses(const SceneOptions& options) {
  std::vector<SceneObject> objects;
  for (const bool left : {false, true}) {
    FlyRandom random(options.seed, kHousesPurpose, left ? 1 : 0, 0);
    for (float x = kStart_m + between(random, 0.0, 8.0); x < kEnd_m;) {
      const float length_m = between(random, 9.0, 17.0), height_m = between(random, 6.5, 13.5);
      const float set_back_m = between(random, 0.0, 0.5);
      const bool garden = random.uniform() < 0.15;
      const float contrast = static_cast<float>(options.texture_contrast);
      const float y = left ? kHousesLeft_m + set_back_m : kHousesRight_m - set_back_m;
      // Fronts are made facing +y; the left side of the street is turned around.
      const Placement place{{left ? x + length_m : x, y, kKerbHeight_m - 0.02F}, left ? kPi : 0.0F};
      if (garden) {
        objects.push_back(
            stand(ObjectClass::hedge, hedge(random, length_m, between(random, 1.3, 2.0), contrast), place));
      } else {
        objects.push_back(stand(ObjectClass::wall, house_front(random, length_m, height_m, contrast), place));
      }
      x += length_m + (garden ? 0.2F : 0.0F);
    }
  }
  return objects;
}

/// Where the street ends: a row of houses and trees too far away to count as obstacles.
SceneObject street_end(const SceneOptions& options) {
  FlyRandom random(options.seed, kHousesPurpose, 2, 0);
  Mesh mesh;
  for (float y = -60.0F; y < 70.0F;) {
    const float length_m = between(random, 10.0, 18.0), height_m = between(random, 7.0, 13.0);
    mesh.add(placed(house_front(random, length_m, height_m, static_cast<float>(options.texture_contrast)),
                    {{kEnd_m + 18.0F, y, 0}, kPi / 2.0F}));
    y += length_m;
  }
  return scenery(std::move(mesh), ObjectClass::backdrop);
}

enum class Lanes { all, parking };

std::vector<SceneObject> cars(const SceneOptions& options, Lanes lanes, float zebra_x_m, Taken& taken) {
  std::vector<SceneObject> objects;
  const auto contrast = static_cast<float>(options.texture_contrast);
  for (std::uint32_t i = 0; static_cast<int>(i) < options.cars; ++i) {
    FlyRandom random(options.seed, kCarsPurpose, 0, i);
    const Mesh mesh = car(random, contrast);
    for (int attempt = 0; attempt < 40; ++attempt) {
      const double lane = lanes == Lanes::all ? random.uniform() : 0.75 * random.uniform();
      Placement place;
      if (lane < 0.45) {
        place = {{between(random, 7.0, 60.0), kParkedRight_m + between(random, -0.1, 0.1), 0},
                 between(random, -0.03, 0.03)};
      } else if (lane < 0.75) {
        place = {{between(random, 10.0, 60.0), kParkedLeft_m + between(random, -0.1, 0.1), 0},
                 kPi + between(random, -0.03, 0.03)};
      } else if (lane < 0.9) {
        place = {{between(random, 14.0, 60.0), 3.3F, 0}, kPi};
      } else {
        place = {{between(random, 26.0, 60.0), 0.0F, 0}, 0.0F};
      }
      const float x = place.position.x, y = place.position.y;
      const bool on_zebra = options.kind == SceneKind::crossing && std::abs(x - zebra_x_m) < 5.5F;
      if (on_zebra || !taken.is_free(x - 1.5F, y, 1.3F) || !taken.is_free(x + 1.5F, y, 1.3F)) continue;
      taken.take_car(x, y);
      objects.push_back(stand(ObjectClass::car, mesh, place));
      break;
    }
  }
  return objects;
}

std::vector<SceneObject> poles(const SceneOptions& options, Taken& taken) {
  std::vector<SceneObject> objects;
  for (std::uint32_t i = 0; static_cast<int>(i) < options.poles; ++i) {
    FlyRandom random(options.seed, kPolesPurpose, 0, i);
    for (int attempt = 0; attempt < 40; ++attempt) {
      const bool left = random.uniform() < 0.5;
      const float x = between(random, 8.0, 50.0);
      const float y = left ? kKerbLeft_m + 0.45F : kKerbRight_m - 0.45F;
      if (!taken.is_free(x, y, 0.5F)) continue;
      taken.circles.push_back({x, y, 0.25F});
      const double pick = random.uniform();
      const Mesh mesh = pick < 0.45 ? lamp_post(random) : pick < 0.75 ? sign_post(random) : bollard(random);
      // Lamps reach over the road; signs face the traffic as they are made.
      const float yaw = pick < 0.45 && left ? kPi : 0.0F;
      objects.push_back(stand(ObjectClass::pole, mesh, {{x, y, kKerbHeight_m - 0.01F}, yaw}));
      break;
    }
  }
  return objects;
}

std::vector<SceneObject> trees(const SceneOptions& options, Taken& taken) {
  std::vector<SceneObject> objects;
  for (std::uint32_t i = 0; static_cast<int>(i) < options.trees; ++i) {
    FlyRandom random(options.seed, kTreesPurpose, 0, i);
    for (int attempt = 0; attempt < 40; ++attempt) {
      const bool left = random.uniform() < 0.6;
      const float x = between(random, 11.0, 65.0);
      const float y = left ? kKerbLeft_m + 0.8F : kKerbRight_m - 0.8F;
      if (!taken.is_free(x, y, 1.5F)) continue;
      taken.circles.push_back({x, y, 0.35F});
      const float yaw = between(random, -kPi, kPi);
      objects.push_back(stand(ObjectClass::tree, tree(random, static_cast<float>(options.texture_contrast)),
                              {{x, y, kKerbHeight_m - 0.01F}, yaw}));
      break;
    }
  }
  return objects;
}

/// One of two numbers, as likely as the other.
float either(FlyRandom& random, float one, float other) { return random.uniform() < 0.5 ? one : other; }

/// A place where a person walks, and where to.
Placement walk(FlyRandom& random, const SceneOptions& options, float zebra_x_m) {
  const float x = between(random, options.people_min_range_m, options.people_max_range_m);
  const double where = random.uniform();
  if (options.kind == SceneKind::crossing && where < 0.5) {
    const float across = either(random, 0.5F, -0.5F) * kPi, yaw = across + between(random, -0.15, 0.15);
    return {{zebra_x_m + between(random, -1.5, 1.5), between(random, kKerbRight_m + 0.3, kKerbLeft_m - 0.3), 0}, yaw};
  }
  const float way = either(random, 0.0F, kPi), along = way + between(random, -0.25, 0.25);
  if (where < 0.65) return {{x, between(random, kKerbRight_m - 2.6, kKerbRight_m - 0.4), 0}, along};
  if (where < 0.82) return {{x, between(random, kKerbLeft_m + 0.4, kKerbLeft_m + 2.6), 0}, along};
  const float y = between(random, kKerbRight_m + 0.2, kKerbLeft_m - 0.2);
  const float across = either(random, 0.5F, -0.5F) * kPi;
  return {{x, y, 0}, across + between(random, -0.4, 0.4)};
}

std::vector<SceneObject> people(const SceneOptions& options, float zebra_x_m, Taken& taken) {
  std::vector<SceneObject> objects;
  const double left_edge = 0.47 * options.width_px / options.focal_px;  // leaves room for the person's width
  for (std::uint32_t i = 0; static_cast<int>(i) < options.people; ++i) {
    FlyRandom random(options.seed, kPeoplePurpose, 0, i);
    const bool child = random.uniform() < options.children;
    const Mesh mesh = person(random_look(random, child, static_cast<float>(options.texture_contrast)));
    for (int attempt = 0; attempt < 60; ++attempt) {
      Placement place = walk(random, options, zebra_x_m);
      const float x = place.position.x, y = place.position.y;
      // Most people should be seen: only one try in eight may end behind something.
      const bool in_sight = taken.is_in_sight(x, y) || attempt % 8 == 7;
      if (std::abs(y) > left_edge * x || !taken.is_free(x, y, 0.45F) || !in_sight) continue;
      place.position.z = ground_z_m(y);
      taken.circles.push_back({x, y, 0.35F});
      objects.push_back(stand(ObjectClass::pedestrian, mesh, place));
      break;
    }
  }
  return objects;
}

}  // namespace

SceneObject scenery(Mesh mesh, ObjectClass kind) {
  SceneObject object;
  object.kind = kind;
  object.mesh = std::move(mesh);
  return object;
}

SceneObject stand(ObjectClass kind, const Mesh& mesh, const Placement& placement) {
  const Bounds bounds = bounds_of(mesh);
  const Vec3 size = bounds.high - bounds.low, middle = (bounds.low + bounds.high) * 0.5F;
  const float c = std::cos(placement.yaw_rad), s = std::sin(placement.yaw_rad);
  SceneObject object;
  object.kind = kind;
  object.mesh = placed(mesh, placement);
  object.x_m = placement.position.x + c * middle.x - s * middle.y;
  object.y_m = placement.position.y + s * middle.x + c * middle.y;
  object.z_m = placement.position.z + bounds.low.z;
  object.yaw_rad = placement.yaw_rad;
  object.length_m = size.x;
  object.width_m = size.y;
  object.height_m = size.z;
  return object;
}

std::vector<SceneObject> street(const SceneOptions& options) {
  FlyRandom random(options.seed, kPeoplePurpose, 1, 0);
  const float zebra_x_m = between(random, 10.0, 18.0);
  std::vector<SceneObject> objects;
  objects.push_back(scenery(street_ground(options, zebra_x_m)));
  objects.push_back(street_end(options));
  Taken taken;
  const auto add = [&](std::vector<SceneObject> more) {
    for (auto& object : more) objects.push_back(std::move(object));
  };
  add(houses(options));
  add(cars(options, Lanes::all, zebra_x_m, taken));
  add(poles(options, taken));
  add(trees(options, taken));
  add(people(options, zebra_x_m, taken));
  return objects;
}

std::vector<SceneObject> standing_street(const SceneOptions& options, float crossing_x_m) {
  constexpr float kBehindCar_m = 3.2F;  // from the middle of the parked car to who steps out behind it
  SceneOptions street_options = options;
  street_options.kind = SceneKind::street;
  std::vector<SceneObject> objects;
  objects.push_back(scenery(street_ground(street_options, 0.0F)));
  objects.push_back(street_end(street_options));
  Taken taken;
  FlyRandom random(options.seed, kMoversPurpose, 2, 0);
  const float hiding_x_m = crossing_x_m - kBehindCar_m;
  objects.push_back(stand(ObjectClass::car, car(random, static_cast<float>(options.texture_contrast)),
                          {{hiding_x_m, kParkedRight_m, 0}, 0.0F}));
  taken.take_car(hiding_x_m, kParkedRight_m);
  for (float y = kKerbRight_m - 1.0F; y < kKerbLeft_m + 1.0F; y += 0.5F)
    taken.circles.push_back({crossing_x_m, y, 0.5F});
  const auto add = [&](std::vector<SceneObject> more) {
    for (auto& object : more) objects.push_back(std::move(object));
  };
  add(houses(street_options));
  add(cars(street_options, Lanes::parking, 0.0F, taken));
  add(poles(street_options, taken));
  add(trees(street_options, taken));
  return objects;
}

std::vector<SceneObject> country_road(const SceneOptions& options) {
  const auto contrast = static_cast<float>(options.texture_contrast);
  const Material paint = road_paint(options.seed, contrast);
  const Material grass{Pattern::speckle,
                       {0.10F, 0.15F, 0.045F},
                       {},
                       0.8F * contrast,
                       0.6F,
                       0.0F,
                       static_cast<std::uint32_t>(options.seed) + 21};
  constexpr float kFar_m = 900.0F, kRight_m = -2.2F, kLeft_m = 5.5F;
  Mesh mesh = flat(kStart_m, kFar_m, kRight_m, kLeft_m, 0.0F, asphalt(options.seed, contrast));
  mesh.add(flat(kStart_m, kFar_m, -kFar_m, kRight_m, 0.0F, grass));
  mesh.add(flat(kStart_m, kFar_m, kLeft_m, kFar_m, 0.0F, grass));
  mesh.add(dashes(kCentreLine_m, 3.0F, 4.5F, paint));
  for (const float y : {kRight_m + 0.25F, kLeft_m - 0.25F})
    mesh.add(flat(kStart_m, kFar_m, y - 0.06F, y + 0.06F, kPaint_m, paint));
  std::vector<SceneObject> objects;
  objects.push_back(scenery(std::move(mesh)));
  return objects;
}

}  // namespace flies::synth
