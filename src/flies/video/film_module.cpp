// The module flies_video: OpenCV's videoio behind `Film`.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>

#include "flies/video/film.hpp"

namespace {

class OpenCvFilm final : public flies::FilmEncoder {
 public:
  OpenCvFilm(const cv::VideoWriter& writer, std::string path) : writer_(writer), path_(std::move(path)) {}
  void add(const cv::Mat& picture) override { writer_.write(picture); }
  std::size_t finish() override {
    writer_.release();
    const cv::VideoCapture film(path_, cv::CAP_FFMPEG);
    const double count = film.isOpened() ? film.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
    return count > 0.0 ? static_cast<std::size_t>(std::lround(count)) : 0;
  }

 private:
  cv::VideoWriter writer_;
  std::string path_;
};

}  // namespace

extern "C" flies::FilmEncoder* flies_open_film(const std::string& path, double rate_hz, cv::Size size) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // what FFmpeg has to say goes to standard error unasked
  try {
    for (const int code : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
      cv::VideoWriter writer(path, cv::CAP_FFMPEG, code, rate_hz, size);
      if (writer.isOpened()) return new OpenCvFilm(writer, path);
    }
  } catch (const std::exception&) {
  }
  return nullptr;
}
