// The module flies_video: OpenCV's videoio behind `open_capture`.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "flies/video/capture.hpp"

namespace {

class OpenCvCapture final : public flies::Capture {
 public:
  OpenCvCapture(const cv::VideoCapture& capture, flies::SourceKind kind) : capture_(capture), kind_(kind) {}

  bool read(flies::GrayImage& image) override {
    try {
      if (!capture_.read(picture_) || picture_.empty() || picture_.depth() != CV_8U) return false;
      image.width_px = picture_.cols;
      image.height_px = picture_.rows;
      image.pixels.resize(picture_.total());
      cv::Mat gray(picture_.rows, picture_.cols, CV_8UC1, image.pixels.data());
      switch (picture_.channels()) {
        case 1:
          picture_.copyTo(gray);
          return true;
        case 3:
          cv::cvtColor(picture_, gray, cv::COLOR_BGR2GRAY);
          return true;
        case 4:
          cv::cvtColor(picture_, gray, cv::COLOR_BGRA2GRAY);
          return true;
        default:
          return false;
      }
    } catch (const std::exception&) {  // videoio's own, about a source that went away
      return false;
    }
  }

  double rate_hz() const override {
    constexpr double kMost_hz = 10000.0;
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    return std::isfinite(rate) && rate > 0.0 && rate <= kMost_hz ? rate : 0.0;
  }

  std::uint64_t pictures() const override {
    const double count = kind_ != flies::SourceKind::device ? capture_.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
    return count > 0.0 && count < 1e12 ? static_cast<std::uint64_t>(std::llround(count)) : 0;
  }

  std::optional<double> stamp_s() const override {
    constexpr double kMost_s = 1e7;  // raw streams have nonsense for stamps
    const double stamp_s = kind_ != flies::SourceKind::device ? 1e-3 * capture_.get(cv::CAP_PROP_POS_MSEC) : -1.0;
    return stamp_s >= 0.0 && stamp_s < kMost_s ? std::optional(stamp_s) : std::nullopt;
  }

  /// Lossy films of grey pictures, and conversions on the way, leave channels that differ by a few levels.
  bool has_colors() const override {
    constexpr double kDiffer = 8.0;      // levels
    constexpr double kOfPixels = 0.005;  // a share
    for (int channel = 1; channel < std::min(3, picture_.channels()); ++channel) {
      cv::Mat first, other, difference;
      cv::extractChannel(picture_, first, 0);
      cv::extractChannel(picture_, other, channel);
      cv::absdiff(first, other, difference);
      if (cv::countNonZero(difference > kDiffer) > kOfPixels * static_cast<double>(difference.total())) return true;
    }
    return false;
  }

  /// OpenCV hands on what V4L2 says of the buffer, which is by the monotonic clock of Linux, as the steady clock is.
  std::optional<std::chrono::steady_clock::time_point> taken_at() const override {
    const double time_ms = kind_ == flies::SourceKind::device ? capture_.get(cv::CAP_PROP_POS_MSEC) : 0.0;
    if (!(time_ms > 0.0)) return std::nullopt;
    const std::chrono::duration<double, std::milli> since_start(time_ms);
    return std::chrono::steady_clock::time_point(
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(since_start));
  }

 private:
  cv::VideoCapture capture_;
  flies::SourceKind kind_;
  cv::Mat picture_;
};

cv::VideoCapture open_device(const flies::CaptureRequest& request) {
  const bool is_number = request.source.find('/') == std::string::npos;
  cv::VideoCapture capture;
  if (is_number)
    capture.open(std::atoi(request.source.c_str()), cv::CAP_V4L2);
  else
    capture.open(request.source, cv::CAP_V4L2);
  if (request.width_px > 0) capture.set(cv::CAP_PROP_FRAME_WIDTH, request.width_px);
  if (request.height_px > 0) capture.set(cv::CAP_PROP_FRAME_HEIGHT, request.height_px);
  if (request.rate_hz > 0.0) capture.set(cv::CAP_PROP_FPS, request.rate_hz);
  return capture;
}

cv::VideoCapture open_stream(const std::string& source) {
  if (source.find('!') == std::string::npos) return cv::VideoCapture(source, cv::CAP_FFMPEG);
  const bool has_sink = source.find("appsink") != std::string::npos;
  // GStreamer else allows 20 ms for processing, and a sink gives the pictures of a living source that much later.
  const std::string sink = " ! videoconvert ! video/x-raw,format=BGR ! appsink processing-deadline=0";
  return cv::VideoCapture(has_sink ? source : source + sink, cv::CAP_GSTREAMER);
}

/// With its other readers OpenCV would take `a0.png` for a series of pictures, and GStreamer has no end of words for
/// what is no film.
cv::VideoCapture open_file(const std::string& source) { return cv::VideoCapture(source, cv::CAP_FFMPEG); }

/// What videoio and its readers have to say goes to standard error unasked; the caller says it in words of its own.
void keep_quiet() {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  setenv("GST_DEBUG", "0", 0);
  // GStreamer's complaints about pipelines that videoio takes apart go through GLib, which it brings along.
  using Handler = void (*)(const char*, int, const char*, void*);
  void* glib = dlopen("libglib-2.0.so.0", RTLD_NOW | RTLD_NOLOAD);
  if (glib == nullptr) return;
  const auto set_handler = reinterpret_cast<Handler (*)(Handler, void*)>(dlsym(glib, "g_log_set_default_handler"));
  if (set_handler != nullptr) set_handler([](const char*, int, const char*, void*) {}, nullptr);
}

}  // namespace

extern "C" flies::Capture* flies_open_capture(const flies::CaptureRequest& request, flies::SourceKind kind) {
  static const bool is_quiet = (keep_quiet(), true);
  static_cast<void>(is_quiet);
  try {
    cv::VideoCapture capture = kind == flies::SourceKind::device   ? open_device(request)
                               : kind == flies::SourceKind::stream ? open_stream(request.source)
                                                                   : open_file(request.source);
    return capture.isOpened() ? new OpenCvCapture(capture, kind) : nullptr;
  } catch (const std::exception&) {
    return nullptr;
  }
}
