#include "flies/classify/people_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"

namespace flies {
namespace {

class Checker {
 public:
  explicit Checker(const std::string& source) : source_(source) {}

  void count(const std::string& field, std::size_t found, std::size_t expected) const {
    if (found != expected) fail(field, fmt::format("found {} numbers, expected {}", found, expected));
  }
  void finite(const std::string& field, double value) const {
    if (!std::isfinite(value)) fail(field, fmt::format("found {}, expected a finite number", value));
  }
  void finite(const std::string& field, const std::vector<float>& values) const {
    const auto wrong = std::find_if_not(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
    if (wrong != values.end()) finite(fmt::format("{}[{}]", field, wrong - values.begin()), *wrong);
  }
  void numbers(const std::string& field, const std::vector<float>& values, std::size_t expected) const {
    count(field, values.size(), expected);
    finite(field, values);
  }
  void matrix(const std::string& field, const Matrix& matrix, std::size_t columns) const {
    if (matrix.rows > 0 && matrix.columns != columns)
      fail(field, fmt::format("found rows of {}, expected {}", matrix.columns, columns));
    numbers(field, matrix.values, matrix.rows * matrix.columns);
  }
  void positive(const std::string& field, double value) const {
    if (!(value > 0.0) || !std::isfinite(value)) fail(field, fmt::format("found {}, expected more than 0", value));
  }
  void calibration(const std::string& field, const ScoreCalibration& calibration) const {
    positive(field + ".slope", calibration.slope);
    finite(field + ".offset", calibration.offset);
  }
  [[noreturn]] void fail(const std::string& field, const std::string& complaint) const {
    throw InputError(source_, field, complaint);
  }

 private:
  std::string source_;
};

void check_kernel(const KernelStage& kernel, std::size_t features, const Checker& check) {
  check.numbers("kernel.mean", kernel.mean, features);
  check.matrix("kernel.projection", kernel.projection, features);
  const std::size_t dimensions = kernel.projection.rows > 0 ? kernel.projection.rows : features;
  check.matrix("kernel.support_vectors", kernel.support_vectors, dimensions);
  check.numbers("kernel.coefficients", kernel.coefficients, kernel.support_vectors.rows);
  check.positive("kernel.gamma", kernel.gamma);
  check.finite("kernel.bias", kernel.bias);
  check.calibration("kernel.calibration", kernel.calibration);
}

void check_convolution(const ConvolutionStage& stage, const Checker& check) {
  constexpr std::size_t kTaps = 9, kMaxChannels = 1024;
  if (stage.layers.empty() || stage.layers.size() > kMaxConvolutionLayers)
    check.fail("convolution.layers",
               fmt::format("found {}, expected 1 to {}", stage.layers.size(), kMaxConvolutionLayers));
  std::size_t channels = 1;
  int width = kConvolutionWidth_px, height = kConvolutionHeight_px;
  for (std::size_t i = 0; i < stage.layers.size(); ++i) {
    const ConvolutionLayer& layer = stage.layers[i];
    const std::string field = fmt::format("convolution.layer_{}", i + 1);
    if (layer.stride != 1 && layer.stride != 2)
      check.fail(field + ".stride", fmt::format("found {}, expected 1 or 2", layer.stride));
    if (layer.weights.rows == 0 || layer.weights.rows > kMaxChannels)
      check.fail(field + ".weights", fmt::format("found {} rows, expected 1 to {}", layer.weights.rows, kMaxChannels));
    check.matrix(field + ".weights", layer.weights, channels * kTaps);
    check.numbers(field + ".biases", layer.biases, layer.weights.rows);
    check.positive(field + ".largest", layer.largest);
    channels = layer.weights.rows;
    width = (width + layer.stride - 1) / layer.stride;
    height = (height + layer.stride - 1) / layer.stride;
  }
  check.numbers("convolution.last", stage.last,
                static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels);
  check.finite("convolution.bias", stage.bias);
  check.finite("convolution.linear_weight", stage.linear_weight);
  check.calibration("convolution.calibration", stage.calibration);
}

}  // namespace

void check_people_model(const PeopleModel& model, const std::string& source) {
  check_hog_geometry(model.hog, source);
  const Checker check(source);
  const std::size_t features = feature_count(model.hog);
  check.numbers("linear.weights", model.linear.weights, features);
  check.finite("linear.bias", model.linear.bias);
  check.calibration("linear.calibration", model.linear.calibration);
  if (has_second_stage(model)) check.finite("linear.reject_below", model.linear.reject_below);
  if (model.kernel) check_kernel(*model.kernel, features, check);
  if (model.kernel && model.convolution)
    check.fail("convolution", "found beside a kernel machine, expected one of them");
  if (model.convolution) check_convolution(*model.convolution, check);
  if (!(model.threshold >= 0.0 && model.threshold <= 1.0))
    check.fail("threshold", fmt::format("found {}, expected 0 to 1", model.threshold));
}

double probability(const ScoreCalibration& calibration, double score) {
  return 1.0 / (1.0 + std::exp(-(calibration.slope * score + calibration.offset)));
}

double person_probability(const PeopleModel& model, double linear, double second) {
  const double first = probability(model.linear.calibration, linear);
  if (!has_second_stage(model)) return first;
  if (linear < model.linear.reject_below)
    return kRejectedProbability * first / probability(model.linear.calibration, model.linear.reject_below);
  const double last =
      model.kernel ? probability(model.kernel->calibration, second)
                   : probability(model.convolution->calibration, second + model.convolution->linear_weight * linear);
  return kRejectedProbability + (1.0 - kRejectedProbability) * last;
}

double person_probability(const PeopleModel& model, std::span<const float> features) {
  const double linear = linear_score(model.linear, features);
  const bool is_asked = model.kernel && linear >= model.linear.reject_below;
  return person_probability(model, linear, is_asked ? kernel_score(*model.kernel, features) : 0.0);
}

}  // namespace flies
