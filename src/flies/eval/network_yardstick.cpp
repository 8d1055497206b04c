#include "flies/eval/network_yardstick.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "flies/classify/opencv_network.hpp"
#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/io/folder.hpp"

namespace flies {
namespace {

/// What a .cfg says of the network as a whole; 0 where it does not.
struct Configuration {
  int width_px = 0, height_px = 0;
  int classes = 0;
};

/// The number that a text starts with, 0 when it starts with none.
int whole_number_at(std::string_view text, const std::string& cfg_file, std::string_view key) {
  int number = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), number).ec == std::errc::result_out_of_range)
    throw InputError(cfg_file, std::string(key.substr(0, key.size() - 1)),
                     fmt::format("found {}, which no network has", text));
  return number;
}

Configuration read_configuration(const std::string& cfg_file) {
  Configuration found;
  std::ifstream file(cfg_file);
  for (std::string line; std::getline(file, line);) {
    std::erase(line, ' ');
    for (auto [key, value] : {std::pair{"width=", &found.width_px}, std::pair{"height=", &found.height_px},
                              std::pair{"classes=", &found.classes}})
      if (*value == 0 && line.starts_with(key))
        *value = whole_number_at(std::string_view(line).substr(std::string_view(key).size()), cfg_file, key);
  }
  if (found.width_px <= 0 || found.height_px <= 0)
    throw InputError(cfg_file, "width, height", "are missing, and say which images the network is for");
  return found;
}

}  // namespace

struct NetworkSearch::Model {
  std::string file;
  NetworkSearchOptions options;
  cv::dnn::DetectionModel network;
};

NetworkSearch::NetworkSearch(const std::string& weights_file, const NetworkSearchOptions& options) {
  check_options(options, "network");
  const std::string cfg_file = std::filesystem::path(weights_file).replace_extension(".cfg").string();
  if (std::filesystem::path(weights_file).extension() != ".weights")
    throw InputError(weights_file, "",
                     "is no file of weights, expected one of Darknet's: NAME.weights beside NAME.cfg");
  for (const auto& file : {weights_file, cfg_file})
    if (!detail::is_there(file))
      throw InputError(file, "", "is missing; a network of Darknet is NAME.weights beside NAME.cfg");
  const Configuration configuration = read_configuration(cfg_file);
  if (configuration.classes > 0 && options.person_class >= configuration.classes)
    throw InputError(cfg_file, "network.person_class",
                     fmt::format("found {}, and the network has {} classes, counted from 0", options.person_class,
                                 configuration.classes));
  cv::Size size(configuration.width_px, configuration.height_px);
  if (options.width_px > 0) size.width = options.width_px;
  if (options.height_px > 0) size.height = options.height_px;
  try {
    const QuietOpenCv quiet;
    const cv::dnn::Net network = read_darknet(cfg_file, weights_file);
    model_.reset(new Model{weights_file, options, cv::dnn::DetectionModel(network)});
    constexpr double kToOne = 1.0 / 255.0;
    model_->network.setInputParams(kToOne, size, {}, true);
  } catch (const cv::Exception& error) {
    throw InputError(weights_file, "", "OpenCV cannot read this network: " + error.err);
  }
}

NetworkSearch::~NetworkSearch() = default;
NetworkSearch::NetworkSearch(NetworkSearch&&) noexcept = default;

PeopleSearch NetworkSearch::detect(const GrayView& left, const StereoCamera& camera, double least_probability) {
  check_camera_fits(camera, left.width_px, left.height_px, "camera");
  const cv::Mat image = mat_of(left);
  std::vector<int> classes;
  std::vector<float> confidences;
  std::vector<cv::Rect> boxes;
  const auto start = std::chrono::steady_clock::now();
  try {
    cv::Mat colored;
    cv::cvtColor(image, colored, cv::COLOR_GRAY2BGR);
    constexpr float kKeepDoubles = 0.0F;
    const QuietOpenCv quiet;
    model_->network.detect(colored, classes, confidences, boxes, static_cast<float>(least_probability), kKeepDoubles);
  } catch (const cv::Exception& error) {
    throw InputError(model_->file, "", "OpenCV cannot run this network: " + error.err);
  }
  PeopleSearch found;
  found.time_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const Projection projection(camera);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const cv::Rect& box = boxes[i];
    if (classes[i] == model_->options.person_class && box.height > 0)
      found.people.push_back(person_in_box({static_cast<double>(box.x), static_cast<double>(box.y),
                                            static_cast<double>(box.width), static_cast<double>(box.height)},
                                           confidences[i], projection));
  }
  found.people = keep_surest(std::move(found.people), model_->options.max_overlap);
  return found;
}

}  // namespace flies
