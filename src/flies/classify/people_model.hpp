#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/classify/hog.hpp"

namespace flies {

/// Rows of equal length, one after the other.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<float> values;

  std::span<const float> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
};

/// From a score to the probability that the window shows a person: 1 / (1 + exp(-(slope * score + offset)))
/// (Platt 1999).
struct ScoreCalibration {
  double slope = 1.0;  ///< > 0, so that a higher score is a higher probability
  double offset = 0.0;
};

/// A linear support vector machine: score = bias + weights . features.
struct LinearStage {
  std::vector<float> weights;  ///< `feature_count` of them
  double bias = 0.0;
  ScoreCalibration calibration;
  /// Windows that score less are not shown to the second stage. Without a second stage it has no effect.
  double reject_below = -std::numeric_limits<double>::infinity();
};

/// A support vector machine with a Gaussian kernel on a linear projection of the features:
/// score = bias + sum_i coefficients[i] * exp(-gamma * |projection * (features - mean) - support_vectors[i]|^2).
struct KernelStage {
  std::vector<float> mean;          ///< `feature_count` of them
  Matrix projection;                ///< k x feature_count; 0 rows: the features themselves, less their mean
  Matrix support_vectors;           ///< n x k, or n x feature_count without a projection
  std::vector<float> coefficients;  ///< n
  double gamma = 1.0;               ///< > 0
  double bias = 0.0;
  ScoreCalibration calibration;
};

/// What a network of convolutions sees of every window in the second stage, and in front of the first.
inline constexpr int kConvolutionWidth_px = 48, kConvolutionHeight_px = 96;
inline constexpr int kFirstNetworkWidth_px = 20, kFirstNetworkHeight_px = 40;

/// A 3 x 3 convolution about every pixel, or every second one both ways:
/// output = min(max(bias + sum of weights . inputs, 0), largest).
struct ConvolutionLayer {
  int stride = 1;             ///< 1 or 2
  Matrix weights;             ///< a row an output channel: for every input channel nine, row by row
  std::vector<float> biases;  ///< one an output channel; none in a `FirstNetwork`
  double largest = 1.0;       ///< output, > 0
};

/// A small network of convolutions that looks before all else and rejects most windows. It convolves the grey levels
/// without anything around them and without biases, so that a strip is convolved once for all the windows in it, and
/// their contrast is divided out in the end: score = bias + last . outputs of the last layer / contrast, with the
/// standard deviation of the window's grey levels or `kLeastContrast`, whichever is larger. Every kernel of the first
/// layer sums to zero, so that only differences between grey levels count. The score is the log-odds of a person.
struct FirstNetwork {
  std::vector<ConvolutionLayer> layers;  ///< 1 to `kMaxConvolutionLayers`; the first has one input channel
  std::vector<float> last;               ///< channels of one pixel after the other, row by row
  double bias = 0.0;
  double reject_below = 0.0;  ///< windows that score less are not shown to the linear machine
};

/// Grey levels: a flat window is not blown up to noise.
inline constexpr double kLeastContrast = 8.0;

/// A network of convolutions on the window's grey levels (`convolution_input`), with zeros around the picture:
/// score = bias + last . outputs of the last layer. The two stages err on different windows, so the linear machine has
/// a say in the end, too: what is calibrated is score + linear_weight * its score.
struct ConvolutionStage {
  std::vector<ConvolutionLayer> layers;  ///< 1 to `kMaxConvolutionLayers`; the first has one input channel
  std::vector<float> last;               ///< channels of one pixel after the other, row by row
  double bias = 0.0;
  double linear_weight = 0.0;
  ScoreCalibration calibration;
};
inline constexpr std::size_t kMaxConvolutionLayers = 16;

/// A people classifier: plain values. The first stage is a linear machine on histograms of oriented gradients; in front
/// of it there may be a small network, which spares it most windows. Behind it there may be a second stage for the
/// windows that the linear machine does not reject: a kernel machine on the same histograms or a network of
/// convolutions on the window's grey levels.
struct PeopleModel {
  std::string name;  ///< names the model in errors
  std::optional<FirstNetwork> first_network;
  HogGeometry hog;
  LinearStage linear;
  std::optional<KernelStage> kernel;
  std::optional<ConvolutionStage> convolution;  ///< only where there is no kernel machine
  double threshold = 0.5;                       ///< a window is a person when its probability exceeds this; 0 to 1
  /// Training data, metrics, licence, in words: pairs of a key and a text, in the order they are shown.
  std::vector<std::pair<std::string, std::string>> about;
};

/// From one window to the next that shares convolutions with it, pixels of the windows.
int stride_of(const FirstNetwork& network);

/// Checks geometry, the length of every list and that all is finite.
/// @throws InputError naming `source` and the field
void check_people_model(const PeopleModel& model, const std::string& source);

/// `bias + weights . features`
double linear_score(const LinearStage& stage, std::span<const float> features);
double kernel_score(const KernelStage& stage, std::span<const float> features);
double probability(const ScoreCalibration& calibration, double score);

/// A probability that the linear stage has reached its verdict with: windows that it rejects share what is below,
/// windows that the second stage has seen share what is above. So the order of windows, and every curve drawn over it,
/// is well defined: whatever was rejected comes after whatever was not.
inline constexpr double kRejectedProbability = 1e-3;

/// Whether there is a second stage.
inline bool has_second_stage(const PeopleModel& model) { return model.kernel || model.convolution; }

/// The verdict on one window, 0 to 1, by both stages.
/// @param model    without networks, which see more than features
/// @param features `feature_count(model.hog)` of them
double person_probability(const PeopleModel& model, std::span<const float> features);

/// The same from scores.
/// @param linear of a window that no network in front rejects
/// @param second of the second stage; has no effect where there is none, or where the first one rejects
double person_probability(const PeopleModel& model, double linear, double second);

/// The verdict on a window that the network in front rejects: below all others.
/// @param score of that network
double rejected_probability(const PeopleModel& model, double score);

}  // namespace flies
