#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "flies/io/gray_image.hpp"

namespace flies {

enum class SourceKind {
  device,  ///< a V4L2 device: a number or /dev/...
  stream,  ///< a GStreamer pipeline (with a '!') or a URL (with "://")
  file,    ///< a film, or whatever else lies on the disk
};
SourceKind source_kind(const std::string& source);

/// Goes on by itself and may come back after it was gone.
inline bool is_living(SourceKind kind) { return kind != SourceKind::file; }

struct CaptureRequest {
  std::string source = {};
  int width_px = 0, height_px = 0;  ///< asked of a device; 0: what it does by itself
  double rate_hz = 0.0;             ///< asked of a device; 0: what it does by itself
  double patience_s = 10.0;         ///< opening may take so long: some drivers and pipelines wait for ever
};

/// A film, camera or pipeline that is open.
class Capture {
 public:
  virtual ~Capture() = default;
  /// Waits for the next picture, as grey.
  /// @returns false when there is none any more
  virtual bool read(GrayImage& image) = 0;
  virtual double rate_hz() const = 0;                   ///< pictures a second as the source says; 0: it does not say
  virtual std::uint64_t pictures() const { return 0; }  ///< of a film, as it says; 0: it does not say
  /// When the last picture of a film is due, since the film began; 0 for one without a stamp, too.
  virtual std::optional<double> stamp_s() const { return std::nullopt; }
  virtual bool has_colors() const { return false; }  ///< whether the last picture had some, before it became grey
  /// When the driver had the last picture; nothing where it does not say. It may be by another clock: to be checked.
  virtual std::optional<std::chrono::steady_clock::time_point> taken_at() const { return std::nullopt; }
};

/// Opens a source with OpenCV's videoio, which is loaded for it.
/// @throws InputError naming the source when it cannot be opened, or not in time
std::unique_ptr<Capture> open_capture(const CaptureRequest& request);

/// What the module `flies_video` gives for a request: null when the source cannot be opened.
using OpenCaptureFunction = Capture* (*)(const CaptureRequest& request, SourceKind kind);
inline constexpr const char* kOpenCaptureName = "flies_open_capture";

}  // namespace flies
