#pragma once

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <utility>

#include "flies/core/waiting.hpp"
#include "flies/video/frame_stream.hpp"

namespace flies {

/// Shared with the reading thread, which may outlive the stream when the source is stuck.
struct FrameStream::State {
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  static constexpr int kMostThreads = 4;           // of a source that is stuck in the driver: they cannot be ended
  static constexpr double kToldAgainAfter_s = 60;  // what keeps failing is not told every time

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
  int generation = 0;  ///< of the thread that counts; older ones are stuck, or about to end
  int threads = 0;
  Clock::time_point last_sign;  ///< of life
  bool is_open = true;
  double patience_s = 0.0;  ///< without a frame for so long it is stuck
  bool is_lost = false, loss_told = false;
  Clock::time_point lost_told = Clock::time_point::min();
  bool broken_told = false, frozen_told = false, threads_told = false, end_told = false, rate_told = false;

  bool is_over(int mine) const { return is_ending || generation != mine; }

  void say(const std::string& sentence) {
    const std::lock_guard lock(tell_mutex);
    if (!is_deaf) tell(sentence);
  }

  void say_if_possible(const std::string& sentence) noexcept {
    try {
      say(sentence);
    } catch (...) {  // the thread ends, and nobody else is there to be told
    }
  }

  /// @returns false when it is time to end
  bool pause(int mine, double seconds) {
    std::unique_lock lock(mutex);
    return !taken.wait_for(lock, detail::bounded_wait(Seconds(seconds)), [&] { return is_over(mine); });
  }

  void lose(std::unique_lock<std::mutex>& lock, const std::string& what) {
    ++counts.losses;
    is_open = false;
    if (!std::exchange(is_lost, true)) loss_told = false;
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
    patience_s = options.stuck_s;
    if (!std::exchange(is_lost, false) || !loss_told) return;
    lock.unlock();
    say(fmt::format("{}: is back", options.name));
    lock.lock();
  }

  /// @returns false when it is time to end
  bool note_open(int mine) {
    const std::lock_guard lock(mutex);
    if (is_over(mine)) return false;
    is_open = true;
    last_sign = Clock::now();
    return true;
  }

  bool is_stuck() const {
    return options.is_living && is_open && Seconds(Clock::now() - last_sign).count() > patience_s;
  }

  void tell_threads(std::unique_lock<std::mutex>& lock) {
    if (std::exchange(threads_told, true)) return;
    lock.unlock();
    say(fmt::format("{}: hangs in {} attempts to read it; it is opened again when one of them ends", options.name,
                    kMostThreads));
    lock.lock();
  }

  void end(int mine) {
    const std::lock_guard lock(mutex);
    if (generation != mine) return;
    has_ended = true;
    came.notify_all();
  }
};

}  // namespace flies
