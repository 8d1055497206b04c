#include "flies/classify/convolution_layer.hpp"

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

constexpr double kMostWeight = 2047.0;
/// Of the sizes of a channel's weights: times the largest activation it stays below 2^31.
constexpr double kMostWeights = 500'000.0;
constexpr std::size_t kTaps = 9;

std::size_t rounded_up(std::size_t count, std::size_t unit) { return (count + unit - 1) / unit * unit; }

}  // namespace

Pixels<double> convolved(const Pixels<double>& picture, const ConvolutionLayer& layer) {
  const auto stride = static_cast<std::size_t>(layer.stride);
  Pixels<double> result(convolved_size(picture.width, stride), convolved_size(picture.height, stride),
                        layer.weights.rows);
  for (std::size_t v = 0; v < result.height; ++v)
    for (std::size_t u = 0; u < result.width; ++u)
      for (std::size_t o = 0; o < result.channels; ++o) {
        double sum = layer.biases.empty() ? 0.0 : static_cast<double>(layer.biases[o]);
        for (std::size_t tap = 0; tap < kTaps; ++tap) {
          const double* pixel = picture.pixel(u * stride + tap % 3, v * stride + tap / 3);
          for (std::size_t i = 0; i < picture.channels; ++i) sum += pixel[i] * layer.weights.row(o)[i * kTaps + tap];
        }
        result.pixel(u, v)[o] = std::clamp(sum, 0.0, layer.largest);
      }
  return result;
}

WholeLayer::WholeLayer(const ConvolutionLayer& layer, std::size_t channels, double input_step)
    : stride(static_cast<std::size_t>(layer.stride)),
      pairs(channels / 2),
      outputs(rounded_up(layer.weights.rows, kernels::kConvolutionLanes)),
      weights(kTaps * pairs * outputs * 2),
      scale(outputs),
      offset(outputs),
      output_step(layer.largest / static_cast<double>(kernels::kMostActive)) {
  for (std::size_t o = 0; o < layer.weights.rows; ++o) {
    const auto row = layer.weights.row(o);
    double largest = 0.0, sum = 0.0;
    for (const float weight : row) {
      largest = std::max(largest, static_cast<double>(std::abs(weight)));
      sum += static_cast<double>(std::abs(weight));
    }
    const double steps = largest > 0.0 ? std::min(kMostWeight / largest, kMostWeights / sum) : 1.0;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::size_t channel = i / kTaps, tap = i % kTaps;
      weights[((tap * pairs + channel / 2) * outputs + o) * 2 + channel % 2] =
          static_cast<std::int16_t>(std::lround(static_cast<double>(row[i]) * steps));
    }
    scale[o] = static_cast<float>(input_step / steps / output_step);
    if (!layer.biases.empty()) offset[o] = static_cast<float>(static_cast<double>(layer.biases[o]) / output_step);
  }
}

std::vector<WholeLayer> whole_layers(const std::vector<ConvolutionLayer>& layers, double input_step) {
  std::vector<WholeLayer> whole;
  std::size_t channels = 2;
  for (const ConvolutionLayer& layer : layers) {
    whole.emplace_back(layer, channels, input_step);
    channels = whole.back().outputs;
    input_step = whole.back().output_step;
  }
  return whole;
}

}  // namespace flies
