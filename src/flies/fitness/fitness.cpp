#include "flies/fitness/fitness.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "flies/fitness/kernels/patch_kernel.hpp"
#include "flies/fitness/kernels/row_sums.hpp"

namespace flies {
namespace {

/// Flies a task: large enough to hide the scheduler, small enough to balance two dozen cores.
constexpr std::size_t kFliesPerTask = 256;

/// Projection of what is behind the camera.
constexpr StereoPoint kNowhere = {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};

/// Projections farther out than this are nowhere near an image and would overflow the conversion to int.
constexpr float kMaxCoordinate_px = 1e6F;

int round_half_to_even(float x) { return static_cast<int>(std::lrint(x)); }

/// The neighbourhoods around both projections, or `columns` = 0 when one of them leaves its image.
kernels::PatchPair cut_patches(const RectifiedPair& pair, const FitnessOptions& options, float u_px, float v_px,
                               float disparity_px) {
  if (!(std::abs(u_px) < kMaxCoordinate_px && std::abs(v_px) < kMaxCoordinate_px &&
        std::abs(disparity_px) < kMaxCoordinate_px))
    return {};
  const int half_u = options.half_width_px, half_v = options.half_height_px;
  const int u_left = round_half_to_even(u_px), v = round_half_to_even(v_px);
  int u_right = 0, fraction16 = 0;
  if (options.sampling == PatchSampling::nearest) {
    u_right = round_half_to_even(u_px - disparity_px);
  } else {
    // The left projection may be rounded freely as long as the disparity between the two patches stays exact.
    const int u_right16 = round_half_to_even((static_cast<float>(u_left) - disparity_px) * 16.0F);
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

double score(const kernels::PatchPair& patch, const FitnessOptions& options) {
  switch (options.function) {
    case FitnessFunction::louchet:
      return louchet(patch, options);
    case FitnessFunction::covariance:
      return covariance(patch);
    case FitnessFunction::correlation:
      return correlation(patch, options);
  }
  return 0.0;
}

/// Calls `evaluate` with the patches of each place.
template <class Evaluate>
void for_each_place(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                    std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> values,
                    const Evaluate& evaluate) {
  assert(u_px.size() == values.size() && v_px.size() == values.size() && disparity_px.size() == values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto patch = cut_patches(pair, options, u_px[i], v_px[i], disparity_px[i]);
    values[i] = patch.columns == 0 ? 0.0F : static_cast<float>(evaluate(patch));
  }
}

/// Evaluates one place by a function for many.
template <class EvaluateMany>
float evaluate_one(const StereoPoint& point, const EvaluateMany& evaluate_many) {
  const auto u_px = static_cast<float>(point.u_px), v_px = static_cast<float>(point.v_px);
  const auto disparity_px = static_cast<float>(point.disparity_px);
  float value = 0.0F;
  evaluate_many(std::span(&u_px, 1), std::span(&v_px, 1), std::span(&disparity_px, 1), std::span(&value, 1));
  return value;
}

}  // namespace

void score_points(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                  std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> fitness) {
  for_each_place(pair, options, u_px, v_px, disparity_px, fitness,
                 [&](const kernels::PatchPair& patch) { return score(patch, options); });
}

void correlate_points(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                      std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> coefficient) {
  for_each_place(pair, options, u_px, v_px, disparity_px, coefficient,
                 [&](const kernels::PatchPair& patch) { return correlate(patch, options).coefficient; });
}

float score_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  return evaluate_one(point, [&](auto... spans) { score_points(pair, options, spans...); });
}

float correlate_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  return evaluate_one(point, [&](auto... spans) { correlate_points(pair, options, spans...); });
}

void score_flies(const RectifiedPair& pair, const Projection& projection, const FitnessOptions& options,
                 const Population& flies, std::size_t first, std::span<float> fitness) {
  assert(first + fitness.size() <= flies.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fitness.size(), kFliesPerTask), [&](const auto& range) {
    // A range can be larger than its grain; the places need a size known here.
    std::array<float, kFliesPerTask> u_px, v_px, disparity_px;
    for (std::size_t begin = range.begin(); begin < range.end(); begin += kFliesPerTask) {
      const std::size_t count = std::min(kFliesPerTask, range.end() - begin);
      for (std::size_t i = 0; i < count; ++i) {
        const Point3 point = flies.point(first + begin + i);
        // Written so that a NaN depth counts as behind the camera.
        const bool ahead = projection.depth_m(point) > 0.0;
        const StereoPoint at = ahead ? projection.project(point) : kNowhere;
        u_px[i] = static_cast<float>(at.u_px);
        v_px[i] = static_cast<float>(at.v_px);
        disparity_px[i] = static_cast<float>(at.disparity_px);
      }
      score_points(pair, options, std::span(u_px).first(count), std::span(v_px).first(count),
                   std::span(disparity_px).first(count), fitness.subspan(begin, count));
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
