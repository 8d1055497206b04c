#include "flies/fitness/fitness.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "flies/fitness/kernels/patch_kernel.hpp"
#include "flies/fitness/kernels/row_sums.hpp"

namespace flies {
namespace {

/// Flies a task: large enough to hide the scheduler, small enough to balance two dozen cores.
constexpr std::size_t kFliesPerTask = 256;

/// Projections farther out than this are nowhere near an image and would overflow the conversion to int.
constexpr double kMaxCoordinate_px = 1e6;

/// The neighbourhoods around both projections, or `columns` = 0 when one of them leaves its image.
kernels::PatchPair cut_patches(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  if (!(std::abs(point.u_px) < kMaxCoordinate_px && std::abs(point.v_px) < kMaxCoordinate_px &&
        std::abs(point.disparity_px) < kMaxCoordinate_px))
    return {};
  const int half_u = options.half_width_px, half_v = options.half_height_px;
  const auto u_left = static_cast<int>(std::lround(point.u_px));
  const auto v = static_cast<int>(std::lround(point.v_px));
  int u_right = 0, fraction16 = 0;
  if (options.sampling == PatchSampling::nearest) {
    u_right = static_cast<int>(std::lround(point.u_px - point.disparity_px));
  } else {
    // The left projection may be rounded freely as long as the disparity between the two patches stays exact.
    const auto u_right16 = static_cast<int>(std::lround((u_left - point.disparity_px) * 16.0));
    u_right = u_right16 >> 4;
    fraction16 = u_right16 & 15;
  }
  const int width = pair.left.width_px, height = pair.left.height_px;
  if (u_left - half_u < 0 || u_left + half_u >= width || v - half_v < 0 || v + half_v >= height ||
      u_right - half_u < 0 || u_right + half_u + 1 >= width)
    return {};
  return {.left = pair.left.row(v - half_v) + u_left - half_u,
          .right = pair.right.row(v - half_v) + u_right - half_u,
          .left_stride = pair.left.stride,
          .right_stride = pair.right.stride,
          .columns = 2 * half_u + 1,
          .rows = 2 * half_v + 1,
          .fraction16 = fraction16};
}

/// Eq. (1).
double louchet(const kernels::PatchPair& patch, const FitnessOptions& options) {
  const std::uint8_t* centre = patch.left + options.half_height_px * patch.left_stride + options.half_width_px;
  const double gradient_u = 0.5 * (centre[1] - centre[-1]);
  const double gradient_v = 0.5 * (centre[patch.left_stride] - centre[-patch.left_stride]);
  const double squared_differences = static_cast<double>(kernels::sum_squared_differences(patch)) / 256.0;
  return std::sqrt(std::hypot(gradient_u, gradient_v)) / (options.louchet_constant + squared_differences);
}

/// Eq. (2), not below 0: a fitness serves as a weight.
double covariance(const kernels::PatchPair& patch) { return std::max(0.0, kernels::sum_weighted_covariance(patch)); }

struct Correlation {
  double coefficient = 0.0;
  double mean_covariance = 0.0;
};

Correlation correlate(const kernels::PatchPair& patch, const FitnessOptions& options) {
  const auto moments = kernels::sum_row_centred_moments(patch);
  const double pixels = patch.columns * patch.rows;
  const double noise = pixels * options.noise_gray * options.noise_gray;
  const double scale = std::sqrt((moments.left_variance + noise) * (moments.right_variance + noise));
  return {scale > 0.0 ? moments.covariance / scale : 0.0, moments.covariance / pixels};
}

double correlation(const kernels::PatchPair& patch, const FitnessOptions& options) {
  const auto [coefficient, mean_covariance] = correlate(patch, options);
  if (coefficient <= 0.0) return 0.0;
  return std::pow(coefficient, options.correlation_power) * std::pow(mean_covariance, options.contrast_power);
}

}  // namespace

float score_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  const auto patch = cut_patches(pair, options, point);
  if (patch.columns == 0) return 0.0F;
  switch (options.function) {
    case FitnessFunction::louchet:
      return static_cast<float>(louchet(patch, options));
    case FitnessFunction::covariance:
      return static_cast<float>(covariance(patch));
    case FitnessFunction::correlation:
      return static_cast<float>(correlation(patch, options));
  }
  return 0.0F;
}

double correlate_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  const auto patch = cut_patches(pair, options, point);
  return patch.columns == 0 ? 0.0 : correlate(patch, options).coefficient;
}

void score_flies(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& options,
                 const Population& flies, std::size_t first, std::span<float> fitness) {
  assert(first + fitness.size() <= flies.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fitness.size(), kFliesPerTask), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Point3 point = flies.point(first + i);
      // Written so that a NaN depth counts as behind the camera.
      fitness[i] = projection.depth_m(point) > 0.0 ? score_point(pair, options, projection.project(point)) : 0.0F;
    }
  });
}

std::vector<float> score_flies(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& options,
                               const Population& flies) {
  std::vector<float> fitness(flies.size());
  score_flies(pair, projection, options, flies, 0, fitness);
  return fitness;
}

std::string_view kernel_target_name() { return kernels::chosen_kernel().target; }

std::vector<std::string_view> kernel_target_names() {
  std::vector<std::string_view> names;
  for (const auto& kernel : kernels::supported_kernels()) names.push_back(kernel.target);
  return names;
}

}  // namespace flies
