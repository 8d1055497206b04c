#include "flies/classify/people_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <opencv2/objdetect.hpp>

#include "flies/classify/dot.hpp"
#include "flies/classify/model_file.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr std::string_view kOpencv48 = "opencv-48x96";
constexpr std::string_view kOpencv64 = "opencv-64x128";

/// Chosen on real street pairs (docs/people.md): up to here false alarms fall faster than people are lost.
constexpr double kThreshold48 = 1.0;
constexpr double kThreshold64 = 0.0;

/// OpenCV's weights end with the bias. They come without a calibration: a window at the threshold is called a toss-up.
PeopleModel from_opencv(std::string_view name, double threshold, std::vector<float> weights_and_bias) {
  PeopleModel model;
  model.name = name;
  model.linear.bias = weights_and_bias.back();
  weights_and_bias.pop_back();
  model.linear.weights = std::move(weights_and_bias);
  model.linear.calibration.offset = -threshold;
  model.about = {{"training data", "see OpenCV, modules/objdetect/src/hog.cpp"}, {"licence", "that of OpenCV"}};
  return model;
}

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
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i])) finite(fmt::format("{}[{}]", field, i), values[i]);
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

}  // namespace

void check_people_model(const PeopleModel& model, const std::string& source) {
  check_hog_geometry(model.hog, source);
  const Checker check(source);
  const std::size_t features = feature_count(model.hog);
  check.numbers("linear.weights", model.linear.weights, features);
  check.finite("linear.bias", model.linear.bias);
  check.calibration("linear.calibration", model.linear.calibration);
  if (model.kernel) {
    check.finite("linear.reject_below", model.linear.reject_below);
    check_kernel(*model.kernel, features, check);
  }
  if (!(model.threshold >= 0.0 && model.threshold <= 1.0))
    check.fail("threshold", fmt::format("found {}, expected 0 to 1", model.threshold));
}

double linear_score(const LinearStage& stage, std::span<const float> features) {
  assert(features.size() == stage.weights.size());
  return stage.bias + dot(stage.weights.data(), features.data(), features.size());
}

double kernel_score(const KernelStage& stage, std::span<const float> features) {
  assert(features.size() == stage.mean.size());
  std::vector<float> centred(features.begin(), features.end());
  for (std::size_t i = 0; i < centred.size(); ++i) centred[i] -= stage.mean[i];
  std::vector<float> point;
  for (std::size_t i = 0; i < stage.projection.rows; ++i)
    point.push_back(dot(stage.projection.row(i).data(), centred.data(), centred.size()));
  if (stage.projection.rows == 0) point = std::move(centred);

  double score = stage.bias;
  for (std::size_t i = 0; i < stage.support_vectors.rows; ++i)
    score += stage.coefficients[i] *
             std::exp(-stage.gamma * squared_distance(point.data(), stage.support_vectors.row(i).data(), point.size()));
  return score;
}

double probability(const ScoreCalibration& calibration, double score) {
  return 1.0 / (1.0 + std::exp(-(calibration.slope * score + calibration.offset)));
}

double person_probability(const PeopleModel& model, std::span<const float> features) {
  const double score = linear_score(model.linear, features);
  const double first = probability(model.linear.calibration, score);
  if (!model.kernel) return first;
  if (score < model.linear.reject_below)
    return kRejectedProbability * first / probability(model.linear.calibration, model.linear.reject_below);
  const double second = probability(model.kernel->calibration, kernel_score(*model.kernel, features));
  return kRejectedProbability + (1.0 - kRejectedProbability) * second;
}

PeopleModel opencv_48x96() {
  return from_opencv(kOpencv48, kThreshold48, cv::HOGDescriptor::getDaimlerPeopleDetector());
}

PeopleModel opencv_64x128() {
  PeopleModel model = from_opencv(kOpencv64, kThreshold64, cv::HOGDescriptor::getDefaultPeopleDetector());
  model.hog.window_width_px = 64;
  model.hog.window_height_px = 128;
  return model;
}

PeopleModel people_model(std::string_view name_or_path) {
  if (name_or_path == kOpencv48) return opencv_48x96();
  if (name_or_path == kOpencv64) return opencv_64x128();
  const std::string path(name_or_path);
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError(path, "",
                     fmt::format("no such people model; expected {}, {} or a model file", kOpencv48, kOpencv64));
  return read_people_model(path);
}

}  // namespace flies
