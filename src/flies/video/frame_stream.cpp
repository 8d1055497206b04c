#include "flies/video/frame_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/video/film_clock.hpp"
#include "flies/video/frame_stream_state.hpp"

namespace flies {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kMostWaiting = 3;
constexpr double kUsualRate_hz = 10.0;
constexpr double kFrozen_s = 2.0;
constexpr double kMostPatience = 8.0;  // times `stuck_s`
constexpr std::size_t kUsualSteps = 10;
constexpr double kLeastStep_s = 1e-6;                // times advance
constexpr std::chrono::seconds kLongestTransfer{1};  // from a sensor: an older stamp is by another clock

constexpr double kShareMissed = 0.02;
constexpr double kPicturesMissed = 1.5;

Clock::duration duration(double seconds) { return std::chrono::duration_cast<Clock::duration>(Seconds(seconds)); }

/// What one reading thread does.
template <class State>
class Reading {
 public:
  Reading(std::shared_ptr<State> state, int generation, Clock::time_point began)
      : state_(std::move(state)), mine_(generation), began_(began) {}

  void run(std::unique_ptr<FrameReader> reader) {
    const FrameStreamOptions& options = state_->options;
    double pause_s = options.first_pause_s;
    while (true) {
      if (reader) {
        const auto before = usable_;
        read_all(*reader);
        if (is_over()) return;
        if (!options.is_living && reader->frames() > 0) watch_end(*reader);
        reader.reset();
        if (usable_ > before) pause_s = options.first_pause_s;
        if (!options.is_living) {
          if (!options.is_looped || usable_ == before) return state_->end(mine_);
          rounds_s_ = next_s_;
          index_ = 0;
        } else {
          std::unique_lock lock(state_->mutex);
          state_->lose(lock, "gives no more pictures");
        }
      }
      if (options.is_living && !state_->pause(mine_, pause_s)) return;
      pause_s = std::min(2.0 * pause_s, options.longest_pause_s);
      try {
        reader = state_->open();
        if (!state_->note_open(mine_)) return;
      } catch (const InputError& error) {
        if (!options.is_living) {
          state_->say(error.what());
          return state_->end(mine_);
        }
      }
    }
  }

 private:
  bool is_over() const {
    const std::lock_guard lock(state_->mutex);
    return state_->is_over(mine_);
  }

  void read_all(FrameReader& reader) {
    while (true) {
      SourceFrame frame;
      bool is_broken = false;
      try {
        if (!reader.read(frame)) return;
      } catch (const InputError& error) {
        is_broken = true;
        tell_broken(error.what());
      }
      const auto arrived = Clock::now();
      if (state_->options.is_living)
        stamp_living(frame, arrived);
      else
        stamp_file(frame, reader);
      if (!is_broken) watch_frozen(frame);
      if (!state_->options.is_living && !keep_time(frame.time_s)) return;
      if (!deliver(std::move(frame), is_broken)) return;
    }
  }

  /// The time when the picture was taken, where the source says so and it can be; else when it came.
  void stamp_living(SourceFrame& frame, Clock::time_point arrived) {
    frame.time_s = Seconds(arrived - began_).count();
    if (frame.taken_at && *frame.taken_at <= arrived && arrived - *frame.taken_at < kLongestTransfer) {
      const double taken_s = Seconds(*frame.taken_at - began_).count();
      transfer_s_ = frame.time_s - taken_s;
      frame.time_s = taken_s;
    } else {
      frame.time_s -= transfer_s_;  // a stamp that is missing: about when its neighbours were taken
    }
    if (!arrivals_s_.empty()) frame.time_s = std::max(frame.time_s, arrivals_s_.back() + kLeastStep_s);
    arrivals_s_.push_back(frame.time_s);
    if (arrivals_s_.size() == 1) return;
    if (arrivals_s_.size() > kUsualSteps + 1) arrivals_s_.pop_front();
    frame.step_s = (arrivals_s_.back() - arrivals_s_.front()) / static_cast<double>(arrivals_s_.size() - 1);
  }

