#include "flies/synth/street_parts.hpp"

#include <array>
#include <numbers>

#include "flies/synth/chance.hpp"
#include "flies/synth/noise.hpp"

namespace flies::synth {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

constexpr std::array<Vec3, 7> kWallColours = {{{0.62F, 0.56F, 0.44F},
                                               {0.55F, 0.52F, 0.48F},
                                               {0.60F, 0.42F, 0.28F},
                                               {0.42F, 0.44F, 0.45F},
                                               {0.66F, 0.62F, 0.55F},
                                               {0.50F, 0.36F, 0.30F},
                                               {0.38F, 0.42F, 0.36F}}};
constexpr std::array<Vec3, 3> kBrickColours = {{{0.30F, 0.11F, 0.07F}, {0.36F, 0.19F, 0.11F}, {0.24F, 0.13F, 0.10F}}};

Material wall_material(FlyRandom& random, float contrast) {
  if (random.uniform() < 0.4)
    return {
        Pattern::brick, kBrickColours[random.below(kBrickColours.size())], {0.42F, 0.40F, 0.37F}, contrast, 0.1F, 0.0F,
        random.bits()};
  return {Pattern::plaster, kWallColours[random.below(kWallColours.size())], {}, contrast, 0.1F, 0.0F, random.bits()};
}

/// A window or door with its frame, standing out of the wall y = 0.
Mesh opening(const Vec3& low, float width, float height, const Material& frame, const Material& pane, bool window) {
  constexpr float kFrame_m = 0.07F, kFrameOut_m = 0.06F, kPaneOut_m = 0.02F;
  const float x0 = low.x, x1 = low.x + width, z0 = low.z, z1 = low.z + height;
  Mesh mesh = box({x0, -0.05F, z0}, {x1, kPaneOut_m, z1}, pane);
  const auto bar = [&](float xa, float xb, float za, float zb) {
    mesh.add(box({xa, -0.05F, za}, {xb, kFrameOut_m, zb}, frame));
  };
  bar(x0 - kFrame_m, x0 + 0.02F, z0, z1);
  bar(x1 - 0.02F, x1 + kFrame_m, z0, z1);
  bar(x0 - kFrame_m, x1 + kFrame_m, z1, z1 + kFrame_m);
  if (window) {
    const float middle = 0.5F * (x0 + x1);
    bar(middle - 0.03F, middle + 0.03F, z0, z1);
    bar(x0, x1, z0 + 0.68F * height, z0 + 0.68F * height + 0.05F);
    mesh.add(box({x0 - 0.12F, -0.05F, z0 - 0.07F}, {x1 + 0.12F, 0.16F, z0}, frame));  // sill
  }
  return mesh;
}

}  // namespace

Mesh house_front(FlyRandom& random, float length_m, float height_m, float contrast) {
  const Material face = wall_material(random, contrast);
  Material trim = face;
  trim.pattern = Pattern::plaster;
  trim.colour = random.uniform() < 0.7 ? Vec3{0.68F, 0.66F, 0.62F} : Vec3{0.15F, 0.14F, 0.13F};
  Material glass{Pattern::speckle, {0.05F, 0.06F, 0.07F}, {}, 1.2F * contrast, 0.7F, 0.35F, random.bits()};
  const Material door{Pattern::plaster, {0.12F, 0.07F, 0.04F}, {}, contrast, 0.1F, 0.05F, random.bits()};

  Mesh mesh = box({0, -6.0F, 0}, {length_m, 0, height_m}, face);
  mesh.add(box({0, -0.1F, 0}, {length_m, 0.05F, 0.5F}, trim));                            // plinth
  mesh.add(box({0, -0.1F, height_m - 0.35F}, {length_m, 0.2F, height_m + 0.05F}, trim));  // cornice
  mesh.add(box({0, -0.1F, 3.25F}, {length_m, 0.07F, 3.45F}, trim));                       // band above the shops
  const float pitch_m = between(random, 1.9, 2.7), width_m = between(random, 0.9, 1.25);
  const float floor_m = between(random, 2.9, 3.3);
  const int columns = std::max(1, static_cast<int>((length_m - 0.6F) / pitch_m));
  const float margin_m = 0.5F * (length_m - static_cast<float>(columns) * pitch_m);
  const bool shops = random.uniform() < 0.4;
  const int door_column = static_cast<int>(random.below(static_cast<std::uint32_t>(columns)));
  for (int c = 0; c < columns; ++c) {
    const float x = margin_m + static_cast<float>(c) * pitch_m + 0.5F * (pitch_m - width_m);
    if (c == door_column) {
      mesh.add(opening({x, 0, 0.02F}, width_m, 2.3F, trim, door, false));
    } else if (shops) {
      glass.seed = random.bits();
      mesh.add(opening({x - 0.3F * (pitch_m - width_m), 0, 0.6F}, width_m + 0.6F * (pitch_m - width_m), 2.2F, trim,
                       glass, false));
    } else {
      glass.seed = random.bits();
      mesh.add(opening({x, 0, 1.05F}, width_m, 1.55F, trim, glass, true));
    }
    for (float z = 4.1F; z + 1.6F < height_m - 0.4F; z += floor_m) {
      glass.seed = random.bits();
      mesh.add(opening({x, 0, z}, width_m, 1.55F, trim, glass, true));
    }
  }
  return mesh;
}

