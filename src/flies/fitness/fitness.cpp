#include "flies/fitness/fitness.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "flies/core/usable_pair.hpp"
#include "flies/fitness/kernels/kernel.hpp"

namespace flies {
namespace {

constexpr std::string_view kOptionsSource = "fitness options";

/// Flies a task: large enough to hide the scheduler, small enough to balance two dozen cores.
constexpr std::size_t kFliesPerTask = 256;

/// Projection of what is behind the camera.
constexpr StereoPoint kNowhere = {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};

/// Places that go through the kernel together.
constexpr std::size_t kPlacesAtOnce = 256;

/// Projections farther out than this are nowhere near an image and would overflow the conversion to int.
constexpr float kMaxCoordinate_px = 1e6F;

int round_half_to_even(float x) { return static_cast<int>(std::lrint(x)); }

/// The places whose neighbourhoods lie inside both images.
struct Located {
  std::array<kernels::PatchPlace, kPlacesAtOnce> places;
  std::array<std::uint32_t, kPlacesAtOnce> index;  ///< of each among all
  std::size_t count = 0;
};

kernels::PatchImages patch_images(const RectifiedPair& pair, const FitnessOptions& options) {
  const auto end = [](const GrayView& image) { return image.row(image.height_px - 1) + image.width_px; };
  return {.left_end = end(pair.left),
          .right_end = end(pair.right),
          .left_stride = options.row_step * pair.left.stride,
          .right_stride = options.row_step * pair.right.stride,
          .columns = 2 * options.half_width_px + 1,
          .rows = 2 * (options.half_height_px / options.row_step) + 1};
}

Located locate(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
               std::span<const float> v_px, std::span<const float> disparity_px) {
  const int half_u = options.half_width_px, half_v = options.half_height_px;
  const int first_row = -(half_v - half_v % options.row_step);
  const int width = pair.left.width_px, height = pair.left.height_px;
  const bool nearest = options.sampling == PatchSampling::nearest;
  Located located;
  for (std::size_t i = 0; i < u_px.size(); ++i) {
    if (!(std::abs(u_px[i]) < kMaxCoordinate_px && std::abs(v_px[i]) < kMaxCoordinate_px &&
          std::abs(disparity_px[i]) < kMaxCoordinate_px))
      continue;
    const int u_left = round_half_to_even(u_px[i]), v = round_half_to_even(v_px[i]);
    // The left projection may be rounded freely as long as the disparity between the two patches stays exact.
    const int u_right16 = nearest
                              ? round_half_to_even(u_px[i] - disparity_px[i]) * kernels::kScale
                              : round_half_to_even((static_cast<float>(u_left) - disparity_px[i]) * kernels::kScale);
    const int u_right = u_right16 >> 4;
    if (u_left - half_u < 0 || u_left + half_u >= width || v - half_v < 0 || v + half_v >= height ||
        u_right - half_u < 0 || u_right + half_u + 1 >= width)
      continue;
    located.places[located.count] = {.left = pair.left.row(v + first_row) + u_left - half_u,
                                     .right = pair.right.row(v + first_row) + u_right - half_u,
                                     .fraction16 = u_right16 & (kernels::kScale - 1)};
    located.index[located.count++] = static_cast<std::uint32_t>(i);
  }
  return located;
}

/// Eq. (1) from its summed squared differences in (1/16 grey level)^2.
double louchet(const kernels::PatchPlace& place, std::ptrdiff_t stride, const FitnessOptions& options,
               std::int64_t squared_differences) {
  const int rows_above = options.half_height_px - options.half_height_px % options.row_step;
  const std::uint8_t* centre = place.left + rows_above * stride + options.half_width_px;
  const double gradient_u = 0.5 * (centre[1] - centre[-1]);
  const double gradient_v = 0.5 * (centre[stride] - centre[-stride]);
  const double denominator = options.louchet_constant + static_cast<double>(squared_differences) / 256.0;
  return std::sqrt(std::sqrt(gradient_u * gradient_u + gradient_v * gradient_v)) / denominator;
}

/// x to a power that is a multiple of 1/4, as those of the presets are, by multiplications and roots.
/// @param x  not negative
double quarter_power(double x, unsigned quarters) {
  double result = 1.0;
  if (quarters % 4 != 0) {
    const double root = std::sqrt(x);
    if (quarters & 2U) result *= root;
    if (quarters & 1U) result *= std::sqrt(root);
  }
  for (unsigned n = quarters / 4; n != 0; n >>= 1U, x *= x)
    if (n & 1U) result *= x;
  return result;
}

/// x -> x^power.
class Power {
 public:
  explicit Power(double power)
      : power_(power), quarters_(static_cast<unsigned>(4.0 * power)), is_quarters_(quarters_ == 4.0 * power) {}
  double operator()(double x) const { return is_quarters_ ? quarter_power(x, quarters_) : std::pow(x, power_); }

 private:
  double power_;
  unsigned quarters_;
  bool is_quarters_;
};

/// Turns moments, whose scales are those of PatchMoments, into the correlation coefficient and the mean covariance.
class Correlation {
 public:
  Correlation(const kernels::PatchImages& images, double noise_gray)
      : columns_(images.columns),
        pixels_(images.columns * images.rows),
        noise_(pixels_ * noise_gray * noise_gray * columns_) {}

