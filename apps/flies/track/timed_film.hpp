#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "flies/video/film.hpp"

/// A film that takes as long as what it shows: 30 pictures a second, each stays until the next one's time.
class TimedFilm {
 public:
  /// @throws flies::InputError as `flies::Film`
  explicit TimedFilm(const std::string& path) : film_(path, kRate_hz) {}

  /// @param time_s of the picture, after that of the one before
  void add(const cv::Mat& picture, double time_s);

  /// Puts the film in its place; none when there was no picture.
  void finish();

 private:
  static constexpr double kRate_hz = 30.0;
  /// A source that was away longer than this is not waited for in the film.
  static constexpr double kLongestStill_s = 2.0;

  flies::Film film_;
  cv::Mat last_;         ///< the picture before, not yet written
  double time_s_ = 0.0;  ///< of it
  double owed_ = 0.0;    ///< of a picture, what rounding left over
};
