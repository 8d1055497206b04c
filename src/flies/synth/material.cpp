#include "flies/synth/material.hpp"

#include "flies/synth/noise.hpp"

namespace flies::synth {
namespace {

float asphalt(const Material& m, const Vec3& p, float footprint) {
  const Vec3 flat{p.x, p.y, 0.0F};
  float shade = 1.0F + m.contrast * (0.16F * fractal_noise(flat, 3.0F, 0.2F, 0.75F, footprint, m.seed) +
                                     0.22F * fractal_noise(flat, 0.12F, 0.008F, 0.9F, footprint, m.seed + 50));
  // Patches: some cells of a coarse grid hold a rectangle of newer, darker or older, lighter surface.
  const int cx = static_cast<int>(std::floor(p.x / 7.0F)), cy = static_cast<int>(std::floor(p.y / 3.4F));
  const float pick = lattice_value(cx, cy, 1, m.seed);
  if (pick < 0.35F) {
    const float u = p.x / 7.0F - static_cast<float>(cx), v = p.y / 3.4F - static_cast<float>(cy);
    const float left = 0.1F + 0.3F * lattice_value(cx, cy, 2, m.seed);
    const float top = 0.1F + 0.3F * lattice_value(cx, cy, 3, m.seed);
    const float u_in = std::min(u - left, 0.9F - u), v_in = std::min(v - top, 0.85F - v);
    if (u_in > 0.0F && v_in > 0.0F) {
      const bool in_seam = std::min(u_in * 7.0F, v_in * 3.4F) < 0.03F;
      shade *= in_seam ? 0.6F : (pick < 0.2F ? 0.75F : 1.18F);
    }
  }
  // Cracks follow the zero line of a warped noise, in some regions only.
  const Vec3 warped = flat + Vec3{0.3F * value_noise(flat * 1.7F, m.seed + 90), 0, 0};
  const float distance = std::abs(value_noise(warped * 0.45F, m.seed + 91));
  const float region = value_noise(flat * 0.12F, m.seed + 92);
  const float crack_width = 0.008F + 0.3F * footprint;
  if (region > 0.05F && distance < crack_width) shade *= mix(0.45F, 1.0F, std::min(1.0F, footprint * 12.0F));
  return std::max(0.15F, shade);
}

float slabs(const Material& m, const Vec3& p, float footprint) {
  const float joint_x = filtered_stripe(p.x, m.scale_m, 0.012F, footprint);
  const float joint_y = filtered_stripe(p.y, m.scale_m, 0.012F, footprint);
  const int cx = static_cast<int>(std::floor(p.x / m.scale_m)), cy = static_cast<int>(std::floor(p.y / m.scale_m));
  const float slab = 0.22F * (lattice_value(cx, cy, 0, m.seed) - 0.5F);
  const float dirt = 0.14F * fractal_noise({p.x, p.y, 0}, 1.5F, 0.01F, 0.8F, footprint, m.seed);
  return std::max(0.2F, (1.0F + m.contrast * (slab + dirt)) * (1.0F - 0.55F * std::min(1.0F, joint_x + joint_y)));
}

float plaster(const Material& m, const Vec3& p, float footprint) {
  const Vec3 runs{p.x, p.y, p.z * 0.15F};  // stains run down the wall
  const float stains = 0.13F * fractal_noise(runs, 1.2F, 0.05F, 0.7F, footprint, m.seed);
  const float grain = 0.15F * fractal_noise(p, 0.4F, 0.01F, 0.95F, footprint, m.seed + 30);
  const float splash = 0.25F * std::max(0.0F, 1.0F - p.z / 0.7F);  // dirt above the pavement
  return std::max(0.2F, 1.0F + m.contrast * (stains + grain - splash));
}

float planks(const Material& m, const Vec3& p, float footprint) {
  const int board = static_cast<int>(std::floor(p.y / m.scale_m));
  // Boards end at different places.
  const float start_m = 2.0F * lattice_value(board, 0, 0, m.seed);
  const int piece = static_cast<int>(std::floor((p.x + start_m) / 2.0F));
  const float joint = std::min(1.0F, filtered_stripe(p.y, m.scale_m, 0.004F, footprint) +
                                         filtered_stripe(p.x + start_m, 2.0F, 0.004F, footprint));
  const float single = 0.3F * (lattice_value(board, piece, 1, m.seed) - 0.5F);
  const Vec3 grain{p.x * 0.12F + static_cast<float>(board), p.y, p.z * 0.12F};
  const float lines = 0.22F * fractal_noise(grain, 0.08F, 0.004F, 0.85F, footprint, m.seed + 5);
  const float scuffs = 0.1F * fractal_noise(p, 0.5F, 0.02F, 0.8F, footprint, m.seed + 6);
  return std::max(0.2F, (1.0F + m.contrast * (single + lines + scuffs)) * (1.0F - 0.5F * joint));
}

Vec3 brick(const Material& m, const Vec3& p, float footprint) {
  constexpr float kLength_m = 0.25F, kCourse_m = 0.083F, kMortar_m = 0.012F;
  const int course = static_cast<int>(std::floor(p.z / kCourse_m));
  const float along = p.x + p.y + (course % 2 == 0 ? 0.0F : 0.5F * kLength_m);
  const float mortar = std::min(1.0F, filtered_stripe(p.z, kCourse_m, kMortar_m, footprint) +
                                          filtered_stripe(along, kLength_m, kMortar_m, footprint));
  const int index = static_cast<int>(std::floor(along / kLength_m));
  // Single bricks differ; the difference fades once a footprint holds several of them.
  const float visible = std::clamp(kLength_m / footprint - 1.0F, 0.0F, 1.0F);
  const float single = 0.5F * visible * (lattice_value(index, course, 0, m.seed) - 0.5F);
  const float dirt = 0.2F * fractal_noise(p, 2.0F, 0.02F, 0.75F, footprint, m.seed + 7);
  const Vec3 stone = m.colour * std::max(0.2F, 1.0F + m.contrast * (single + dirt));
  return mix(stone, m.second, mortar * std::min(1.0F, m.contrast));
}

float cloth(const Material& m, const Vec3& p, float footprint) {
  const Vec3 folds{p.x, p.y, p.z * 0.45F};  // folds hang
  return std::max(0.2F, 1.0F + m.contrast * (0.20F * fractal_noise(folds, 0.16F, 0.01F, 0.75F, footprint, m.seed) +
                                             0.07F * fractal_noise(p, 0.02F, 0.004F, 0.9F, footprint, m.seed + 9)));
}

float checks(const Material& m, const Vec3& p, float footprint) {
  const float period = 2.0F * m.scale_m;
  const float across = filtered_stripe(p.x + p.y, period, m.scale_m, footprint);
  return 0.5F * (across + filtered_stripe(p.z, period, m.scale_m, footprint));
}

float speckle(const Material& m, const Vec3& p, float footprint) {
  return std::max(0.08F,
                  1.0F + m.contrast * 0.45F * fractal_noise(p, m.scale_m, m.scale_m / 16.0F, 0.8F, footprint, m.seed));
}

float plate_signs(const Material& m, const Vec3& p, float footprint) {
  // Seven signs, each a block with a random part missing: enough to look like writing from a few metres.
  const float column = (p.y + 0.26F) / 0.52F * 8.5F;
  const int sign = static_cast<int>(std::floor(column));
  const float within = column - static_cast<float>(sign);
  const bool in_sign = sign >= 1 && sign <= 7 && within < 0.62F && std::abs(p.z) < 0.038F;
  const bool hole = std::abs(within - 0.31F) < 0.14F && lattice_value(sign, p.z > 0.0F ? 1 : 0, 0, m.seed) < 0.7F &&
                    std::abs(std::abs(p.z) - 0.019F) < 0.012F;
  return in_sign && !hole ? std::clamp(0.04F / footprint - 1.0F, 0.3F, 1.0F) : 0.0F;
}

}  // namespace

Vec3 reflectance(const Material& m, const Vec3& p, float footprint) {
  switch (m.pattern) {
    case Pattern::plain:
      return m.colour * (1.0F + 0.05F * m.contrast * fractal_noise(p, 0.3F, 0.02F, 0.8F, footprint, m.seed));
    case Pattern::asphalt:
      return m.colour * asphalt(m, p, footprint);
    case Pattern::slabs:
      return m.colour * slabs(m, p, footprint);
    case Pattern::plaster:
      return m.colour * plaster(m, p, footprint);
    case Pattern::brick:
      return brick(m, p, footprint);
    case Pattern::cloth:
      return m.colour * cloth(m, p, footprint);
    case Pattern::stripes:
      return mix(m.colour, m.second, filtered_stripe(p.z, 2.0F * m.scale_m, m.scale_m, footprint)) *
             cloth(m, p, footprint);
    case Pattern::checks:
      return mix(m.colour, m.second, checks(m, p, footprint)) * cloth(m, p, footprint);
    case Pattern::speckle:
      return m.colour * speckle(m, p, footprint);
    case Pattern::worn: {
      const float hole = fractal_noise({p.x, p.y, 0}, 0.3F, 0.01F, 0.8F, footprint, m.seed + 3) * m.contrast;
      return mix(m.colour, m.second, std::clamp(2.0F * (hole - 0.45F), 0.0F, 1.0F)) *
             (1.0F + 0.1F * m.contrast * fractal_noise({p.x, p.y, 0}, 0.1F, 0.01F, 0.9F, footprint, m.seed));
    }
    case Pattern::planks:
      return m.colour * planks(m, p, footprint);
    case Pattern::plate:
      return mix(m.colour, m.second, plate_signs(m, p, footprint));
  }
  return m.colour;
}

}  // namespace flies::synth