  double coefficient(const kernels::PatchMoments& moments) const {
    constexpr double kSquare = kernels::kScale * kernels::kScale;
    const double square =
        (static_cast<double>(moments.ll) + noise_) * (static_cast<double>(moments.rr) / kSquare + noise_);
    return square > 0.0 ? static_cast<double>(moments.lr) / (kernels::kScale * std::sqrt(square)) : 0.0;
  }
  double mean_covariance(const kernels::PatchMoments& moments) const {
    return static_cast<double>(moments.lr) / (kernels::kScale * columns_ * pixels_);
  }

 private:
  double columns_, pixels_;
  double noise_;  ///< summed over the patch, times its columns
};

/// Calls `evaluate`(located places, values of all places) for some places after others; values not set there are 0.
template <class Evaluate>
void for_each_block(const RectifiedPair& pair, const FitnessOptions& options, std::span<const float> u_px,
                    std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> values,
                    const Evaluate& evaluate) {
  assert(u_px.size() == values.size() && v_px.size() == values.size() && disparity_px.size() == values.size());
  for (std::size_t begin = 0; begin < values.size(); begin += kPlacesAtOnce) {
    const std::size_t count = std::min(kPlacesAtOnce, values.size() - begin);
    const auto block = values.subspan(begin, count);
    std::fill(block.begin(), block.end(), 0.0F);
    const Located located = locate(pair, options, u_px.subspan(begin, count), v_px.subspan(begin, count),
                                   disparity_px.subspan(begin, count));
    if (located.count > 0) evaluate(located, block);
  }
}

/// Evaluates the kernel and sets the value of each located place to `finish`(its result, the place).
template <class Result, class Sums, class Finish>
void evaluate_block(const kernels::PatchImages& images, const Located& located, std::span<float> values,
                    const Sums& sums, const Finish& finish) {
  std::array<Result, kPlacesAtOnce> results;
  const auto places = std::span(located.places).first(located.count);
  sums(images, places, results.data());
  for (std::size_t i = 0; i < located.count; ++i)
    values[located.index[i]] = static_cast<float>(finish(results[i], places[i]));
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

void score_points(const RectifiedPair& given, const FitnessOptions& options, std::span<const float> u_px,
                  std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> fitness) {
  using kernels::PatchPlace;
  check_options(options, kOptionsSource);
  const RectifiedPair pair = detail::usable_pair(given);
  const auto images = patch_images(pair, options);
  const auto& kernel = kernels::chosen_kernel();
  const Correlation correlation(images, options.noise_gray);
  const Power raise_coefficient(options.correlation_power), raise_contrast(options.contrast_power);
  for_each_block(
      pair, options, u_px, v_px, disparity_px, fitness, [&](const Located& located, std::span<float> values) {
        switch (options.function) {
          case FitnessFunction::louchet:
            return evaluate_block<std::int64_t>(images, located, values, kernel.sum_squared_differences,
                                                [&](std::int64_t sum, const PatchPlace& place) {
                                                  return louchet(place, pair.left.stride, options, sum);
                                                });
          case FitnessFunction::covariance:
            // Eq. (2), not below 0: a fitness serves as a weight.
            return evaluate_block<float>(images, located, values, kernel.sum_weighted_covariances,
                                         [](float sum, const PatchPlace&) { return std::max(0.0F, sum); });
          case FitnessFunction::correlation:
            return evaluate_block<kernels::PatchMoments>(images, located, values, kernel.sum_moments,
                                                         [&](const kernels::PatchMoments& moments, const PatchPlace&) {
                                                           if (moments.lr <= 0) return 0.0;
                                                           return raise_coefficient(correlation.coefficient(moments)) *
                                                                  raise_contrast(correlation.mean_covariance(moments));
                                                         });
        }
      });
}

void correlate_points(const RectifiedPair& given, const FitnessOptions& options, std::span<const float> u_px,
                      std::span<const float> v_px, std::span<const float> disparity_px, std::span<float> coefficient) {
  check_options(options, kOptionsSource);
  const RectifiedPair pair = detail::usable_pair(given);
  const auto images = patch_images(pair, options);
  const auto& kernel = kernels::chosen_kernel();
  const Correlation correlation(images, options.noise_gray);
  for_each_block(
      pair, options, u_px, v_px, disparity_px, coefficient, [&](const Located& located, std::span<float> values) {
        evaluate_block<kernels::PatchMoments>(images, located, values, kernel.sum_moments,
                                              [&](const kernels::PatchMoments& moments, const kernels::PatchPlace&) {
                                                return correlation.coefficient(moments);
                                              });
      });
}

float score_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  return evaluate_one(point, [&](auto... spans) { score_points(pair, options, spans...); });
}

float correlate_point(const RectifiedPair& pair, const FitnessOptions& options, const StereoPoint& point) {
  return evaluate_one(point, [&](auto... spans) { correlate_points(pair, options, spans...); });
}

void score_flies(const RectifiedPair& given, const Projection& projection, const FitnessOptions& options,
                 const Population& flies, std::size_t first, std::span<float> fitness) {
  assert(first + fitness.size() <= flies.size());
  check_options(options, kOptionsSource);
  const RectifiedPair pair = detail::usable_pair(given);
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
