#include "flies/synth/person.hpp"

#include <array>
#include <initializer_list>
#include <iterator>
#include <numbers>

namespace flies::synth {
namespace {

constexpr float kModelHeight_m = 1.75F;  ///< the numbers below are for a person of this height, shoes included
constexpr Vec3 kLeft{0, 1, 0};

/// Direction in the x-z plane: `angle_rad` forward from hanging straight down.
Vec3 hanging(float angle_rad) { return {std::sin(angle_rad), 0.0F, -std::cos(angle_rad)}; }

/// The joints of one leg, hip first.
struct Leg {
  Vec3 hip, knee, ankle;
  float foot_rad;  ///< toes down when positive
};

Leg pose_leg(float side, float phase, float stride) {
  // Hip swing of 24 degrees to both sides; the knee bends while the leg swings forward.
  const float thigh_rad = stride * (0.42F * std::sin(phase) + 0.03F);
  const float swing = std::max(0.0F, std::cos(phase));
  const float knee_rad = 0.06F + stride * (0.85F * swing * swing + 0.12F * std::max(0.0F, -std::sin(phase)));
  Leg leg;
  leg.hip = {0.0F, side * 0.088F, 0.90F};
  leg.knee = leg.hip + hanging(thigh_rad) * 0.42F;
  leg.ankle = leg.knee + hanging(thigh_rad - knee_rad) * 0.40F;
  leg.foot_rad = std::clamp(knee_rad - thigh_rad, -0.3F, 0.7F) * 0.7F;
  return leg;
}

Mesh leg_mesh(const Leg& leg, const PersonLook& look, float girth, bool bare) {
  const Material& cloth = bare ? look.skin : look.legs;
  const float loose = bare ? 0.85F : 1.0F;
  const auto at = [&](const Vec3& p, float side, float depth) {
    return LimbPoint{p, side * girth * loose, depth * girth * loose};
  };
  const Vec3 shin = leg.ankle - leg.knee;
  const std::array points = {at(leg.hip + Vec3{0, 0, 0.08F}, 0.085F, 0.10F),
                             at(mix(leg.hip, leg.knee, 0.2F), 0.088F, 0.098F),
                             at(mix(leg.hip, leg.knee, 0.6F), 0.075F, 0.082F),
                             at(leg.knee, 0.060F, 0.066F),
                             at(leg.knee + shin * 0.3F + Vec3{-0.012F, 0, 0}, 0.060F, 0.068F),
                             at(leg.knee + shin * 0.75F, 0.051F, 0.056F),
                             at(leg.ankle + shin * 0.04F, 0.050F, 0.060F)};
  Mesh mesh = limb(points, kLeft, cloth);

  // The shoe: a loft from heel to toe, turned with the foot.
  const float c = std::cos(leg.foot_rad), s = std::sin(leg.foot_rad);
  const auto foot = [&](float x, float z) { return leg.ankle + Vec3{c * x + s * z, 0, -s * x + c * z}; };
  const std::array shoe = {
      LimbPoint{foot(-0.085F, -0.035F), 0.015F, 0.015F}, LimbPoint{foot(-0.07F, -0.025F), 0.036F, 0.052F},
      LimbPoint{foot(0.0F, -0.02F), 0.042F, 0.058F},     LimbPoint{foot(0.09F, -0.042F), 0.048F, 0.036F},
      LimbPoint{foot(0.16F, -0.052F), 0.042F, 0.024F},   LimbPoint{foot(0.195F, -0.057F), 0.012F, 0.010F}};
  mesh.add(limb(shoe, kLeft, look.shoes));
  return mesh;
}

Mesh arm_mesh(float side, float swing_rad, const PersonLook& look, float girth) {
  const Vec3 outward{0, side * 0.10F, 0};
  const Vec3 shoulder{-0.005F, side * 0.176F * girth, 1.395F};
  const Vec3 elbow = shoulder + normalized(hanging(swing_rad) + outward) * 0.29F;
  const Vec3 wrist = elbow + normalized(hanging(swing_rad + 0.25F + 0.35F * std::max(0.0F, swing_rad))) * 0.25F;
  const bool sleeves = look.garment != Garment::shirt;
  const float loose = sleeves ? 1.18F : 1.0F;
  const auto at = [&](const Vec3& p, float radius) {
    return LimbPoint{p, radius * girth * loose, radius * girth * loose};
  };
  const Vec3 half_way = mix(shoulder, elbow, 0.55F);
  Mesh mesh;
  const std::array upper = {
      at(shoulder + Vec3{0, -side * 0.035F, 0.04F}, 0.02F), at(shoulder + Vec3{0, -side * 0.012F, 0.022F}, 0.044F),
      at(shoulder + Vec3{0, 0, -0.02F}, 0.053F), at(mix(shoulder, elbow, 0.3F), 0.052F), at(half_way, 0.050F)};
  mesh.add(limb(upper, {1, 0, 0}, look.top));
  const std::array lower = {at(half_way, 0.046F), at(elbow, 0.042F), at(mix(elbow, wrist, 0.35F), 0.041F),
                            at(wrist, 0.030F)};
  mesh.add(limb(lower, {1, 0, 0}, sleeves ? look.top : look.skin));
  const Vec3 finger = wrist + normalized(wrist - elbow) * 0.16F;
  const std::array hand = {LimbPoint{wrist, 0.024F, 0.022F}, LimbPoint{mix(wrist, finger, 0.4F), 0.040F, 0.022F},
                           LimbPoint{mix(wrist, finger, 0.75F), 0.034F, 0.018F}, LimbPoint{finger, 0.012F, 0.010F}};
  mesh.add(limb(hand, {1, 0, 0}, look.skin, 10));
  return mesh;
}

struct Slice {
  float z, half_width, half_depth, x;
};

Mesh trunk_part(std::initializer_list<Slice> slices, float girth, const Material& material) {
  std::vector<Ring> rings;
  for (const auto& s : slices)
    rings.push_back({{s.x, 0, s.z}, {s.half_depth * girth, 0, 0}, {0, s.half_width * girth, 0}});
  return loft(rings, material, 22, 2.4F);
}

Mesh trunk_mesh(const PersonLook& look, float girth, float stride_m) {
  Mesh mesh;
  const float spread = 0.5F * stride_m;
  mesh.add(trunk_part({{0.83F, 0.11F, 0.09F, 0.0F},
                       {0.88F, 0.168F, 0.115F, -0.01F},
                       {0.96F, 0.170F, 0.120F, -0.015F},
                       {1.06F, 0.148F, 0.105F, 0.0F}},
                      girth, look.legs));
  switch (look.garment) {
    case Garment::shirt:
      mesh.add(trunk_part({{0.97F, 0.172F, 0.122F, -0.01F}, {1.08F, 0.158F, 0.112F, 0.0F}}, girth, look.top));
      break;
    case Garment::jacket:
      mesh.add(trunk_part({{0.84F, 0.192F, 0.140F, -0.01F},
                           {0.90F, 0.194F, 0.142F, -0.012F},
                           {1.00F, 0.178F, 0.130F, 0.0F},
                           {1.08F, 0.172F, 0.124F, 0.0F}},
                          girth, look.top));
      break;
    case Garment::coat:
      mesh.add(trunk_part({{0.50F, 0.200F, 0.165F + 0.55F * spread, 0.0F},
                           {0.70F, 0.196F, 0.150F + 0.35F * spread, 0.0F},
                           {0.92F, 0.190F, 0.140F, -0.01F},
                           {1.08F, 0.168F, 0.120F, 0.0F}},
                          girth, look.top));
      break;
    case Garment::skirt:
      mesh.add(trunk_part({{0.50F, 0.215F, 0.170F + 0.5F * spread, 0.0F},
                           {0.72F, 0.200F, 0.150F + 0.3F * spread, 0.0F},
                           {0.92F, 0.176F, 0.124F, -0.01F},
                           {1.07F, 0.142F, 0.100F, 0.0F}},
                          girth, look.legs));
      mesh.add(trunk_part({{1.02F, 0.152F, 0.112F, 0.0F}, {1.08F, 0.154F, 0.110F, 0.0F}}, girth, look.top));
      break;
  }
  const float loose = look.garment == Garment::shirt || look.garment == Garment::skirt ? 1.0F : 1.06F;
  mesh.add(trunk_part({{1.04F, 0.154F, 0.110F, 0.0F},
                       {1.18F, 0.166F, 0.118F, 0.005F},
                       {1.30F, 0.184F, 0.122F, 0.005F},
                       {1.38F, 0.180F, 0.112F, -0.002F},
                       {1.43F, 0.148F, 0.094F, -0.008F},
                       {1.465F, 0.105F, 0.076F, -0.010F},
                       {1.495F, 0.066F, 0.062F, -0.008F}},
                      girth * loose, look.top));
  return mesh;
}

Mesh head_mesh(const PersonLook& look) {
  const Vec3 centre{0.015F, 0, 1.625F};
  Mesh mesh;
  const std::array neck = {LimbPoint{{-0.015F, 0, 1.45F}, 0.056F, 0.058F}, LimbPoint{{0.0F, 0, 1.56F}, 0.052F, 0.056F}};
  mesh.add(limb(neck, kLeft, look.skin));
  mesh.add(ellipsoid(centre, {0.094F, 0.074F, 0.116F}, look.skin));
  mesh.add(ellipsoid(centre + Vec3{0.035F, 0, -0.055F}, {0.058F, 0.055F, 0.058F}, look.skin));     // jaw
  mesh.add(ellipsoid(centre + Vec3{0.096F, 0, -0.015F}, {0.018F, 0.013F, 0.024F}, look.skin, 8));  // nose
  for (const float side : {-1.0F, 1.0F}) {
    mesh.add(ellipsoid(centre + Vec3{0.083F, side * 0.031F, 0.014F}, {0.010F, 0.015F, 0.008F}, look.hair, 8));
    mesh.add(ellipsoid(centre + Vec3{0.0F, side * 0.074F, -0.005F}, {0.020F, 0.011F, 0.030F}, look.skin, 8));
  }
  const float top_m = kModelHeight_m - centre.z;
  mesh.add(ellipsoid(centre + Vec3{-0.017F, 0, 0.028F}, {0.100F, 0.083F, top_m - 0.028F}, look.hair));
  if (look.long_hair)
    mesh.add(trunk_part({{1.42F, 0.075F, 0.030F, -0.085F},
                         {1.50F, 0.090F, 0.045F, -0.075F},
                         {1.62F, 0.088F, 0.065F, -0.045F},
                         {1.70F, 0.060F, 0.050F, -0.020F}},
                        1.0F, look.hair));
  if (look.hat) mesh.add(ellipsoid(centre + Vec3{-0.012F, 0, 0.055F}, {0.106F, 0.092F, top_m - 0.053F}, look.bag));
  return mesh;
}

/// Clothes as one sees them in streets: mostly dark and muted, some bright. Linear reflectance.
constexpr std::array<Vec3, 14> kClothColours = {{{0.015F, 0.016F, 0.02F},
                                                 {0.02F, 0.03F, 0.07F},
                                                 {0.05F, 0.05F, 0.055F},
                                                 {0.13F, 0.13F, 0.14F},
                                                 {0.03F, 0.06F, 0.16F},
                                                 {0.16F, 0.10F, 0.05F},
                                                 {0.04F, 0.07F, 0.04F},
                                                 {0.35F, 0.03F, 0.03F},
                                                 {0.55F, 0.53F, 0.50F},
                                                 {0.70F, 0.70F, 0.68F},
                                                 {0.10F, 0.25F, 0.45F},
                                                 {0.45F, 0.30F, 0.04F},
                                                 {0.22F, 0.02F, 0.06F},
                                                 {0.30F, 0.24F, 0.16F}}};
constexpr std::array<Vec3, 6> kTrouserColours = {{{0.02F, 0.03F, 0.07F},
                                                  {0.018F, 0.018F, 0.02F},
                                                  {0.06F, 0.09F, 0.16F},
                                                  {0.09F, 0.085F, 0.08F},
                                                  {0.25F, 0.20F, 0.13F},
                                                  {0.035F, 0.035F, 0.04F}}};
constexpr std::array<Vec3, 4> kSkinColours = {
    {{0.55F, 0.33F, 0.23F}, {0.48F, 0.27F, 0.17F}, {0.28F, 0.14F, 0.08F}, {0.10F, 0.05F, 0.03F}}};
constexpr std::array<Vec3, 4> kHairColours = {
    {{0.015F, 0.012F, 0.01F}, {0.06F, 0.035F, 0.02F}, {0.25F, 0.17F, 0.08F}, {0.30F, 0.30F, 0.30F}}};

template <std::size_t count>
const Vec3& pick(FlyRandom& random, const std::array<Vec3, count>& colours) {
  return colours[random.below(count)];
}

}  // namespace

PersonLook random_look(FlyRandom& random, bool child, float texture_contrast) {
  PersonLook look;
  const auto between = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  look.height_m = child ? between(1.0, 1.45) : between(1.55, 1.95);
  look.girth = between(0.92, 1.15);
  look.stride = random.uniform() < 0.15 ? 0.1F : between(0.7, 1.1);
  look.phase_rad = between(0.0, 2.0 * std::numbers::pi);
  const double garment = random.uniform();
  look.garment = garment < 0.45   ? Garment::jacket
                 : garment < 0.7  ? Garment::shirt
                 : garment < 0.88 ? Garment::coat
                                  : Garment::skirt;
  const auto cloth = [&](const Vec3& colour) {
    return Material{Pattern::cloth, colour, {}, texture_contrast, 0.05F, 0.0F, random.bits()};
  };
  look.top = cloth(pick(random, kClothColours));
  const double pattern = random.uniform();
  if (pattern > 0.75) {
    look.top.pattern = pattern > 0.88 ? Pattern::stripes : Pattern::checks;
    look.top.second = pick(random, kClothColours);
    look.top.scale_m = between(0.025, 0.06);
  }
  look.legs = cloth(pick(random, kTrouserColours));
  look.skin = {Pattern::plain, pick(random, kSkinColours), {}, texture_contrast, 0.1F, 0.02F, random.bits()};
  look.hair = {Pattern::speckle, pick(random, kHairColours), {}, texture_contrast, 0.03F, 0.0F, random.bits()};
  look.shoes = cloth(random.uniform() < 0.75 ? Vec3{0.02F, 0.018F, 0.016F} : Vec3{0.6F, 0.6F, 0.6F});
  look.long_hair = random.uniform() < 0.4;
  look.backpack = random.uniform() < 0.2;
  look.hat = random.uniform() < 0.12;
  look.bag = cloth(pick(random, kClothColours));
  return look;
}

Mesh person(const PersonLook& look) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float girth = look.girth;
  const Leg left = pose_leg(1.0F, look.phase_rad, look.stride);
  const Leg right = pose_leg(-1.0F, look.phase_rad + kPi, look.stride);
  const float arm_rad = 0.40F * look.stride * std::sin(look.phase_rad);
  const bool bare_legs = look.garment == Garment::skirt;

