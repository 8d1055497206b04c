#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

/// Size of the neighbourhoods. The road recedes quickly in the image (a third of a pixel of disparity a row at the
/// usual height and baseline), so one that matches it is wide and flat.
constexpr int kShiftColumns = 25, kShiftRows = 5;

/// Steps to a pixel in which the others are placed, as those of `correlate_points`.
constexpr int kShiftStepBits = 4, kShiftSteps = 1 << kShiftStepBits;

constexpr int kMaxShifts = 64;

/// A neighbourhood of the left image and those of a row of places in the right one.
struct ShiftedPatches {
  const std::uint8_t* left = nullptr;   ///< its top-left pixel
  const std::uint8_t* right = nullptr;  ///< top-left pixel of the leftmost of the others
  std::ptrdiff_t left_stride = 0, right_stride = 0;
  int fraction16 = 0;        ///< sixteenths of a pixel that all others lie farther to the right, 0..15
  int shifts = 0;            ///< how many others, each a column to the right of the one before; at most `kMaxShifts`
  double noise_gray2 = 0.0;  ///< variance of image noise, added to both variances
};

/// The correlation coefficients that `correlate_points` has for these places: of the row-centred neighbourhoods. Reads
/// one column beyond the rightmost of them. The same numbers on every CPU.
/// @param coefficient one per shift, -1..1
void correlate_shifts(const ShiftedPatches& patches, float* coefficient);

}  // namespace flies::kernels
