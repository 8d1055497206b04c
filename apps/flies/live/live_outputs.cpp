#include "live/live_outputs.hpp"

#include <mutex>
#include <opencv2/core.hpp>
#include <optional>

#include "flies/core/mat_view.hpp"
#include "flies/io/image_codecs.hpp"

TrackedFrame tracked_frame(const LiveFrame& frame) {
  return {.frame = static_cast<int>(frame.pair->number),
          .left = frame.pair->left_name,
          .right = frame.pair->right_name,
          .seed = frame.options->seed,
          .preset = frame.preset,
          .camera = frame.camera,
          .tracking = frame.snapshot->tracking,
          .live = LiveRecord{.latency_ms = frame.snapshot->latency_ms,
                             .skew_ms = 1e3 * frame.pair->skew_s,
                             .dropped = frame.dropped,
                             .skipped = frame.pair->skipped},
          .run = frame.run,
          .diagnosis = frame.diagnosis ? std::optional(*frame.diagnosis) : std::nullopt};
}

const std::string& json_line(const LiveFrame& frame) {
  auto& made = *frame.encodings;
  std::call_once(made.line_once, [&] { made.line = track_json_line(tracked_frame(frame)); });
  return made.line;
}

std::vector<std::uint8_t> picture_jpeg(const flies::GrayImage& picture) {
  constexpr int kQuality = 95;
  return flies::encode_jpeg(flies::mat_of(picture.view()), kQuality);
}

const std::vector<std::uint8_t>& left_jpeg(const LiveFrame& frame) {
  auto& made = *frame.encodings;
  std::call_once(made.jpeg_once, [&] { made.jpeg = picture_jpeg(frame.pair->images.left); });
  return made.jpeg;
}

void JsonSink::take(const LiveFrame& frame) {
  if (!file_) file_.emplace(path_);
  file_->write(json_line(frame));
}

void JsonSink::pass_over(const LiveFrame& frame) {
  if (!file_) file_.emplace(path_);
  file_->write(track_json_line(tracked_frame(frame), frame.snapshot->error));
}

void TableSink::take(const LiveFrame& frame) { out_.write(track_table(tracked_frame(frame))); }
