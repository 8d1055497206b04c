#include "flies/synth/things.hpp"

#include <array>

#include "flies/synth/chance.hpp"

namespace flies::synth {
namespace {

Material plain(FlyRandom& random, const Vec3& colour, float gloss = 0.0F) {
  return {Pattern::plain, colour, {}, 1.0F, 0.1F, gloss, random.bits()};
}

Material painted(FlyRandom& random, const Vec3& colour, float contrast) {
  return {Pattern::speckle, colour, {}, 0.5F * contrast, 0.25F, 0.03F, random.bits()};
}

/// Four legs below a rectangle around the origin.
Mesh legs(float length_m, float width_m, float height_m, float thickness_m, const Material& material) {
  Mesh mesh;
  const float x = 0.5F * length_m - thickness_m, y = 0.5F * width_m - thickness_m, t = 0.5F * thickness_m;
  for (const float sx : {-x, x})
    for (const float sy : {-y, y}) mesh.add(box({sx - t, sy - t, 0}, {sx + t, sy + t, height_m}, material));
  return mesh;
}

Mesh cup(FlyRandom& random, const Vec3& foot) {
  const Material glaze = plain(random, {between(random, 0.1, 0.7), between(random, 0.1, 0.6), 0.3F}, 0.1F);
  const float height_m = between(random, 0.09, 0.25), radius_m = between(random, 0.03, 0.045);
  return cylinder(foot, foot + Vec3{0, 0, height_m}, radius_m, glaze);
}

Mesh book(FlyRandom& random, const Vec3& foot, float contrast) {
  const Material cover{Pattern::speckle,
                       {between(random, 0.05, 0.6), between(random, 0.05, 0.4), between(random, 0.05, 0.5)},
                       {},
                       contrast,
                       0.06F,
                       0.02F,
                       random.bits()};
  const Vec3 half{between(random, 0.08, 0.12), between(random, 0.1, 0.15), between(random, 0.02, 0.06)};
  return box(foot - Vec3{half.x, half.y, 0}, foot + half, cover);
}

constexpr std::array<Vec3, 5> kCardboard = {{{0.38F, 0.26F, 0.15F},
                                             {0.45F, 0.32F, 0.20F},
                                             {0.30F, 0.20F, 0.12F},
                                             {0.62F, 0.60F, 0.56F},
                                             {0.20F, 0.28F, 0.42F}}};

/// Cartons side by side on a board from x = 0 to `length_m`, their fronts near y = 0; some places stay empty.
Mesh cartons_in_row(FlyRandom& random, float length_m, float depth_m, float headroom_m, float z_m, float contrast) {
  Mesh mesh;
  for (float x = 0.05F; x < length_m - 0.3F;) {
    const float width = between(random, 0.25, std::min(0.75, static_cast<double>(length_m - x)));
    const Vec3 size{width, depth_m * between(random, 0.6, 0.95), headroom_m * between(random, 0.4, 0.9)};
    const float set_back_m = between(random, 0.02, 0.12);
    if (random.uniform() < 0.85)
      mesh.add(placed(carton(random, size, contrast), {{x + 0.5F * size.x, -set_back_m - 0.5F * size.y, z_m}, 0.0F}));
    x += width + between(random, 0.02, 0.1);
  }
  return mesh;
}

}  // namespace

Material wood(FlyRandom& random, float contrast, float board_m) {
  const float tone = between(random, 0.5, 1.3);
  return {Pattern::planks, Vec3{0.36F, 0.23F, 0.13F} * tone, {}, contrast, board_m, 0.04F, random.bits()};
}

Mesh table(FlyRandom& random, float contrast) {
  constexpr float kTop_m = 0.03F;
  const float length_m = between(random, 0.9, 1.7), width_m = between(random, 0.6, 0.9);
  const float height_m = between(random, 0.70, 0.77), leg_m = between(random, 0.04, 0.07);
  const Material top = wood(random, contrast);
  Mesh mesh =
      box({-0.5F * length_m, -0.5F * width_m, height_m - kTop_m}, {0.5F * length_m, 0.5F * width_m, height_m}, top);
  const Material metal = painted(random, {0.08F, 0.08F, 0.09F}, contrast);
  mesh.add(legs(length_m, width_m, height_m - kTop_m, leg_m, random.uniform() < 0.5 ? metal : top));
  const auto count = 2 + random.below(4);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = between(random, -0.35, 0.35) * length_m, y = between(random, -0.3, 0.3) * width_m;
    const Vec3 foot{x, y, height_m};
    mesh.add(random.uniform() < 0.5 ? cup(random, foot) : book(random, foot, contrast));
  }
  return mesh;
}