  void stamp_file(SourceFrame& frame, const FrameReader& reader) {
    const bool is_rate_given = state_->options.rate_hz > 0.0;
    const double said_hz = is_rate_given ? state_->options.rate_hz : reader.rate_hz();
    const double rate_hz = said_hz > 0.0 ? said_hz : kUsualRate_hz;
    frame.step_s = step_s_ = 1.0 / rate_hz;
    if (index_ == 0) {
      note_length(reader.frames());
      clock_ = FilmClock(rate_hz);
    }
    const double time_s = clock_.next(is_rate_given ? std::nullopt : frame.stamp_s);
    if (index_++ == 1 && !(said_hz > 0.0) && !frame.own_time_s && !clock_.has_stamps()) tell_rate();
    frame.time_s = rounds_s_ + frame.own_time_s.value_or(time_s);
    next_s_ = frame.time_s + frame.step_s;
  }

  void tell_rate() {
    {
      const std::lock_guard lock(state_->mutex);
      if (std::exchange(state_->rate_told, true)) return;
    }
    state_->say(fmt::format("{}: the film has no times: {} pairs per second are assumed (--rate gives another)",
                            state_->options.name, kUsualRate_hz));
  }

  /// Waits until a frame of a file is due.
  bool keep_time(double time_s) {
    if (state_->options.is_patient) return !is_over();
    const auto due = began_ + duration(time_s) + late_;
    const auto now = Clock::now();
    if (due > now) return state_->pause(mine_, Seconds(due - now).count());
    late_ += now - due;  // a film that could not be read in time, or was paused, goes on from there
    return !is_over();
  }

  /// @param said how many pictures a film says it has
  void note_length(std::uint64_t said) {
    const std::lock_guard lock(state_->mutex);
    state_->counts.said_s = static_cast<double>(said) * step_s_;
    state_->counts.step_s = step_s_;
  }

  /// A film that breaks off ends like any other.
  void watch_end(const FrameReader& reader) {
    const double given_s = next_s_ - rounds_s_;
    double said_s = 0.0;
    {
      const std::lock_guard lock(state_->mutex);
      state_->counts.given_s = given_s;
      said_s = state_->counts.said_s;
      if (state_->end_told || !is_shorter(given_s, said_s, step_s_)) return;
    }
    if (!reader.is_incomplete()) return;
    {
      const std::lock_guard lock(state_->mutex);
      state_->end_told = true;
    }
    state_->say(fmt::format("{}: ends after {:.2f} of the {:.2f} s that it says it lasts; is it damaged or cut off?",
                            state_->options.name, given_s, said_s));
  }

  bool deliver(SourceFrame frame, bool is_broken) {
    std::unique_lock lock(state_->mutex);
    if (state_->is_over(mine_)) return false;
    ++state_->counts.frames;
    state_->last_sign = Clock::now();
    if (is_broken) {
      ++state_->counts.broken;
      return true;
    }
    ++usable_;
    state_->find(lock);
    if (!state_->options.is_living) {
      // A film that waits, because it is paused or for the first calibration, is not to come in a burst afterwards.
      const std::size_t most = state_->options.is_patient ? kMostWaiting : 1;
      state_->taken.wait(lock, [&] { return state_->is_over(mine_) || state_->waiting.size() < most; });
    }
    if (state_->is_over(mine_)) return false;
    if (state_->waiting.size() >= kMostWaiting) {
      state_->waiting.pop_front();
      ++state_->counts.skipped;
    }
    state_->waiting.push_back(std::move(frame));
    state_->came.notify_all();
    return true;
  }

  void tell_broken(const std::string& why) {
    {
      const std::lock_guard lock(state_->mutex);
      if (std::exchange(state_->broken_told, true)) return;
    }
    state_->say(why + "; it is left out, and so are all others like it");
  }

  /// Light and sensors are never still: the same picture to the bit for seconds is a camera that hangs.
  void watch_frozen(const SourceFrame& frame) {
    if (!state_->options.is_living) return;
    if (frame.images.left.pixels != last_.pixels) {
      last_ = frame.images.left;
      changed_s_ = frame.time_s;
      return;
    }
    if (frame.time_s - changed_s_ < kFrozen_s) return;
    {
      const std::lock_guard lock(state_->mutex);
      if (std::exchange(state_->frozen_told, true)) return;
    }
    state_->say(fmt::format("{}: has given the same picture for {:g} s; does the camera hang?", state_->options.name,
                            kFrozen_s));
  }

