#include "flies/classify/first_network.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

#include "flies/classify/dot.hpp"
#include "flies/classify/resample.hpp"

namespace flies {
namespace {

/// Steps of a grey level; levels count from the middle, so that the largest has 2048.
constexpr float kLevelSteps = 16.0F, kMiddleLevel = 128.0F;
constexpr auto kMiddle = static_cast<int>(kMiddleLevel * kLevelSteps);
constexpr float kHalf = 0.5F;  // levels are not negative: what is cut off then rounds to the nearest
constexpr auto kWidth = static_cast<std::size_t>(kFirstNetworkWidth_px),
               kHeight = static_cast<std::size_t>(kFirstNetworkHeight_px);

double contrast_of(double sum, double squares, double count) {
  const double mean = sum / count;
  return std::max(std::sqrt(std::max(squares / count - mean * mean, 0.0)), kLeastContrast);
}

/// Contrast of every window of a strip, from sums over squares that windows share.
class Contrasts {
 public:
  /// @param strip levels in steps, each beside a channel that is nobody's
  /// @param cell  side of the squares, which divides windows and strip
  Contrasts(const Pixels<std::int16_t>& strip, std::size_t cell)
      : columns_(strip.width / cell),
        across_(kWidth / cell),
        down_(kHeight / cell),
        cells_(columns_ * (strip.height / cell)) {
    for (std::size_t v = 0; v < strip.height; ++v) {
      const std::int16_t* levels = strip.pixel(0, v);
      Sums* sums = cells_.data() + v / cell * columns_;
      for (std::size_t column = 0; column < columns_; ++column)
        for (std::size_t u = 0; u < cell; ++u, levels += 2) sums[column].add(levels[0], levels[0] * levels[0]);
    }
    // Of every column of a window's height.
    for (std::size_t i = 0; i + (down_ - 1) * columns_ < cells_.size(); ++i)
      for (std::size_t row = 1; row < down_; ++row) cells_[i].add(cells_[i + row * columns_]);
  }

  /// Of the window that begins with this square, in grey levels.
  double of(std::size_t column, std::size_t row) const {
    const Sums* sums = cells_.data() + row * columns_ + column;
    Sums total;
    for (std::size_t u = 0; u < across_; ++u) total.add(sums[u]);
    constexpr double kSteps = static_cast<double>(kLevelSteps);
    return contrast_of(total.levels / kSteps, total.squares / (kSteps * kSteps), static_cast<double>(kWidth * kHeight));
  }

 private:
  struct Sums {
    std::int32_t levels = 0;
    std::uint32_t squares = 0;  ///< of a window: at most 800 times 2048 squared

    void add(std::int32_t more_levels, std::int32_t more_squares) {
      levels += more_levels;
      squares += static_cast<std::uint32_t>(more_squares);
    }
    void add(const Sums& other) {
      levels += other.levels;
      squares += other.squares;
    }
  };
  std::size_t columns_, across_, down_;
  std::vector<Sums> cells_;
};

}  // namespace

double first_network_score(const FirstNetwork& network, std::span<const float> levels) {
  Pixels<double> picture(kWidth, kHeight, 1);
  assert(levels.size() == picture.values.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double level = picture.values[i] = static_cast<double>(levels[i]) - static_cast<double>(kMiddleLevel);
    sum += level;
    squares += level * level;
  }
  for (const ConvolutionLayer& layer : network.layers) picture = convolved(picture, layer);
  double score = 0.0;
  for (std::size_t k = 0; k < network.last.size(); ++k) score += picture.values[k] * network.last[k];
  return network.bias + score / contrast_of(sum, squares, static_cast<double>(levels.size()));
}

FirstNetworkMachine::FirstNetworkMachine(const FirstNetwork& network)
    : stride_(stride_of(network)),
      layers_(whole_layers(network.layers, 1.0 / static_cast<double>(kLevelSteps))),
      width_(kWidth),
      height_(kHeight),
      bias_(network.bias) {
  for (const WholeLayer& layer : layers_) {
    width_ = convolved_size(width_, layer.stride);
    height_ = convolved_size(height_, layer.stride);
  }
  // As wide as the activations, whose last channels may be nobody's.
  const std::size_t outputs = network.layers.back().weights.rows, channels = layers_.back().outputs;
  last_.resize(width_ * height_ * channels);
  for (std::size_t k = 0; k < network.last.size(); ++k)
    last_[k / outputs * channels + k % outputs] =
        static_cast<float>(static_cast<double>(network.last[k]) * layers_.back().output_step);
}

std::vector<double> FirstNetworkMachine::scores(const GrayView& image, const WindowSet& set) const {
  const int width_px = kFirstNetworkWidth_px + (set.columns - 1) * stride_;
  const int height_px = kFirstNetworkHeight_px + (set.rows - 1) * stride_;
  const FloatImage levels = resample(image, set.region, width_px, height_px);
  Pixels<std::int16_t> strip(static_cast<std::size_t>(width_px), static_cast<std::size_t>(height_px), 2);
  for (std::size_t i = 0; i < strip.width * strip.height; ++i)  // to the nearest step
    strip.values[2 * i] = static_cast<std::int16_t>(static_cast<int>(levels.values[i] * kLevelSteps + kHalf) - kMiddle);
  const Contrasts contrasts(strip, static_cast<std::size_t>(stride_));
  Pixels<std::int16_t> from = std::move(strip);
  for (const WholeLayer& layer : layers_) {
    Pixels<std::int16_t> to(convolved_size(from.width, layer.stride), convolved_size(from.height, layer.stride),
                            layer.outputs);
    kernels::convolve(layer.on(to.width, to.height), from.values.data(), from.row(), to.values.data(), to.row());
    from = std::move(to);
  }
  std::vector<double> scores;
  const std::size_t row = width_ * from.channels;
  for (std::size_t k = 0; k < set.windows.size(); ++k) {
    const auto column = static_cast<std::size_t>(set.column[k]), first_row = static_cast<std::size_t>(set.row[k]);
    double sum = 0.0;
    for (std::size_t v = 0; v < height_; ++v) {
      const std::int16_t* outputs = from.pixel(column, first_row + v);
      const float* weights = last_.data() + v * row;
      sum += static_cast<double>(
          sum_terms(row, [=](std::size_t i) { return static_cast<float>(outputs[i]) * weights[i]; }));
    }
    scores.push_back(bias_ + sum / contrasts.of(column, first_row));
  }
  return scores;
}

}  // namespace flies