Mesh wall(FlyRandom& random, float length_m, float height_m, float thickness_m, float contrast) {
  return box({0, -thickness_m, 0}, {length_m, 0, height_m}, wall_material(random, contrast));
}

Mesh lamp_post(FlyRandom& random) {
  const Material metal{Pattern::speckle, {0.16F, 0.17F, 0.17F}, {}, 0.6F, 0.25F, 0.1F, random.bits()};
  const float height_m = between(random, 6.0, 8.0);
  const std::array shaft = {LimbPoint{{0, 0, 0}, 0.10F, 0.10F},
                            LimbPoint{{0, 0, 0.9F}, 0.10F, 0.10F},
                            LimbPoint{{0, 0, 1.0F}, 0.07F, 0.07F},
                            LimbPoint{{0, 0, height_m - 0.4F}, 0.05F, 0.05F},
                            LimbPoint{{0, 0.3F, height_m - 0.1F}, 0.04F, 0.04F},
                            LimbPoint{{0, 1.3F, height_m}, 0.035F, 0.035F}};
  Mesh mesh = limb(shaft, {1, 0, 0}, metal);
  mesh.add(ellipsoid({0, 1.5F, height_m}, {0.14F, 0.38F, 0.07F}, metal));
  return mesh;
}

Mesh sign_post(FlyRandom& random) {
  const Material metal{Pattern::speckle, {0.33F, 0.34F, 0.35F}, {}, 0.5F, 0.2F, 0.1F, random.bits()};
  const float height_m = between(random, 2.3, 2.7);
  Mesh mesh = cylinder({0, 0, 0}, {0, 0, height_m}, 0.04F, metal);
  const auto plain = [&](Vec3 colour) { return Material{Pattern::plain, colour, {}, 1.0F, 0.1F, 0.05F, 1}; };
  const Vec3 red{0.50F, 0.02F, 0.02F}, white{0.75F, 0.75F, 0.75F}, blue{0.02F, 0.10F, 0.40F};
  const float z = height_m - 0.32F;
  const int sides = random.uniform() < 0.35 ? 3 : 28;
  const bool is_blue = sides > 3 && random.uniform() < 0.4;
  const auto disc = [&](float radius, float out_m, Vec3 colour) {
    return cylinder({-0.045F, 0, z}, {-0.055F - out_m, 0, z}, radius, plain(colour), sides);
  };
  mesh.add(disc(0.31F, 0.0F, is_blue ? blue : red));
  mesh.add(disc(is_blue ? 0.10F : 0.22F, 0.006F, white));
  if (!is_blue && random.uniform() < 0.6) mesh.add(disc(0.08F, 0.012F, {0.02F, 0.02F, 0.02F}));
  return mesh;
}

Mesh bollard(FlyRandom& random) {
  const Material metal{Pattern::speckle, {0.10F, 0.10F, 0.11F}, {}, 0.6F, 0.2F, 0.05F, random.bits()};
  const Material band{Pattern::plain, {0.75F, 0.75F, 0.72F}, {}, 1.0F, 0.1F, 0.0F, random.bits()};
  const float height_m = between(random, 0.8, 1.1);
  Mesh mesh = cylinder({0, 0, 0}, {0, 0, height_m}, 0.065F, metal);
  mesh.add(cylinder({0, 0, height_m - 0.25F}, {0, 0, height_m - 0.15F}, 0.068F, band));
  mesh.add(ellipsoid({0, 0, height_m}, {0.075F, 0.075F, 0.05F}, metal));
  return mesh;
}

