#pragma once

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <string>

namespace flies {

/// Keeps OpenCV from writing its log to standard error while it lives: what goes wrong is thrown, too.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

/// Reads a network of Darknet and checks that its weights are all there, for OpenCV reads on beyond the end of a file
/// that is too short, and that they are numbers.
/// @throws InputError naming the weights, cv::Exception
cv::dnn::Net read_darknet(const std::string& cfg_file, const std::string& weights_file);

}  // namespace flies
