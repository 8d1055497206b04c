#pragma once

#include <cstdint>

#include "flies/synth/vec3.hpp"

namespace flies::synth {

/// A well-mixed number in [0, 1) for a lattice point. Inline because it is most of the renderer's work.
inline float lattice_value(int x, int y, int z, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8DA6B343u ^ static_cast<std::uint32_t>(y) * 0xD8163841u ^
                    static_cast<std::uint32_t>(z) * 0xCB1AB31Fu ^ seed * 0x9E3779B9u;
  // Finaliser of MurmurHash3.
  h ^= h >> 16;
  h *= 0x85EBCA6Bu;
  h ^= h >> 13;
  h *= 0xC2B2AE35u;
  h ^= h >> 16;
  return static_cast<float>(h >> 8) * 0x1p-24F;
}

/// Smooth noise in [-1, 1] with features of size 1.
float value_noise(const Vec3& p, std::uint32_t seed);

/// Sum of octaves of noise from features of `largest_m` down to `smallest_m`, each octave `gain` times as strong as
/// the next larger one; octaves finer than the footprint fade out. The first octave spans [-1, 1].
float fractal_noise(const Vec3& p, float largest_m, float smallest_m, float gain, float footprint_m,
                    std::uint32_t seed);

/// 1 inside [0, width] of a cycle of `period`, 0 outside, averaged over `footprint`.
float filtered_stripe(float position, float period, float width, float footprint);

}  // namespace flies::synth
