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

/// Layers and the sum behind them.
/// @param stage        with zeros around its pictures when it has biases, else without
/// @param size_px      of a picture
template <class Stage>
void check_layers(const Stage& stage, const std::string& name, bool has_biases, int width, int height,
                  const Checker& check) {
  constexpr std::size_t kTaps = 9, kMaxChannels = 1024;
  if (stage.layers.empty() || stage.layers.size() > kMaxConvolutionLayers)
    check.fail(name + ".layers", fmt::format("found {}, expected 1 to {}", stage.layers.size(), kMaxConvolutionLayers));
  std::size_t channels = 1;
  for (std::size_t i = 0; i < stage.layers.size(); ++i) {
    const ConvolutionLayer& layer = stage.layers[i];
    const std::string field = fmt::format("{}.layer_{}", name, i + 1);
    if (layer.stride != 1 && layer.stride != 2)
      check.fail(field + ".stride", fmt::format("found {}, expected 1 or 2", layer.stride));
    if (layer.weights.rows == 0 || layer.weights.rows > kMaxChannels)
      check.fail(field + ".weights", fmt::format("found {} rows, expected 1 to {}", layer.weights.rows, kMaxChannels));
    check.matrix(field + ".weights", layer.weights, channels * kTaps);
    check.numbers(field + ".biases", layer.biases, has_biases ? layer.weights.rows : 0);
    check.positive(field + ".largest", layer.largest);
    channels = layer.weights.rows;
    const int around = has_biases ? 2 : 0;
    if (std::min(width, height) + around < 3)
      check.fail(field, fmt::format("gets {} x {} px, expected at least 3 x 3", width, height));
    width = (width + around - 3) / layer.stride + 1;
    height = (height + around - 3) / layer.stride + 1;
  }
  check.numbers(name + ".last", stage.last,
                static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels);
  check.finite(name + ".bias", stage.bias);
}

void check_first_network(const FirstNetwork& network, const Checker& check) {
  check_layers(network, "first_network", false, kFirstNetworkWidth_px, kFirstNetworkHeight_px, check);
  check.finite("first_network.reject_below", network.reject_below);
  const int stride = stride_of(network);
  if (kFirstNetworkWidth_px % stride != 0 || kFirstNetworkHeight_px % stride != 0)
    check.fail("first_network", fmt::format("has a stride of {} px over all layers, which does not divide {} x {} px",
                                            stride, kFirstNetworkWidth_px, kFirstNetworkHeight_px));
}

}  // namespace

void check_people_model(const PeopleModel& model, const std::string& source) {
  const Checker check(source);
  check_hog_geometry(model.hog, source);
  const std::size_t features = feature_count(model.hog);
  if (model.first_network) check_first_network(*model.first_network, check);
  check.numbers("linear.weights", model.linear.weights, features);
  check.finite("linear.bias", model.linear.bias);
  check.calibration("linear.calibration", model.linear.calibration);
  if (has_second_stage(model)) check.finite("linear.reject_below", model.linear.reject_below);
  if (model.kernel) check_kernel(*model.kernel, features, check);
  if (model.kernel && model.convolution)
    check.fail("convolution", "found beside a kernel machine, expected one of them");
  if (model.convolution) {
    check_layers(*model.convolution, "convolution", true, kConvolutionWidth_px, kConvolutionHeight_px, check);
    check.finite("convolution.linear_weight", model.convolution->linear_weight);
    check.calibration("convolution.calibration", model.convolution->calibration);
  }
  if (!(model.threshold >= 0.0 && model.threshold <= 1.0))
    check.fail("threshold", fmt::format("found {}, expected 0 to 1", model.threshold));
}

double probability(const ScoreCalibration& calibration, double score) {
  return 1.0 / (1.0 + std::exp(-(calibration.slope * score + calibration.offset)));
}

int stride_of(const FirstNetwork& network) {
  int stride = 1;
  for (const auto& layer : network.layers) stride *= layer.stride;
  return stride;
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

double rejected_probability(const PeopleModel& model, double score) {
  constexpr ScoreCalibration kLogOdds;
  return kRejectedProbability * kRejectedProbability * probability(kLogOdds, score) /
         probability(kLogOdds, model.first_network->reject_below);
}

double person_probability(const PeopleModel& model, std::span<const float> features) {
  const double linear = linear_score(model.linear, features);
  const bool is_asked = model.kernel && linear >= model.linear.reject_below;
  return person_probability(model, linear, is_asked ? kernel_score(*model.kernel, features) : 0.0);
}

}  // namespace flies
