#include "flies/classify/people_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/objdetect.hpp>

#include "flies/classify/model_file.hpp"
#include "flies/classify/shipped_model.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr std::string_view kShipped = "flies-48x96";
constexpr std::string_view kShippedLinear = "flies-48x96-linear";
constexpr std::string_view kOpencv48 = "opencv-48x96";
constexpr std::string_view kOpencv64 = "opencv-64x128";
constexpr std::array kNames = {kShipped, kShippedLinear, kOpencv48, kOpencv64};

/// OpenCV's weights end with the bias. They come without a calibration: a window at OpenCV's threshold, a score of 0,
/// is called a toss-up.
PeopleModel from_opencv(std::string_view name, std::vector<float> weights_and_bias) {
  PeopleModel model;
  model.name = name;
  model.linear.bias = weights_and_bias.back();
  weights_and_bias.pop_back();
  model.linear.weights = std::move(weights_and_bias);
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

double probability(const ScoreCalibration& calibration, double score) {
  return 1.0 / (1.0 + std::exp(-(calibration.slope * score + calibration.offset)));
}

double person_probability(const PeopleModel& model, double linear, double kernel) {
  const double first = probability(model.linear.calibration, linear);
  if (!model.kernel) return first;
  if (linear < model.linear.reject_below)
    return kRejectedProbability * first / probability(model.linear.calibration, model.linear.reject_below);
  return kRejectedProbability + (1.0 - kRejectedProbability) * probability(model.kernel->calibration, kernel);
}

double person_probability(const PeopleModel& model, std::span<const float> features) {
  const double linear = linear_score(model.linear, features);
  const bool is_asked = model.kernel && linear >= model.linear.reject_below;
  return person_probability(model, linear, is_asked ? kernel_score(*model.kernel, features) : 0.0);
}

PeopleModel opencv_48x96() { return from_opencv(kOpencv48, cv::HOGDescriptor::getDaimlerPeopleDetector()); }

PeopleModel opencv_64x128() {
  PeopleModel model = from_opencv(kOpencv64, cv::HOGDescriptor::getDefaultPeopleDetector());
  model.hog.window_width_px = 64;
  model.hog.window_height_px = 128;
  return model;
}

PeopleModel shipped_people_model() {
  static const PeopleModel model = parse_people_model(std::string(shipped_model_text()), std::string(kShipped));
  return model;
}

std::span<const std::string_view> people_model_names() { return kNames; }

PeopleModel people_model(std::string_view name_or_path) {
  if (name_or_path == kShipped) return shipped_people_model();
  if (name_or_path == kShippedLinear)
    return parse_people_model(std::string(shipped_linear_model_text()), std::string(kShippedLinear));
  if (name_or_path == kOpencv48) return opencv_48x96();
  if (name_or_path == kOpencv64) return opencv_64x128();
  const std::string path(name_or_path);
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError(path, "",
                     fmt::format("no such people model; expected {} or a model file", fmt::join(kNames, ", ")));
  return read_people_model(path);
}

}  // namespace flies
