#pragma once

#include <string>

#include "flies/draw/track_view.hpp"
#include "flies/video/film.hpp"
#include "live/live_frame.hpp"

/// A film of a living source that takes as long as the source did: each picture stays until the next one's time.
class FilmSink final : public LiveSink {
 public:
  /// @throws flies::InputError as `flies::Film`
  explicit FilmSink(const std::string& path) : film_(path, kRate_hz) {}

  void take(const LiveFrame& frame) override;

  /// Puts the film in its place; none when there was no pair.
  void finish();

 private:
  static constexpr double kRate_hz = 30.0;
  /// A source that was away longer than this is not waited for in the film.
  static constexpr double kLongestStill_s = 2.0;

  flies::Film film_;
  flies::TrackView view_;
  cv::Mat last_;         ///< the picture before, not yet written
  double time_s_ = 0.0;  ///< of it
  double owed_ = 0.0;    ///< of a picture, what rounding left over
};
