#pragma once

#include "flies/fitness/kernels/patch.hpp"

namespace flies::kernels {

/// D of Eq. (2), exp(-|difference of the row means|), as 2^-y with y = d log2(e) / (16 columns), d the absolute
/// difference of 16 times the left and of the right row sum. All kernels take the same steps in single precision:
///   y = min(d `step`, 125), t = y + `kRounder`, f = (t - `kRounder`) - y,
///   D = polynomial(f) with its exponent lowered by the integer in the last bits of t
/// D is off by at most 2e-7, and by at most 6e-6 of itself down to 2^-125, which stands for all that is less.
struct MeanAgreement {
  float step;  ///< y of d = 1

  explicit MeanAgreement(int columns) : step(static_cast<float>(1.4426950408889634 / (kScale * columns))) {}

  static constexpr float kMaxExponent = 125.0F;

  /// 1.5 * 2^23: a small number added to it is rounded to an integer, halves to even, which its last bits then hold.
  static constexpr float kRounder = 12582912.0F;

  /// 2^f for -0.5 <= f <= 0.5 to 1e-7, exact at 0: equal ripples of the relative error, from the last coefficient to
  /// the first.
  static constexpr float kPolynomial[] = {1.326472615e-3F, 9.671513923e-3F, 0.05550733581F,
                                          0.2402224243F,   0.6931470037F,   1.0F};
};

}  // namespace flies::kernels
