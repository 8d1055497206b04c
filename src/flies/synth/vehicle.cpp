#include "flies/synth/vehicle.hpp"

#include <array>
#include <initializer_list>

namespace flies::synth {
namespace {

/// Linear reflectance of car paints.
constexpr std::array<Vec3, 8> kPaints = {{{0.65F, 0.66F, 0.68F},
                                          {0.35F, 0.36F, 0.38F},
                                          {0.03F, 0.03F, 0.035F},
                                          {0.40F, 0.03F, 0.03F},
                                          {0.04F, 0.09F, 0.28F},
                                          {0.10F, 0.11F, 0.12F},
                                          {0.05F, 0.16F, 0.10F},
                                          {0.45F, 0.38F, 0.25F}}};

/// The car's measures; x from its middle.
struct Shape {
  float half_length, half_width, roof_z, belt_z, wheel_x, wheel_radius;
  float screen_low_x, screen_high_x;  ///< foot and top of the windscreen
  float back_high_x, back_low_x;      ///< top and foot of the rear window
  float tail_z;                       ///< of the boot lid
};

Shape random_shape(FlyRandom& random) {
  const auto between = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
  Shape s{};
  const bool hatchback = random.uniform() < 0.55;
  s.half_length = hatchback ? between(1.9, 2.1) : between(2.15, 2.4);
  s.half_width = between(0.84, 0.91);
  s.roof_z = between(1.42, 1.54);
  s.belt_z = 0.90F;
  s.wheel_radius = 0.32F;
  s.wheel_x = s.half_length - 0.78F;
  s.screen_low_x = s.half_length - 1.05F;
  s.screen_high_x = s.screen_low_x - 0.72F;
  s.back_low_x = hatchback ? -s.half_length + 0.12F : -s.half_length + 0.62F;
  s.back_high_x = s.back_low_x + (hatchback ? 0.38F : 0.60F);
  s.tail_z = hatchback ? 0.93F : 0.98F;
  return s;
}

/// Cross-section of the body at x: a rounded rectangle from `low_z` to `high_z`.
Ring section(float x, float half_width, float low_z, float high_z) {
  return {{x, 0, 0.5F * (low_z + high_z)}, {0, half_width, 0}, {0, 0, 0.5F * (high_z - low_z)}};
}

Mesh body(const Shape& s, const Material& paint) {
  const float l = s.half_length, w = s.half_width;
  const std::array rings = {
      section(-l, w * 0.82F, 0.42F, s.tail_z - 0.10F), section(-l + 0.05F, w * 0.93F, 0.32F, s.tail_z - 0.04F),
      section(-l + 0.25F, w * 0.98F, 0.26F, s.tail_z), section(s.back_low_x + 0.35F, w, 0.22F, s.belt_z + 0.06F),
      section(0.0F, w, 0.20F, s.belt_z + 0.03F),       section(s.screen_low_x, w, 0.22F, s.belt_z + 0.02F),
      section(l - 0.45F, w * 0.98F, 0.24F, 0.82F),     section(l - 0.12F, w * 0.92F, 0.27F, 0.72F),
      section(l - 0.02F, w * 0.82F, 0.34F, 0.62F),     section(l, w * 0.74F, 0.38F, 0.58F)};
  return loft(rings, paint, 32, 5.0F);
}

/// Horizontal section of the cabin from `back_x` to `front_x`.
Ring cabin_section(float back_x, float front_x, float half_width, float z) {
  return {{0.5F * (back_x + front_x), 0, z}, {0.5F * (front_x - back_x), 0, 0}, {0, half_width, 0}};
}

Mesh cabin(const Shape& s, const Material& paint, const Material& glass) {
  const float w = s.half_width;
  const float roof_low = s.roof_z - 0.09F;
  Mesh mesh;
  const std::array windows = {cabin_section(s.back_low_x, s.screen_low_x, w * 0.94F, s.belt_z - 0.02F),
                              cabin_section(s.back_high_x, s.screen_high_x, w * 0.76F, roof_low)};
  mesh.add(loft(windows, glass, 40, 9.0F));
  const std::array roof = {cabin_section(s.back_high_x - 0.03F, s.screen_high_x + 0.03F, w * 0.77F, roof_low),
                           cabin_section(s.back_high_x, s.screen_high_x, w * 0.76F, roof_low + 0.05F),
                           cabin_section(s.back_high_x + 0.2F, s.screen_high_x - 0.25F, w * 0.62F, s.roof_z)};
  mesh.add(loft(roof, paint, 40, 7.0F));
  // Pillars run from the belt to the roof along the corners of the cabin and beside the middle of it.
  for (const float side : {-1.0F, 1.0F}) {
    const auto pillar = [&](float low_x, float high_x, float radius) {
      return cylinder({low_x, side * w * 0.925F, s.belt_z - 0.02F}, {high_x, side * w * 0.755F, roof_low + 0.02F},
                      radius, paint, 8);
    };
    const float middle_x = 0.5F * (s.screen_low_x + s.back_low_x) - 0.1F;
    mesh.add(pillar(s.screen_low_x - 0.03F, s.screen_high_x, 0.04F));
    mesh.add(pillar(middle_x, middle_x, 0.05F));
    mesh.add(pillar(s.back_low_x + 0.08F, s.back_high_x + 0.04F, 0.07F));
    mesh.add(ellipsoid({s.screen_low_x - 0.18F, side * (w + 0.09F), s.belt_z + 0.06F}, {0.06F, 0.10F, 0.07F}, paint));
  }
  return mesh;
}

Mesh wheels(const Shape& s, std::uint32_t seed) {
  const Material rubber{Pattern::plain, {0.02F, 0.02F, 0.02F}, {}, 1.0F, 0.1F, 0.0F, seed};
  const Material rim{Pattern::speckle, {0.38F, 0.38F, 0.40F}, {}, 0.9F, 0.16F, 0.15F, seed + 1};
  const Material arch{Pattern::plain, {0.008F, 0.008F, 0.008F}, {}, 1.0F, 0.1F, 0.0F, seed + 2};
  Mesh mesh;
  for (const float x : {-s.wheel_x, s.wheel_x}) {
    for (const float side : {-1.0F, 1.0F}) {
      const auto disc = [&](float inner_y, float outer_y, float radius, float z, const Material& material) {
        return cylinder({x, side * inner_y, z}, {x, side * outer_y, z}, radius, material, 24);
      };
      const float w = s.half_width, r = s.wheel_radius;
      mesh.add(disc(w - 0.3F, w + 0.004F, r + 0.06F, r + 0.03F, arch));
      mesh.add(disc(w - 0.2F, w + 0.014F, r, r, rubber));
      mesh.add(disc(w - 0.1F, w + 0.020F, r * 0.66F, r, rim));
      mesh.add(disc(w - 0.1F, w + 0.026F, r * 0.15F, r, rubber));
    }
  }
  return mesh;
}

Mesh trimmings(const Shape& s, std::uint32_t seed) {
  const auto plain = [&](Vec3 colour, float gloss = 0.0F) {
    return Material{Pattern::plain, colour, {}, 1.0F, 0.1F, gloss, seed};
  };
  const float l = s.half_length, w = s.half_width;
  const Material black = plain({0.012F, 0.012F, 0.013F});
  Mesh mesh;
  for (const float side : {-1.0F, 1.0F}) {
    const float y = side * w * 0.66F;
    mesh.add(ellipsoid({l - 0.07F, y, 0.62F}, {0.07F, 0.17F, 0.07F}, plain({0.8F, 0.82F, 0.85F}, 0.6F)));
    mesh.add(ellipsoid({-l + 0.06F, side * w * 0.74F, s.tail_z - 0.22F}, {0.08F, 0.13F, 0.10F},
                       plain({0.45F, 0.012F, 0.012F}, 0.3F)));
    mesh.add(box({-0.15F, side > 0 ? w - 0.01F : -w - 0.008F, 0.74F},
                 {0.02F, side > 0 ? w + 0.008F : -w + 0.01F, 0.77F}, black));  // door handle
    mesh.add(box({-s.wheel_x + 0.42F, side > 0 ? w - 0.02F : -w - 0.006F, 0.24F},
                 {s.wheel_x - 0.42F, side > 0 ? w + 0.006F : -w + 0.02F, 0.32F}, black));  // sill
  }
  mesh.add(box({l - 0.05F, -w * 0.40F, 0.47F}, {l + 0.006F, w * 0.40F, 0.56F}, black));  // grille
  mesh.add(box({-l - 0.02F, -w * 0.85F, 0.38F}, {-l + 0.1F, w * 0.85F, 0.46F}, black));  // bumper
  Material plate{Pattern::plate, {0.75F, 0.75F, 0.72F}, {0.02F, 0.02F, 0.02F}, 1.0F, 0.05F, 0.0F, seed + 9};
  for (const float end : {-1.0F, 1.0F}) {
    Mesh sign = box({-0.012F, -0.26F, -0.055F}, {0.012F, 0.26F, 0.055F}, plate);
    const Vec3 place = end > 0 ? Vec3{l + 0.008F, 0, 0.42F} : Vec3{-l - 0.008F, 0, 0.62F};
    for (auto& p : sign.positions) p = p + place;
    mesh.add(sign);
  }
  return mesh;
}

}  // namespace

Mesh car(FlyRandom& random, float texture_contrast) {
  const Shape shape = random_shape(random);
  const Material paint{Pattern::plain, kPaints[random.below(kPaints.size())], {}, 1.6F * texture_contrast, 0.3F, 0.35F,
                       random.bits()};
  const Material glass{Pattern::plain, {0.03F, 0.035F, 0.04F}, {}, texture_contrast, 0.3F, 0.6F, random.bits()};
  Mesh mesh = body(shape, paint);
  mesh.add(cabin(shape, paint, glass));
  mesh.add(wheels(shape, random.bits()));
  mesh.add(trimmings(shape, random.bits()));
  return mesh;
}

}  // namespace flies::synth
