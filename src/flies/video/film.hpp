#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace flies {

/// A film being written by OpenCV's videoio, frame by frame.
class FilmEncoder {
 public:
  virtual ~FilmEncoder() = default;
  /// @param picture CV_8UC3, BGR, of the size that was asked for
  virtual void add(const cv::Mat& picture) = 0;
  /// Writes the film's index; call it once, last. OpenCV does not tell when it cannot write, so the film is read again.
  /// @returns how many pictures are in the film, 0 when it is none
  virtual std::size_t finish() = 0;
};

/// What the module `flies_video` gives: null when the film cannot be written.
/// @param path of the file, whose ending names the kind of film
using OpenFilmFunction = FilmEncoder* (*)(const std::string& path, double rate_hz, cv::Size size);
inline constexpr const char* kOpenFilmName = "flies_open_film";

/// An MP4 film (H.264 where FFmpeg has it, else MPEG-4) that appears under its name when it is complete, until then it
/// is `<name>.part.mp4`; without `commit` nothing is left. Only one run at a time may write it. The module that writes
/// it is loaded for it.
class Film {
 public:
  /// @param path   ends in .mp4
  /// @param rate_hz pictures a second, > 0
  /// @throws InputError naming the file when it has another ending or its folder cannot be written to
  Film(const std::string& path, double rate_hz);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// The first picture decides the film's size; a row or column too many for an even one is cut off.
  /// @param picture CV_8UC3, BGR, at least 2 x 2 px
  /// @throws InputError when the film cannot be written, another run is writing it, or a picture has another size than
  /// the first
  void add(const cv::Mat& picture);

  /// Call it once, last. @throws InputError when the film cannot be put in its place, or pictures are not in it
  void commit();

 private:
  void release();

  std::string path_, part_path_;
  int lock_ = -1;  ///< descriptor that holds the part as ours, from the first picture on
  double rate_hz_;
  cv::Size size_;
  std::size_t pictures_ = 0;
  std::unique_ptr<FilmEncoder> encoder_;
};

}  // namespace flies
