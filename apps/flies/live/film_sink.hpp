#pragma once

#include <string>

#include "flies/draw/track_view.hpp"
#include "live/live_frame.hpp"
#include "track/timed_film.hpp"

/// The film of a living source, as `flies track` makes it.
class FilmSink final : public LiveSink {
 public:
  /// @throws flies::InputError as `flies::Film`
  explicit FilmSink(const std::string& path) : film_(path) {}

  void take(const LiveFrame& frame) override;

  /// Puts the film in its place; none when there was no pair.
  void finish() { film_.finish(); }

 private:
  TimedFilm film_;
  flies::TrackView view_;
};
