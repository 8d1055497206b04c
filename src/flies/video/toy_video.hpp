#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <string>

namespace flies::testing {

/// A picture of one grey level in which a step tells the halves apart.
inline cv::Mat toy_picture(int level, int width, int height) {
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar::all(level));
  picture.colRange(width / 2, width) += cv::Scalar::all(40);
  return picture;
}

/// A film (Motion JPEG) whose n-th picture has the grey level 20 + 10 n in its left half, 40 more in its right one.
inline void write_toy_film(const std::string& path, int frames, double rate_hz = 50.0, int width = 128,
                           int height = 48) {
  cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_hz, {width, height});
  for (int i = 0; i < frames; ++i) writer.write(toy_picture(20 + 10 * i, width, height));
}

/// GStreamer's test sources are not on every machine.
inline bool has_gstreamer() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::VideoCapture capture("videotestsrc num-buffers=1 ! videoconvert ! video/x-raw,format=BGR ! appsink",
                           cv::CAP_GSTREAMER);
  cv::Mat picture;
  return capture.isOpened() && capture.read(picture);
}

}  // namespace flies::testing
