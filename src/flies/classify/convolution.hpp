#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/classify/convolution_layer.hpp"
#include "flies/classify/people_model.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// What a network of convolutions sees of a window: grey levels less their mean, over their standard deviation or
/// `kLeastContrast`, whichever is larger, -8 to 8; row by row, `kConvolutionWidth_px` x `kConvolutionHeight_px` of
/// them.
/// @param window with an area
std::vector<float> convolution_input(const GrayView& image, const ImageBox& window);

/// The same of grey levels that are there already.
/// @param levels as many; become the input
void normalise_levels(std::span<float> levels);

/// The stage's score as it is defined, in double precision: slow.
/// @param input from `convolution_input`
double convolution_score(const ConvolutionStage& stage, std::span<const float> input);

/// A stage of convolutions in whole numbers of 16 bits: weights of each channel and activations are rounded to some
/// thousands of steps, sums are exact.
class ConvolutionMachine {
 public:
  /// @param stage that `check_people_model` finds nothing wrong with
  explicit ConvolutionMachine(const ConvolutionStage& stage);

  /// The same as `convolution_score` but for rounding, and the same on every machine. Threads: oneTBB's current arena.
  /// @param windows with an area each
  /// @returns one score per window
  std::vector<double> scores(const GrayView& image, std::span<const ImageBox> windows) const;
  double score(std::span<const float> input) const;

 private:
  struct Memory;

  double score(std::span<const float> input, Memory& memory) const;

  std::vector<WholeLayer> layers_;
  std::vector<float> last_;
  double bias_ = 0.0;
};

}  // namespace flies
