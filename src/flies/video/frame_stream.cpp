#include "flies/video/frame_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "flies/core/error.hpp"

namespace flies {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::size_t kMostWaiting = 3;
constexpr double kUsualRate_hz = 10.0;
constexpr int kMostThreads = 4;           // threads of a source that is stuck in the driver cannot be ended
constexpr double kToldAgainAfter_s = 60;  // what keeps failing is not told every time
constexpr double kFrozen_s = 2.0;

Clock::duration duration(double seconds) { return std::chrono::duration_cast<Clock::duration>(Seconds(seconds)); }

}  // namespace

/// Shared with the reading thread, which may outlive the stream when the source is stuck.
struct FrameStream::State {
  OpenReader open;
  FrameStreamOptions options;
  Clock::time_point began;

  std::mutex tell_mutex;  ///< of the next two
  Tell tell;
  bool is_deaf = false;  ///< whom the sentences went to may be gone

  mutable std::mutex mutex;  ///< of all below
  std::condition_variable came, taken;
  std::deque<SourceFrame> waiting;
  FrameStreamCounts counts;
  bool has_ended = false, is_ending = false;
  int generation = 0;  ///< of the thread that counts; older ones are stuck
  int threads = 0;
  Clock::time_point last_sign;  ///< of life
  bool is_lost = false, loss_told = false;
  Clock::time_point lost_told = Clock::time_point::min();
  bool broken_told = false, frozen_told = false;

  bool is_over(int mine) const { return is_ending || generation != mine; }

  void say(const std::string& sentence) {
    const std::lock_guard lock(tell_mutex);
    if (!is_deaf) tell(sentence);
  }

  /// @returns false when it is time to end
  bool pause(int mine, double seconds) {
    std::unique_lock lock(mutex);
    return !taken.wait_for(lock, duration(seconds), [&] { return is_over(mine); });
  }

  void lose(std::unique_lock<std::mutex>& lock, const std::string& what) {
    ++counts.losses;
    is_lost = true;
    loss_told = false;
    const auto now = Clock::now();
    if (lost_told != Clock::time_point::min() && Seconds(now - lost_told).count() < kToldAgainAfter_s) return;
    lost_told = now;
    loss_told = true;
    lock.unlock();
    say(fmt::format("{}: {}; trying again", options.name, what));
    lock.lock();
  }

  /// A source that is back after it was lost says so where the loss was told.
  void find(std::unique_lock<std::mutex>& lock) {
    if (!std::exchange(is_lost, false) || !loss_told) return;
    lock.unlock();
    say(fmt::format("{}: is back", options.name));
    lock.lock();
  }

  void end() {
    const std::lock_guard lock(mutex);
    has_ended = true;
    came.notify_all();
  }
};

namespace {

/// What one reading thread does.
template <class State>
class Reading {
 public:
  Reading(std::shared_ptr<State> state, int generation) : state_(std::move(state)), mine_(generation) {}

  void run(std::unique_ptr<FrameReader> reader) {
    const FrameStreamOptions& options = state_->options;
    double pause_s = options.first_pause_s;
    while (true) {
      if (reader) {
        const auto before = frames_;
        read_all(*reader);
        reader.reset();
        if (is_over()) return;
        if (frames_ > before) pause_s = options.first_pause_s;
        if (!options.is_living) {
          if (!options.is_looped || frames_ == before) return state_->end();
          offset_ += index_;
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
      } catch (const InputError& error) {
        if (!options.is_living) {
          state_->say(error.what());
          return state_->end();
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
      frame.time_s = state_->options.is_living ? Seconds(arrived - state_->began).count() : file_time_s(reader);
      if (!is_broken) watch_frozen(frame);
      if (!state_->options.is_living && !keep_time(frame.time_s)) return;
      if (!deliver(std::move(frame), is_broken)) return;
    }
  }

  double file_time_s(const FrameReader& reader) {
    double rate_hz = state_->options.rate_hz > 0.0 ? state_->options.rate_hz : reader.rate_hz();
    if (!(rate_hz > 0.0)) rate_hz = kUsualRate_hz;
    return static_cast<double>(offset_ + index_++) / rate_hz;
  }

  /// Waits until a frame of a file is due.
  bool keep_time(double time_s) {
    if (state_->options.is_patient) return !is_over();
    const auto due = state_->began + duration(time_s) + late_;
    const auto now = Clock::now();
    if (due > now) return state_->pause(mine_, Seconds(due - now).count());
    late_ += now - due;  // a film that could not be read in time, or was paused, goes on from there
    return !is_over();
  }

  bool deliver(SourceFrame frame, bool is_broken) {
    std::unique_lock lock(state_->mutex);
    if (state_->is_over(mine_)) return false;
    ++frames_;
    ++state_->counts.frames;
    state_->last_sign = Clock::now();
    if (is_broken) {
      ++state_->counts.broken;
      return true;
    }
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
    state_->say(why + "; left out, as all such pictures will be");
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
  std::uint64_t frames_ = 0;
  std::uint64_t index_ = 0, offset_ = 0;  ///< of a file's frame, and the frames of the rounds before
  Clock::duration late_{};
  GrayImage last_;
  double changed_s_ = 0.0;
};

/// The thread holds the state: a stuck one outlives the stream.
template <class State>
void start_thread(const std::shared_ptr<State>& state, std::unique_ptr<FrameReader> reader, int generation) {
  std::thread([state, generation, own = std::move(reader)]() mutable {
    try {
      Reading(state, generation).run(std::move(own));
    } catch (const std::exception& error) {
      state->say(fmt::format("{}: {}", state->options.name, error.what()));
      state->end();
    }
    const std::lock_guard lock(state->mutex);
    --state->threads;
    state->taken.notify_all();
  }).detach();
}

}  // namespace

FrameStream::FrameStream(OpenReader open, FrameStreamOptions options, Tell tell, Clock::time_point began)
    : state_(std::make_shared<State>()) {
  auto reader = open();
  state_->open = std::move(open);
  state_->options = std::move(options);
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
  state_->came.wait_for(lock, timeout, [&] { return !state_->waiting.empty() || state_->has_ended; });
  if (!state_->waiting.empty()) {
    frame = std::move(state_->waiting.front());
    state_->waiting.pop_front();
    state_->taken.notify_all();
    return Answer::frame;
  }
  if (state_->has_ended) return Answer::ended;
  const auto& options = state_->options;
  const bool is_stuck =
      options.is_living && !state_->is_lost && Seconds(Clock::now() - state_->last_sign).count() > options.stuck_s;
  if (is_stuck && state_->threads < kMostThreads) {
    state_->last_sign = Clock::now();
    const int generation = ++state_->generation;
    ++state_->threads;
    state_->lose(lock, fmt::format("has given no picture for {:g} s", options.stuck_s));
    start_thread(state_, nullptr, generation);
  }
  return Answer::nothing_yet;
}

FrameStreamCounts FrameStream::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

}  // namespace flies