  std::shared_ptr<State> state_;
  int mine_;
  Clock::time_point began_;
  std::uint64_t usable_ = 0;
  std::uint64_t index_ = 0;               ///< of a file's frame in this round
  double step_s_ = 0.0;                   ///< of a file
  FilmClock clock_{kUsualRate_hz};        ///< of a file, in this round
  double rounds_s_ = 0.0, next_s_ = 0.0;  ///< what the rounds before took, and when the next frame is due
  Clock::duration late_{};
  std::deque<double> arrivals_s_;  ///< the last ones
  double transfer_s_ = 0.0;        ///< from the last stamp of the source until its frame came
  GrayImage last_;
  double changed_s_ = 0.0;
};

/// The thread holds the state: a stuck one outlives the stream.
template <class State>
void start_thread(const std::shared_ptr<State>& state, std::unique_ptr<FrameReader> reader, int generation) {
  std::thread([state, generation, began = state->began, own = std::move(reader)]() mutable {
    try {
      Reading(state, generation, began).run(std::move(own));
    } catch (const std::exception& error) {
      state->say_if_possible(state->options.name + ": " + error.what());
      state->end(generation);
    }
    const std::lock_guard lock(state->mutex);
    --state->threads;
    state->taken.notify_all();
  }).detach();
}

}  // namespace

bool is_shorter(double length_s, double said_s, double step_s) {
  return said_s - length_s > std::max(kPicturesMissed * step_s, kShareMissed * said_s);
}

FrameStream::FrameStream(OpenReader open, FrameStreamOptions options, Tell tell, Clock::time_point began)
    : state_(std::make_shared<State>()) {
  auto reader = open();
  state_->open = std::move(open);
  state_->options = std::move(options);
  state_->patience_s = state_->options.stuck_s;
  state_->tell = std::move(tell);
  state_->began = began;
  state_->last_sign = Clock::now();
  state_->threads = 1;
  start_thread(state_, std::move(reader), 0);
}

FrameStream::~FrameStream() {
  std::unique_lock lock(state_->mutex);
  state_->is_ending = true;
  state_->taken.notify_all();
  constexpr auto kPatience = std::chrono::milliseconds(500);
  state_->taken.wait_for(lock, kPatience, [&] { return state_->threads == 0; });
  lock.unlock();
  const std::lock_guard quiet(state_->tell_mutex);
  state_->is_deaf = true;
}

FrameStream::Answer FrameStream::next(SourceFrame& frame, std::chrono::milliseconds timeout) {
  std::unique_lock lock(state_->mutex);
  state_->came.wait_for(lock, detail::bounded_wait(timeout),
                        [&] { return !state_->waiting.empty() || state_->has_ended; });
  if (!state_->waiting.empty()) {
    frame = std::move(state_->waiting.front());
    frame.skipped = state_->counts.skipped;  // the oldest go first: all of them came before
    state_->waiting.pop_front();
    state_->taken.notify_all();
    return Answer::frame;
  }
  if (state_->has_ended) return Answer::ended;
  if (!state_->is_stuck()) return Answer::nothing_yet;
  if (state_->threads >= State::kMostThreads) {
    state_->tell_threads(lock);
    return Answer::nothing_yet;
  }
  const double waited_s = state_->patience_s;
  state_->patience_s = std::min(2.0 * waited_s, kMostPatience * state_->options.stuck_s);
  const int generation = ++state_->generation;
  ++state_->threads;
  state_->lose(lock, fmt::format("has given no picture for {:g} s", waited_s));
  start_thread(state_, nullptr, generation);
  return Answer::nothing_yet;
}

void FrameStream::restart(Clock::time_point began) {
  const std::lock_guard lock(state_->mutex);
  state_->began = began;
  state_->waiting.clear();
  state_->has_ended = false;
  const int generation = ++state_->generation;
  ++state_->threads;
  state_->taken.notify_all();
  start_thread(state_, nullptr, generation);
}

FrameStreamCounts FrameStream::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

}  // namespace flies
