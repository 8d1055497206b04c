#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "flies/classify/kernels/convolve.hpp"
#include "flies/classify/people_model.hpp"

namespace flies {

/// Channels of one pixel after the other, row by row.
template <class T>
struct Pixels {
  std::size_t width = 0, height = 0, channels = 0;
  std::vector<T> values;

  Pixels(std::size_t w, std::size_t h, std::size_t c) : width(w), height(h), channels(c), values(w * h * c) {}
  std::size_t row() const { return width * channels; }
  T* pixel(std::size_t u, std::size_t v) { return values.data() + v * row() + u * channels; }
  const T* pixel(std::size_t u, std::size_t v) const { return values.data() + v * row() + u * channels; }
};

/// Pixels that a 3 x 3 convolution makes of so many, along one axis.
inline std::size_t convolved_size(std::size_t size, std::size_t stride) { return (size - 3) / stride + 1; }

/// What a layer makes of a picture as it is defined, in double precision: slow. Zeros around are part of the picture.
Pixels<double> convolved(const Pixels<double>& picture, const ConvolutionLayer& layer);

/// A convolution in whole numbers of 16 bits: the weights of each output channel are rounded to some thousands of
/// steps, few enough that no sum of products overflows.
struct WholeLayer {
  std::size_t stride = 1, pairs = 1, outputs = 0;  ///< pairs of input channels; outputs in whole vectors
  std::vector<std::int16_t> weights;               ///< as `kernels::Convolution` has them
  std::vector<float> scale, offset;
  double output_step = 1.0;  ///< what a step of an activation is worth

  /// @param channels   of the input, even
  /// @param input_step what a step of the input is worth
  WholeLayer(const ConvolutionLayer& layer, std::size_t channels, double input_step);

  kernels::Convolution on(std::size_t width, std::size_t height) const {
    return {width, height, stride, pairs, outputs, weights.data(), scale.data(), offset.data()};
  }
};

/// Each fed by the one before.
/// @param input_step what a step of the first one's two input channels is worth, of which the second is nothing
std::vector<WholeLayer> whole_layers(const std::vector<ConvolutionLayer>& layers, double input_step);

}  // namespace flies
