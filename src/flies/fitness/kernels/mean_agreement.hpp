#pragma once

#include <cmath>

#include "flies/fitness/kernels/patch.hpp"

namespace flies::kernels {

/// D of Eq. (2), exp(-|difference of the row means|), as 2^-y with y = d log2(e) / (16 columns), d the absolute
/// difference of 16 times the left and of the right row sum. All kernels take the same steps in single precision:
///   k = round(d `step`), f = k - d `step_high` - d `step_low`, D = 2^-k polynomial(f)
struct MeanAgreement {
  float step;       ///< y of d = 1
  float step_high;  ///< its first 7 bits: times d < 2^17 it has 24 bits, so the product is exact
  float step_low;   ///< the rest

  explicit MeanAgreement(int columns)
      : step(static_cast<float>(log2e / (kScale * columns))),
        step_high(leading_bits(step)),
        step_low(static_cast<float>(log2e / (kScale * columns) - step_high)) {}

  /// Smaller powers of 2 than this are not normal numbers.
  static constexpr float kMaxExponent = 126.0F;

  /// 2^f for -0.5 <= f <= 0.5 to 1e-7, its Taylor coefficients ln(2)^i / i! from the last to the first.
  static constexpr float kPolynomial[] = {1.540353e-4F, 1.3333558e-3F, 9.6181291e-3F, 5.5504109e-2F,
                                          0.240226507F, 0.693147181F,  1.0F};

 private:
  static constexpr double log2e = 1.4426950408889634;

  static float leading_bits(float x) {
    int exponent = 0;
    const float mantissa = std::frexp(x, &exponent);
    return std::ldexp(std::trunc(mantissa * 128.0F) / 128.0F, exponent);
  }
};

}  // namespace flies::kernels