Mesh tree(FlyRandom& random, float contrast, const TreeSizes& sizes) {
  const Material bark{Pattern::speckle, {0.13F, 0.10F, 0.07F}, {}, contrast, 0.15F, 0.0F, random.bits()};
  const float height_m = sizes.height_m.draw(random), fork_m = sizes.fork_m.draw(random);
  const float radius_m = sizes.radius_m.draw(random);
  const Vec3 lean{between(random, -0.15, 0.15), between(random, -0.15, 0.15), 0};
  const std::array trunk = {LimbPoint{{0, 0, 0}, radius_m * 1.5F, radius_m * 1.5F},
                            LimbPoint{{0, 0, 0.25F}, radius_m * 1.05F, radius_m * 1.05F},
                            LimbPoint{lean * 0.5F + Vec3{0, 0, fork_m * 0.6F}, radius_m * 0.95F, radius_m * 0.9F},
                            LimbPoint{lean + Vec3{0, 0, fork_m}, radius_m * 0.85F, radius_m * 0.85F},
                            LimbPoint{lean + Vec3{0, 0, fork_m + 1.5F}, radius_m * 0.4F, radius_m * 0.4F}};
  Mesh mesh = limb(trunk, {1, 0, 0}, bark);

  const Vec3 half{sizes.crown_m.draw(random), sizes.crown_m.draw(random), 0.5F * (height_m - fork_m)};
  const Vec3 centre = lean + Vec3{0, 0, fork_m + half.z * 0.95F};
  Material leaf{Pattern::speckle, {0.06F, 0.15F, 0.03F}, {}, contrast, 0.12F, 0.0F, random.bits()};
  Material inner = leaf;
  inner.colour = leaf.colour * 0.4F;
  constexpr int kLeavesPerTuft = 130;
  for (int i = 0; i < sizes.tufts; ++i) {
    // Tufts sit on a wobbly shell and fill it; each is a dark core hidden in leaves.
    const float polar_z = between(random, -0.85, 1.0), angle = between(random, 0.0, 2.0 * kPi);
    const float ring = std::sqrt(std::max(0.0F, 1.0F - polar_z * polar_z)), out = between(random, 0.45, 0.85);
    const Vec3 tuft =
        centre + Vec3{half.x * ring * std::cos(angle), half.y * ring * std::sin(angle), half.z * polar_z} * out;
    const float size_m = between(random, 0.45, 0.8);
    mesh.add(ellipsoid(tuft, Vec3{0.7F, 0.7F, 0.6F} * size_m, inner, 10));
    if (i % 4 == 0) mesh.add(cylinder(lean + Vec3{0, 0, fork_m - 0.2F}, tuft, 0.03F + radius_m * 0.2F, bark, 6));
    leaf.colour = Vec3{0.06F, 0.15F, 0.03F} * between(random, 0.7, 1.5);
    Mesh leaves;
    leaves.materials = {leaf};
    for (int k = 0; k < kLeavesPerTuft; ++k) {
      const auto spread = [&] { return between(random, -1.0, 1.0); };
      const Vec3 outward = normalized({spread(), spread(), spread()});
      const Vec3 place = tuft + outward * (size_m * between(random, 0.65, 1.05));
      // Lengths are drawn first: the order of draws within one expression would be the compiler's choice.
      const float half_length_m = between(random, 0.10, 0.22), half_width_m = between(random, 0.06, 0.14);
      const Vec3 edge_u = normalized({spread(), spread(), spread()}) * half_length_m;
      const Vec3 edge_v = normalized(cross(edge_u, {spread(), spread(), spread()})) * half_width_m;
      const auto first = static_cast<std::uint32_t>(leaves.positions.size());
      for (const Vec3& p : {place - edge_u, place + edge_v, place + edge_u, place - edge_v}) {
        leaves.positions.push_back(p);
        leaves.texture.push_back(p);
        leaves.normals.push_back(normalized(outward + Vec3{0, 0, 0.3F}));  // lit like the tuft they belong to
      }
      leaves.triangles.push_back({first, first + 1, first + 2, 0});
      leaves.triangles.push_back({first, first + 2, first + 3, 0});
    }
    mesh.add(leaves);
  }
  return mesh;
}

Mesh hedge(FlyRandom& random, float length_m, float height_m, float contrast) {
  const Material leaf{Pattern::speckle, {0.05F, 0.12F, 0.03F}, {}, 1.3F * contrast, 0.2F, 0.0F, random.bits()};
  constexpr float kStep_m = 0.35F, kDepth_m = 0.8F;
  const auto bump = [&](float x, std::uint32_t salt) {
    return 0.06F * value_noise({x * 2.0F, 0, 0}, leaf.seed + salt);
  };
  std::vector<Ring> rings;
  const int steps = std::max(2, static_cast<int>(length_m / kStep_m));
  for (int i = 0; i <= steps; ++i) {
    const float x = length_m * static_cast<float>(i) / static_cast<float>(steps);
    const float half_z = 0.5F * height_m + bump(x, 1);
    rings.push_back({{x, -0.5F * kDepth_m, half_z}, {0, 0.5F * kDepth_m + bump(x, 2), 0}, {0, 0, half_z}});
  }
  Mesh mesh = loft(rings, leaf, 24, 6.0F);
  mesh.texture = mesh.positions;
  return mesh;
}

}  // namespace flies::synth
