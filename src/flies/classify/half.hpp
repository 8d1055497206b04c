#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace flies {

/// Numbers of 16 bits, IEEE 754 binary16: a sign, 5 bits of exponent, 10 of mantissa.

/// The nearest one; of two as near the even one; infinity beyond 65504.
/// @param value finite or not
inline std::uint16_t half_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000U);
  const float size = std::abs(value);
  if (std::isnan(size)) return static_cast<std::uint16_t>(sign | 0x7E00U);
  if (size >= 65520.0F) return static_cast<std::uint16_t>(sign | 0x7C00U);
  // The step of the mantissa at this size; below 2^-14 it stays.
  const int exponent = size == 0.0F ? -14 : std::max(std::ilogb(size), -14);
  const auto steps = static_cast<std::uint32_t>(std::lrint(std::ldexp(static_cast<double>(size), 10 - exponent)));
  // A mantissa that rounds up to the next power of two carries into the exponent, as it should.
  return static_cast<std::uint16_t>(sign | ((static_cast<std::uint32_t>(exponent + 14) << 10) + steps));
}

inline float from_half(std::uint16_t bits) {
  const float sign = (bits & 0x8000U) != 0 ? -1.0F : 1.0F;
  const int exponent = bits >> 10 & 0x1F;
  const int mantissa = bits & 0x3FF;
  if (exponent == 0x1F) return mantissa == 0 ? sign * HUGE_VALF : std::nanf("");
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(mantissa), -24);
  return sign * std::ldexp(static_cast<float>(mantissa + 0x400), exponent - 25);
}

}  // namespace flies
