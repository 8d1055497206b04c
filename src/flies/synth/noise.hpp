#pragma once

#include <cstdint>

#include "flies/synth/vec3.hpp"

namespace flies::synth {

/// A well-mixed 32-bit hash of a lattice point.
std::uint32_t lattice_hash(int x, int y, int z, std::uint32_t seed);
/// The same as a number in [0, 1).
float lattice_value(int x, int y, int z, std::uint32_t seed);

/// Smooth noise in [-1, 1] with features of size 1.
float value_noise(const Vec3& p, std::uint32_t seed);

/// Sum of octaves of noise from features of `largest_m` down to `smallest_m`, each octave `gain` times as strong as
/// the next larger one; octaves finer than the footprint fade out. The first octave spans [-1, 1].
float fractal_noise(const Vec3& p, float largest_m, float smallest_m, float gain, float footprint_m,
                    std::uint32_t seed);

/// 1 inside [0, width] of a cycle of `period`, 0 outside, averaged over `footprint`.
float filtered_stripe(float position, float period, float width, float footprint);

}  // namespace flies::synth
