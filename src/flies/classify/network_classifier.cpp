#include "flies/classify/network_classifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <opencv2/dnn.hpp>
#include <optional>

#include "flies/classify/opencv_network.hpp"
#include "flies/classify/resample.hpp"
#include "flies/core/error.hpp"
#include "flies/io/options_yaml.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

/// Windows that the network sees in one go: enough to keep it busy, few enough for any memory.
constexpr std::size_t kBatch = 64;

/// @throws InputError naming the network when it has none: the numbers of a network alone do not say what they mean
NetworkOptions read_side_file(const fs::path& network) {
  const fs::path path = fs::path(network).replace_extension(".yaml");
  std::error_code error;
  if (!fs::exists(path, error))
    throw InputError(network.string(), "",
                     fmt::format("expected {} beside it, which describes the input and output of the network "
                                 "(input_width_px, channels, output, ...); it may be empty if all defaults fit",
                                 path.filename().string()));
  NetworkOptions options;
  if (fs::is_regular_file(path, error) && fs::file_size(path, error) == 0) return options;
  for (const auto& setting : load_options_yaml(path.string()))
    set_option(options, setting.path, setting.text, setting.source);
  return options;
}

/// The first line of what OpenCV says, without the place in its sources.
std::string first_line(const cv::Exception& error) {
  const std::string text = error.err.empty() ? error.what() : error.err;
  return text.substr(0, text.find('\n'));
}

/// The file with the same name and this extension. @throws InputError when it must be there and is not
std::string beside(const fs::path& path, const char* extension, bool is_needed) {
  const fs::path other = fs::path(path).replace_extension(extension);
  std::error_code error;
  if (fs::is_regular_file(other, error)) return other.string();
  if (is_needed) throw InputError(path.string(), "", fmt::format("expected {} beside it", other.filename().string()));
  return {};
}

cv::dnn::Net read_network(const fs::path& path) {
  const std::string extension = path.extension().string();
  const bool is_caffe = extension == ".prototxt" || extension == ".caffemodel";
  const bool is_darknet = extension == ".cfg" || extension == ".weights";
  const std::string layers = is_caffe ? beside(path, ".prototxt", true) : is_darknet ? beside(path, ".cfg", true) : "";
  const std::string weights = is_caffe     ? beside(path, ".caffemodel", extension == ".caffemodel")
                              : is_darknet ? beside(path, ".weights", true)
                                           : "";
  const QuietOpenCv quiet;
  try {
    if (is_caffe) return cv::dnn::readNetFromCaffe(layers, weights);
    if (is_darknet) return read_darknet(layers, weights);
    return cv::dnn::readNetFromONNX(path.string());
  } catch (const cv::Exception& error) {
    throw InputError(path.string(), "", "OpenCV cannot read this network: " + first_line(error));
  }
}

double sigmoid(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

double softmax(const float* values, int count, int index) {
  double sum = 0.0;
  for (int i = 0; i < count; ++i) sum += std::exp(static_cast<double>(values[i]) - values[index]);
  return 1.0 / sum;
}

class NetworkClassifier final : public PeopleClassifier {
 public:
  explicit NetworkClassifier(const std::string& path)
      : name_(path), options_(read_side_file(path)), network_(read_network(path)) {
    network_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    const cv::Mat blank(options_.input_height_px, options_.input_width_px, CV_32F, cv::Scalar(0));
    const QuietOpenCv quiet;
    try {
      run({blank, blank});
    } catch (const cv::Exception& error) {
      throw InputError(
          name_, "",
          fmt::format("OpenCV cannot run this network on {} x {} px with {} channels: {}", options_.input_width_px,
                      options_.input_height_px, options_.channels, first_line(error)));
    }
  }

  const std::string& name() const override { return name_; }
  double threshold() const override { return options_.threshold; }

  std::vector<double> classify(const GrayView& image, std::span<const ImageBox> windows) const override {
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < windows.size(); ++i)
      if (is_worth_a_look(windows[i], image)) seen.push_back(i);
    std::vector<double> probabilities(windows.size(), 0.0);
    for (std::size_t first = 0; first < seen.size(); first += kBatch) {
      std::vector<cv::Mat> batch;
      const std::size_t end = std::min(first + kBatch, seen.size());
      for (std::size_t i = first; i < end; ++i) batch.push_back(pixels_of(image, windows[seen[i]]));
      const auto results = run(batch);
      for (std::size_t i = first; i < end; ++i) probabilities[seen[i]] = results[i - first];
    }
    return probabilities;
  }

 private:
  cv::Mat pixels_of(const GrayView& image, const ImageBox& window) const {
    FloatImage pixels = resample(image, window, options_.input_width_px, options_.input_height_px);
    return cv::Mat(pixels.height_px, pixels.width_px, CV_32F, pixels.values.data()).clone();
  }

  /// One probability per picture.
  std::vector<double> run(const std::vector<cv::Mat>& pictures) const {
    std::vector<cv::Mat> inputs;
    for (const cv::Mat& gray : pictures) {
      cv::Mat input;
      cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(options_.channels), gray), input);
      inputs.push_back(input);
    }
    const cv::Mat blob = cv::dnn::blobFromImages(inputs, options_.scale, {}, cv::Scalar::all(options_.mean));
    cv::Mat output;
    {
      const std::lock_guard<std::mutex> lock(mutex_);  // a network keeps its intermediate results
      network_.setInput(blob);
      output = network_.forward().clone();
    }
    const auto count = static_cast<int>(output.total() / pictures.size());
    if (output.type() != CV_32F || output.total() % pictures.size() != 0 || options_.person_index >= count)
      throw InputError(name_, "person_index",
                       fmt::format("found {}, but the network gives {} numbers for {} windows", options_.person_index,
                                   output.total(), pictures.size()));
    std::vector<double> probabilities;
    for (std::size_t i = 0; i < pictures.size(); ++i)
      probabilities.push_back(probability_of(output.ptr<float>() + i * static_cast<std::size_t>(count), count));
    return probabilities;
  }

  double probability_of(const float* values, int count) const {
    const double value = values[options_.person_index];
    if (!cv::checkRange(cv::Mat(1, count, CV_32F, const_cast<float*>(values))))
      throw InputError(name_, "", "gives numbers for a window that are not finite: are its weights damaged?");
    switch (options_.output) {
      case NetworkOutput::logit:
        return sigmoid(value);
      case NetworkOutput::softmax:
        return softmax(values, count, options_.person_index);
      case NetworkOutput::probability:
        break;
    }
    return std::clamp(value, 0.0, 1.0);
  }

  std::string name_;
  NetworkOptions options_;
  mutable std::mutex mutex_;
  mutable cv::dnn::Net network_;
};

}  // namespace

bool is_network_file(const std::string& path) {
  constexpr std::array<std::string_view, 5> kExtensions = {".onnx", ".cfg", ".weights", ".prototxt", ".caffemodel"};
  return std::ranges::find(kExtensions, fs::path(path).extension().string()) != kExtensions.end();
}

std::shared_ptr<const PeopleClassifier> network_classifier(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw InputError(path, "", "no such network file");
  return std::make_shared<NetworkClassifier>(path);
}

}  // namespace flies
