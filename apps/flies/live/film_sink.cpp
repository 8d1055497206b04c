#include "live/film_sink.hpp"

#include "live/live_outputs.hpp"
#include "track/track_picture.hpp"

void FilmSink::take(const LiveFrame& frame) {
  film_.add(track_picture(view_, frame.pair->images.left.view(), tracked_frame(frame)),
            frame.snapshot->tracking.time_s);
}