Mesh chair(FlyRandom& random, float contrast) {
  const Material frame = wood(random, contrast, 0.2F);
  Material seat = frame;
  if (random.uniform() < 0.5)
    seat = {Pattern::cloth,
            {between(random, 0.05, 0.5), between(random, 0.05, 0.3), between(random, 0.05, 0.3)},
            {},
            contrast,
            0.1F,
            0.0F,
            random.bits()};
  constexpr float kSeat_m = 0.45F, kHalf_m = 0.22F;
  const float back_m = between(random, 0.82, 0.95);
  Mesh mesh = legs(2 * kHalf_m, 2 * kHalf_m, kSeat_m, 0.035F, frame);
  mesh.add(box({-kHalf_m, -kHalf_m, kSeat_m - 0.02F}, {kHalf_m, kHalf_m, kSeat_m + 0.03F}, seat));
  for (const float y : {-kHalf_m + 0.02F, kHalf_m - 0.02F})
    mesh.add(box({-kHalf_m, y - 0.018F, kSeat_m}, {-kHalf_m + 0.035F, y + 0.018F, back_m}, frame));
  mesh.add(box({-kHalf_m, -kHalf_m, back_m - 0.22F}, {-kHalf_m + 0.025F, kHalf_m, back_m}, seat));
  return mesh;
}

Mesh cupboard(FlyRandom& random, float contrast) {
  const float width_m = between(random, 0.7, 1.2), height_m = between(random, 0.8, 2.0);
  const float depth_m = between(random, 0.35, 0.5);
  const Material body = wood(random, contrast, 0.6F);
  Material door = body;
  door.colour = body.colour * between(random, 0.7, 1.4);
  door.seed = random.bits();
  const Material knob = plain(random, {0.5F, 0.5F, 0.5F}, 0.2F);
  const float half_m = 0.5F * width_m;
  Mesh mesh = box({0, -half_m, 0}, {depth_m, half_m, height_m}, body);
  for (const float side : {-1.0F, 1.0F}) {
    const float inner = side * 0.01F, outer = side * (half_m - 0.02F);
    mesh.add(box({depth_m - 0.02F, std::min(inner, outer), 0.08F},
                 {depth_m + 0.02F, std::max(inner, outer), height_m - 0.03F}, door));
    mesh.add(ellipsoid({depth_m + 0.035F, side * 0.06F, 0.55F * height_m}, {0.02F, 0.015F, 0.04F}, knob, 10));
  }
  return mesh;
}

Mesh carton(FlyRandom& random, const Vec3& size, float contrast) {
  const Material board{Pattern::plaster, kCardboard[random.below(kCardboard.size())], {}, 1.2F * contrast, 0.1F, 0.0F,
                       random.bits()};
  const Material tape = plain(random, board.colour * 1.4F, 0.1F);
  const Material label{Pattern::checks, {0.7F, 0.7F, 0.68F}, {0.06F, 0.06F, 0.07F}, contrast, 0.01F, 0.0F,
                       random.bits()};
  constexpr float kOut_m = 0.002F;  // tape and labels lie on the board
  const float x = 0.5F * size.x, y = 0.5F * size.y, z = size.z;
  Mesh mesh = box({-x, -y, 0}, {x, y, z}, board);
  mesh.add(box({-0.05F * size.x, -y - kOut_m, 0.7F * z}, {0.05F * size.x, y + kOut_m, z + kOut_m}, tape));
  mesh.add(box({-x - kOut_m, -0.05F * size.y, 0.7F * z}, {x + kOut_m, 0.05F * size.y, z + kOut_m}, tape));
  const float across = between(random, -0.7, 0.1), up = between(random, 0.15, 0.4);
  mesh.add(box({across * x, -y - kOut_m, up * z}, {across * x + 0.6F * x, y + kOut_m, (up + 0.25F) * z}, label));
  mesh.add(box({-x - kOut_m, across * y, up * z}, {x + kOut_m, across * y + 0.6F * y, (up + 0.25F) * z}, label));
  return mesh;
}

