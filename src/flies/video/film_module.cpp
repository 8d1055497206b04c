// The module flies_video: OpenCV's videoio behind `Film`.
#include <exception>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

#include "flies/video/film.hpp"

namespace {

class OpenCvFilm final : public flies::FilmEncoder {
 public:
  explicit OpenCvFilm(const cv::VideoWriter& writer) : writer_(writer) {}
  void add(const cv::Mat& picture) override { writer_.write(picture); }

 private:
  cv::VideoWriter writer_;
};

}  // namespace

extern "C" flies::FilmEncoder* flies_open_film(const std::string& path, double rate_hz, cv::Size size) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    for (const int code : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
      cv::VideoWriter writer(path, cv::CAP_FFMPEG, code, rate_hz, size);
      if (writer.isOpened()) return new OpenCvFilm(writer);
    }
  } catch (const std::exception&) {
  }
  return nullptr;
}
