#include "flies/synth/noise.hpp"

namespace flies::synth {
namespace {

float smooth_step(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }

}  // namespace

float value_noise(const Vec3& p, std::uint32_t seed) {
  const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
  const float tx = smooth_step(p.x - fx), ty = smooth_step(p.y - fy), tz = smooth_step(p.z - fz);
  const auto row = [&](int yy, int zz) {
    return mix(lattice_value(x, yy, zz, seed), lattice_value(x + 1, yy, zz, seed), tx);
  };
  const float near = mix(row(y, z), row(y + 1, z), ty);
  const float far = mix(row(y, z + 1), row(y + 1, z + 1), ty);
  return 2.0F * mix(near, far, tz) - 1.0F;
}

float fractal_noise(const Vec3& p, float largest_m, float smallest_m, float gain, float footprint_m,
                    std::uint32_t seed) {
  float sum = 0.0F, amplitude = 1.0F;
  for (float size_m = largest_m; size_m >= smallest_m; size_m *= 0.5F) {
    // An octave is whole while its features span two footprints and gone when they span less than one.
    const float visible = std::clamp(size_m / footprint_m - 1.0F, 0.0F, 1.0F);
    if (visible <= 0.0F) break;
    sum += visible * amplitude * value_noise(p * (1.0F / size_m), seed++);
    amplitude *= gain;
  }
  return sum;
}

float filtered_stripe(float position, float period, float width, float footprint) {
  // Integral of the stripe function up to t, so that its mean over the footprint is exact.
  const auto integral = [&](float t) {
    const float cycles = std::floor(t / period);
    return cycles * width + std::min(t - cycles * period, width);
  };
  const float half = 0.5F * std::max(footprint, 1e-4F);
  return (integral(position + half) - integral(position - half)) / (2.0F * half);
}

}  // namespace flies::synth
