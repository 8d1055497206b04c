#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

/// Channels of an output come in so many.
constexpr std::size_t kConvolutionLanes = 16;

/// One 3 x 3 convolution of whole numbers.
struct Convolution {
  std::size_t width = 0, height = 0;  ///< of the output
  std::size_t stride = 1;
  std::size_t pairs = 1;    ///< of input channels
  std::size_t outputs = 0;  ///< channels, a multiple of `kConvolutionLanes`
  /// `outputs` pairs of weights for every pair of input channels, for every of the nine taps, row by row. Whatever the
  /// inputs, no sum of their products may leave 32 bits.
  const std::int16_t* weights = nullptr;
  const float* scale = nullptr;  ///< one an output channel
  const float* offset = nullptr;
};

/// What activations are, at most.
constexpr float kMostActive = 4095.0F;

/// Every output is its sum of products times scale plus offset, rounded to the nearest whole number, 0 at least and
/// `kMostActive` at most. Sums are exact, so the result is the same on every machine.
/// @param input  channels of one pixel after the other, row by row; of the pixels that the first output sees the one
///               above and left of it comes first
/// @param input_row, output_row numbers from one row to the next
void convolve(const Convolution& convolution, const std::int16_t* input, std::size_t input_row, std::int16_t* output,
              std::size_t output_row);

}  // namespace flies::kernels
