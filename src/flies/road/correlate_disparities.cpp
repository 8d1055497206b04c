#include "flies/road/correlate_disparities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "flies/core/parabola.hpp"
#include "flies/road/kernels/correlate_shifts.hpp"

namespace flies {

void correlate_disparities(const RectifiedPair& pair, const StereoPoint& image, double lowest_px,
                           std::span<float> correlation) {
  constexpr int kHalfWidth = kernels::kShiftColumns / 2, kHalfHeight = kernels::kShiftRows / 2;
  const int u = static_cast<int>(std::lrint(image.u_px)), v = static_cast<int>(std::lrint(image.v_px));
  std::fill(correlation.begin(), correlation.end(), 0.0F);
  if (u < kHalfWidth || u + kHalfWidth >= pair.left.width_px || v < kHalfHeight ||
      v + kHalfHeight >= pair.left.height_px)
    return;
  // The neighbourhood at the lowest disparity is the rightmost. It and those to its left must be inside the image.
  const auto rightmost16 = static_cast<int>(std::lrint((u - lowest_px) * kernels::kShiftSteps));
  const int rightmost = (rightmost16 >> kernels::kShiftStepBits) - kHalfWidth;
  const int first = std::max(0, rightmost + kernels::kShiftColumns + 1 - pair.right.width_px);
  const int end = std::min(static_cast<int>(correlation.size()), rightmost + 1);
  for (int begin = first; begin < end; begin += kernels::kMaxShifts) {
    const int shifts = std::min(kernels::kMaxShifts, end - begin);
    const int leftmost = rightmost - (begin + shifts - 1);
    std::array<float, kernels::kMaxShifts> from_left;
    kernels::correlate_shifts({.left = pair.left.row(v - kHalfHeight) + u - kHalfWidth,
                               .right = pair.right.row(v - kHalfHeight) + leftmost,
                               .left_stride = pair.left.stride,
                               .right_stride = pair.right.stride,
                               .fraction16 = rightmost16 & (kernels::kShiftSteps - 1),
                               .shifts = shifts,
                               .noise_gray2 = kRoadNoise_gray * kRoadNoise_gray},
                              from_left.data());
    std::reverse_copy(from_left.begin(), from_left.begin() + shifts, correlation.begin() + begin);
  }
}

double unambiguous_best(std::span<const float> correlation, double min_correlation) {
  const auto best = std::max_element(correlation.begin(), correlation.end());
  if (best == correlation.begin() || best == correlation.end() || best + 1 == correlation.end()) return -1.0;
  if (*best < min_correlation) return -1.0;
  for (auto other = correlation.begin(); other != correlation.end(); ++other)
    if (std::abs(other - best) >= kAmbiguousDistance_px && *other > *best - kAmbiguousMargin) return -1.0;
  return static_cast<double>(best - correlation.begin()) + parabola_vertex(best[-1], best[0], best[1]);
}

}  // namespace flies
