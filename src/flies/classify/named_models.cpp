#include "flies/classify/named_models.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <opencv2/objdetect.hpp>

#include "flies/classify/model_file.hpp"
#include "flies/classify/network_classifier.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/classify/shipped_model.hpp"
#include "flies/core/error.hpp"

// Apart from the shipped model: programs that do without the others need not load OpenCV for them.
namespace flies {
namespace {

constexpr std::string_view kShippedNetwork = "flies-48x96-network";
constexpr std::string_view kShippedKernel = "flies-48x96";
constexpr std::string_view kShippedLinear = "flies-48x96-linear";
constexpr std::string_view kOpencv48 = "opencv-48x96";
constexpr std::string_view kOpencv64 = "opencv-64x128";
constexpr std::array kNames = {kShippedNetwork, kShippedKernel, kShippedLinear, kOpencv48, kOpencv64};

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

}  // namespace

PeopleModel opencv_48x96() { return from_opencv(kOpencv48, cv::HOGDescriptor::getDaimlerPeopleDetector()); }

PeopleModel opencv_64x128() {
  PeopleModel model = from_opencv(kOpencv64, cv::HOGDescriptor::getDefaultPeopleDetector());
  model.hog.window_width_px = 64;
  model.hog.window_height_px = 128;
  return model;
}

std::span<const std::string_view> people_model_names() { return kNames; }

PeopleModel people_model(std::string_view name_or_path) {
  if (name_or_path == kShippedNetwork) return shipped_people_model();
  if (name_or_path == kShippedKernel)
    return parse_embedded_model(shipped_kernel_model_text(), std::string(kShippedKernel));
  if (name_or_path == kShippedLinear)
    return parse_embedded_model(shipped_linear_model_text(), std::string(kShippedLinear));
  if (name_or_path == kOpencv48) return opencv_48x96();
  if (name_or_path == kOpencv64) return opencv_64x128();
  const std::string path(name_or_path);
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw InputError(path, "",
                     fmt::format("no such people model; expected {} or a model file", fmt::join(kNames, ", ")));
  return read_people_model(path);
}

std::shared_ptr<const PeopleClassifier> people_classifier(std::string_view name_or_path) {
  if (const std::string path(name_or_path); is_network_file(path)) return network_classifier(path);
  return model_classifier(people_model(name_or_path));
}

}  // namespace flies