Mesh floor_lamp(FlyRandom& random, float contrast) {
  const float height_m = between(random, 1.4, 1.8);
  const Material metal = painted(random, {0.07F, 0.07F, 0.07F}, contrast);
  const Material shade{Pattern::cloth, {0.7F, 0.62F, 0.45F}, {}, contrast, 0.1F, 0.0F, random.bits()};
  Mesh mesh = cylinder({0, 0, 0}, {0, 0, 0.03F}, 0.15F, metal, 24);
  mesh.add(cylinder({0, 0, 0}, {0, 0, height_m - 0.25F}, 0.015F, metal, 10));
  mesh.add(cylinder({0, 0, height_m - 0.3F}, {0, 0, height_m}, 0.2F, shade, 24));
  return mesh;
}

Mesh picture(FlyRandom& random, const Vec3& centre, float contrast) {
  const float x = between(random, 0.2, 0.6), z = between(random, 0.2, 0.45);
  const Material frame = wood(random, contrast);
  const Material canvas{Pattern::speckle,
                        {between(random, 0.1, 0.5), between(random, 0.1, 0.5), between(random, 0.1, 0.5)},
                        {},
                        2.0F * contrast,
                        between(random, 0.1, 0.4),
                        0.0F,
                        random.bits()};
  Mesh mesh = box(centre + Vec3{-x, 0, -z}, centre + Vec3{x, 0.03F, z}, frame);
  mesh.add(box(centre + Vec3{-x + 0.05F, 0, -z + 0.05F}, centre + Vec3{x - 0.05F, 0.035F, z - 0.05F}, canvas));
  return mesh;
}

Mesh pallet(FlyRandom& random, bool laden, float contrast) {
  constexpr float kLength_m = 1.2F, kWidth_m = 0.8F, kHeight_m = 0.144F, kBoard_m = 0.022F;
  const Material rough = wood(random, 1.3F * contrast, 0.145F);
  const float x = 0.5F * kLength_m, y = 0.5F * kWidth_m;
  Mesh mesh;
  for (const float at : {-y, -0.0725F, y - 0.145F}) {  // runners with blocks upon them
    mesh.add(box({-x, at, 0}, {x, at + 0.145F, kBoard_m}, rough));
    for (const float block : {-x, -0.0725F, x - 0.145F})
      mesh.add(box({block, at, kBoard_m}, {block + 0.145F, at + 0.145F, kHeight_m - kBoard_m}, rough));
  }
  for (int i = 0; i < 5; ++i) {
    const float at = -y + static_cast<float>(i) * (kWidth_m - 0.12F) / 4.0F;
    mesh.add(box({-x, at, kHeight_m - kBoard_m}, {x, at + 0.12F, kHeight_m}, rough));
  }
  if (!laden) return mesh;
  const auto layers = 1 + random.below(3);
  const float layer_m = between(random, 0.25, 0.4);
  for (std::uint32_t layer = 0; layer < layers; ++layer)
    for (const float cx : {-0.3F, 0.3F})
      for (const float cy : {-0.2F, 0.2F})
        mesh.add(placed(carton(random, {0.58F, 0.38F, layer_m - 0.01F}, contrast),
                        {{cx, cy, kHeight_m + static_cast<float>(layer) * layer_m}, 0.0F}));
  return mesh;
}

Mesh rack(FlyRandom& random, float length_m, float contrast) {
  constexpr float kDepth_m = 0.8F, kHeight_m = 3.0F, kPost_m = 0.08F;
  constexpr std::array<float, 5> kBoards_m = {0.12F, 0.85F, 1.6F, 2.3F, kHeight_m};
  const Material steel = painted(random, {0.04F, 0.10F, 0.32F}, contrast);
  const Material beam = painted(random, {0.55F, 0.20F, 0.03F}, contrast);
  Mesh mesh;
  for (const float x : {0.0F, length_m - kPost_m})
    for (const float y : {-kPost_m, -kDepth_m}) mesh.add(box({x, y, 0}, {x + kPost_m, y + kPost_m, kHeight_m}, steel));
  for (std::size_t i = 0; i + 1 < kBoards_m.size(); ++i) {
    const float z = kBoards_m[i];
    mesh.add(box({0, -kDepth_m, z - 0.03F}, {length_m, -0.03F, z}, wood(random, contrast, 0.3F)));
    mesh.add(box({0, -0.03F, z - 0.08F}, {length_m, 0, z}, beam));
    mesh.add(cartons_in_row(random, length_m, kDepth_m, kBoards_m[i + 1] - z - 0.1F, z, contrast));
  }
  return mesh;
}

}  // namespace flies::synth
