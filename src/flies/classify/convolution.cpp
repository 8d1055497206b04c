#include "flies/classify/convolution.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "flies/classify/dot.hpp"
#include "flies/classify/resample.hpp"

namespace flies {
namespace {

constexpr double kMostInput = 8.0;
/// Steps of an input of 1; the largest has 2048. Above that and a half, what is cut off rounds to the nearest.
constexpr double kInputSteps = 256.0;
constexpr int kMostSteps = 2048;
constexpr float kAbove = 2048.5F;

/// A picture in a frame of zeros one pixel wide.
template <class T>
Pixels<T> framed(std::size_t width, std::size_t height, std::size_t channels) {
  return Pixels<T>(width + 2, height + 2, channels);
}

/// Sums of every eighth: an order of its own, of which the compiler makes vectors.
template <class Term>
double sum_of_eight(std::span<const float> values, const Term& term) {
  double sums[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= values.size(); i += 8)
    for (std::size_t lane = 0; lane < 8; ++lane) sums[lane] += term(static_cast<double>(values[i + lane]));
  for (std::size_t lane = 0; i < values.size(); ++i, ++lane) sums[lane] += term(static_cast<double>(values[i]));
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

}  // namespace

void normalise_levels(std::span<float> levels) {
  const auto count = static_cast<double>(levels.size());
  const double mean = sum_of_eight(levels, [](double level) { return level; }) / count;
  const double variance = sum_of_eight(levels, [=](double level) { return (level - mean) * (level - mean); }) / count;
  const auto offset = static_cast<float>(mean);
  const auto scale = static_cast<float>(1.0 / std::max(std::sqrt(variance), kLeastContrast));
  constexpr auto kMost = static_cast<float>(kMostInput);
  for (float& level : levels) level = std::clamp((level - offset) * scale, -kMost, kMost);
}

std::vector<float> convolution_input(const GrayView& image, const ImageBox& window) {
  FloatImage levels = resample(image, window, kConvolutionWidth_px, kConvolutionHeight_px);
  normalise_levels(levels.values);
  return std::move(levels.values);
}

double convolution_score(const ConvolutionStage& stage, std::span<const float> input) {
  Pixels<double> picture(kConvolutionWidth_px, kConvolutionHeight_px, 1);
  assert(input.size() == picture.values.size());
  std::ranges::copy(input, picture.values.begin());
  for (const ConvolutionLayer& layer : stage.layers) {
    auto inside = framed<double>(picture.width, picture.height, picture.channels);
    for (std::size_t v = 0; v < picture.height; ++v)
      std::copy_n(picture.pixel(0, v), picture.row(), inside.pixel(1, v + 1));
    picture = convolved(inside, layer);
  }
  double score = stage.bias;
  for (std::size_t k = 0; k < stage.last.size(); ++k) score += picture.values[k] * stage.last[k];
  return score;
}

ConvolutionMachine::ConvolutionMachine(const ConvolutionStage& stage)
    : layers_(whole_layers(stage.layers, 1.0 / kInputSteps)), bias_(stage.bias) {
  std::size_t width = kConvolutionWidth_px, height = kConvolutionHeight_px;
  for (const WholeLayer& layer : layers_) {
    width = convolved_size(width + 2, layer.stride);
    height = convolved_size(height + 2, layer.stride);
  }
  // As wide as the activations, whose last channels may be nobody's.
  const std::size_t outputs = stage.layers.back().weights.rows, channels = layers_.back().outputs;
  const double step = layers_.back().output_step;
  last_.resize(width * height * channels);
  for (std::size_t k = 0; k < stage.last.size(); ++k)
    last_[k / outputs * channels + k % outputs] = static_cast<float>(static_cast<double>(stage.last[k]) * step);
}

/// Activations of every layer, its input first, each in its frame. The zeros stay.
struct ConvolutionMachine::Memory {
  std::vector<Pixels<std::int16_t>> activations;

  explicit Memory(const std::vector<WholeLayer>& layers) {
    std::size_t width = kConvolutionWidth_px, height = kConvolutionHeight_px;
    activations.push_back(framed<std::int16_t>(width, height, 2));
    for (const WholeLayer& layer : layers) {
      width = convolved_size(width + 2, layer.stride);
      height = convolved_size(height + 2, layer.stride);
      activations.push_back(framed<std::int16_t>(width, height, layer.outputs));
    }
  }
};

double ConvolutionMachine::score(std::span<const float> input) const {
  Memory memory(layers_);
  return score(input, memory);
}

double ConvolutionMachine::score(std::span<const float> input, Memory& memory) const {
  auto& first = memory.activations.front();
  for (std::size_t v = 0; v + 2 < first.height; ++v) {
    std::int16_t* levels = first.pixel(1, v + 1);
    const float* row = input.data() + v * (first.width - 2);
    for (std::size_t u = 0; u + 2 < first.width; ++u)  // to the nearest step
      levels[2 * u] =
          static_cast<std::int16_t>(static_cast<int>(row[u] * static_cast<float>(kInputSteps) + kAbove) - kMostSteps);
  }
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const auto& from = memory.activations[l];
    auto& to = memory.activations[l + 1];
    kernels::convolve(layers_[l].on(to.width - 2, to.height - 2), from.values.data(), from.row(), to.pixel(1, 1),
                      to.row());
  }
  double score = bias_;
  const auto& outputs = memory.activations.back();
  const std::size_t row = (outputs.width - 2) * outputs.channels;
  for (std::size_t v = 0; v + 2 < outputs.height; ++v) {
    const std::int16_t* levels = outputs.pixel(1, v + 1);
    const float* weights = last_.data() + v * row;
    score +=
        static_cast<double>(sum_terms(row, [=](std::size_t i) { return static_cast<float>(levels[i]) * weights[i]; }));
  }
  return score;
}

std::vector<double> ConvolutionMachine::scores(const GrayView& image, std::span<const ImageBox> windows) const {
  std::vector<double> scores(windows.size());
  // All windows take the same time: as many of them for each thread, which share their memory.
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t share = (windows.size() + threads - 1) / threads;
  tbb::parallel_for(std::size_t{0}, threads, [&](std::size_t part) {
    const std::size_t first = part * share, end = std::min(first + share, windows.size());
    if (first >= end) return;
    Memory memory(layers_);
    for (std::size_t i = first; i < end; ++i) scores[i] = score(convolution_input(image, windows[i]), memory);
  });
  return scores;
}

}  // namespace flies
