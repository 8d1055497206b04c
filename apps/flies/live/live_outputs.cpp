#include "live/live_outputs.hpp"

#include "shared/standard_output.hpp"

TrackedFrame tracked_frame(const LiveFrame& frame) {
  return {.frame = static_cast<int>(frame.pair->number),
          .left = frame.pair->left_name,
          .right = frame.pair->right_name,
          .seed = frame.seed,
          .preset = frame.preset,
          .camera = frame.camera,
          .tracking = frame.snapshot->tracking,
          .live = LiveRecord{.latency_ms = frame.snapshot->latency_ms,
                             .skew_ms = 1e3 * frame.pair->skew_s,
                             .dropped = frame.snapshot->dropped},
          .run = frame.run};
}

void TableSink::take(const LiveFrame& frame) {
  print(track_table(tracked_frame(frame)));
  flush_standard_output();
}
