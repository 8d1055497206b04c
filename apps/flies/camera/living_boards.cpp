#include "camera/living_boards.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/rig/view_picker.hpp"
#include "flies/video/pair_stream.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/image_watch.hpp"
#include "shared/notes.hpp"

namespace {

flies::PairStreamRequest stream_request(const LivingBoards& living, const flies::PairReading& reading) {
  flies::PairStreamRequest request;
  request.sources = living.sources;
  request.reading = reading;
  request.layout =
      reading.split == flies::Split::top_bottom ? flies::PairLayout::top_bottom : flies::PairLayout::side_by_side;
  request.is_patient = true;  // of films every picture is looked at
  if (living.size_px.size() == 2) {
    request.width_px = living.size_px[0];
    request.height_px = living.size_px[1];
  }
  return request;
}

}  // namespace

SeenBoards watch_boards(const LivingBoards& living, const flies::PairReading& reading, const flies::BoardTools& tools,
                        const flies::Board& board) {
  using Answer = flies::FrameStream::Answer;
  using namespace std::chrono_literals;
  ask_before_ending_on_signals();
  flies::PairStream stream(stream_request(living, reading), [](const std::string& sentence) { say_notes({sentence}); });
  say_notes(
      {fmt::format("hold the board still in many places, near and far, and tilt it; this ends after {} views, or by "
                   "Ctrl-C when you have enough",
                   living.views)});
  SeenBoards seen;
  flies::ViewPicker picker(0);
  ImageWatch watch;
  flies::StereoFrame frame;
  while (picker.views().size() < living.views && !is_end_requested()) {
    const Answer answer = stream.next(frame, 100ms);
    if (answer == Answer::ended) break;
    if (answer != Answer::frame) continue;
    if (seen.width_px == 0) {
      seen.width_px = frame.images.left.width_px;
      seen.height_px = frame.images.left.height_px;
      picker = flies::ViewPicker(seen.width_px);
    }
    watch.look(frame.images, living.sources.front());
    auto pair =
        flies::matched_boards(board, fmt::format("{:.1f} s", frame.time_s), tools.find(frame.images.left.view(), board),
                              tools.find(frame.images.right.view(), board));
    if (picker.look(std::move(pair), frame.time_s) == flies::ViewPicker::Answer::picked)
      say_notes({fmt::format("view {} taken, at {:.1f} s", picker.views().size(), frame.time_s)});
  }
  if (seen.width_px == 0) throw flies::InputError(living.sources.front(), "", "gave no pictures");
  seen.pairs = picker.take();
  return seen;
}
