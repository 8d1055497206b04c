#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "live/live_frame.hpp"

/// Gives another sink a thread of its own, so that whoever takes long, to encode pictures say, holds up nobody else.
class QueuedSink final : public LiveSink {
 public:
  /// Whether somebody waits for what the other sink makes, or the processor may do first what others wait for.
  enum class Haste { is_awaited, can_wait };
  /// What becomes of more frames than may wait: the oldest are left out, or `take` waits until there is room.
  enum class Overflow { leaves_out, waits };

  /// @param most frames may wait, and `kMostBytes` of pictures but for `kFewest` frames
  /// @param left_out called once, when one is left out for the first time; may be empty
  QueuedSink(LiveSink& sink, std::size_t most, Haste haste, Overflow overflow = Overflow::leaves_out,
             std::function<void()> left_out = {});

  static constexpr std::size_t kMostBytes = 64U << 20;
  static constexpr std::size_t kFewest = 4;

  ~QueuedSink() override;
  QueuedSink(const QueuedSink&) = delete;
  QueuedSink& operator=(const QueuedSink&) = delete;

  /// @throws whatever the other sink threw
  void take(const LiveFrame& frame) override;
  void pass_over(const LiveFrame& frame) override { take(frame); }
  void note(const std::string& sentence) override { sink_.note(sentence); }

  /// Waits until the other sink has taken everything. @throws whatever it threw
  void finish();

 private:
  bool is_full() const;
  LiveFrame pop();
  void work();

  LiveSink& sink_;
  std::size_t most_;
  Haste haste_;
  Overflow overflow_;
  std::function<void()> left_out_;
  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::deque<LiveFrame> waiting_;
  std::size_t waiting_bytes_ = 0;  ///< of their pictures
  bool is_ending_ = false;
  std::exception_ptr failure_;
  std::thread thread_;  ///< last: it uses all of the above
};