  Mesh mesh = leg_mesh(left, look, girth, bare_legs);
  mesh.add(leg_mesh(right, look, girth, bare_legs));
  mesh.add(trunk_mesh(look, girth, std::abs(left.ankle.x - right.ankle.x)));
  mesh.add(arm_mesh(1.0F, -arm_rad, look, girth));
  mesh.add(arm_mesh(-1.0F, arm_rad, look, girth));
  mesh.add(head_mesh(look));
  if (look.backpack) {
    const std::array pack = {Ring{{-0.185F, 0, 1.02F}, {0.055F, 0, 0}, {0, 0.10F, 0}},
                             Ring{{-0.20F, 0, 1.06F}, {0.085F, 0, 0}, {0, 0.15F, 0}},
                             Ring{{-0.19F, 0, 1.34F}, {0.080F, 0, 0}, {0, 0.145F, 0}},
                             Ring{{-0.165F, 0, 1.42F}, {0.045F, 0, 0}, {0, 0.10F, 0}}};
    mesh.add(loft(pack, look.bag, 18, 3.5F));
  }

  // The lower foot stands on the ground, and the whole is as tall as asked for.
  const Bounds bounds = bounds_of(mesh);
  const float sole_z_m = bounds.low.z;
  const float scale = look.height_m / (bounds.high.z - sole_z_m);
  for (auto& p : mesh.positions) p = (p - Vec3{0, 0, sole_z_m}) * scale;
  for (auto& t : mesh.texture) t = t * scale;
  return mesh;
}

}  // namespace flies::synth
