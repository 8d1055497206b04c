#include "live/film_sink.hpp"

#include <algorithm>

#include "live/live_outputs.hpp"
#include "track/track_picture.hpp"

void FilmSink::take(const LiveFrame& frame) {
  const double time_s = frame.snapshot->tracking.time_s;
  if (!last_.empty()) {
    owed_ += kRate_hz * std::clamp(time_s - time_s_, 0.0, kLongestStill_s);
    for (; owed_ >= 0.5; owed_ -= 1.0) film_.add(last_);
  }
  last_ = track_picture(view_, frame.pair->images.left.view(), tracked_frame(frame));
  time_s_ = time_s;
}

void FilmSink::finish() {
  if (last_.empty()) return;
  film_.add(last_);
  film_.commit();
}
