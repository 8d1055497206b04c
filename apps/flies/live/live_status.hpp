#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "flies/video/pair_stream.hpp"
#include "live/live_frame.hpp"
#include "shared/latencies.hpp"

/// Rates and latencies of a living source: on a terminal a line that is written over, and at the end one that stays.
class LiveStatus final : public LiveSink {
 public:
  /// @param is_line_wanted false: only the one at the end
  explicit LiveStatus(bool is_line_wanted);
  void take(const LiveFrame& frame) override;
  void pass_over(const LiveFrame& frame) override;

  /// The last line, with what the source lost.
  void finish(const flies::PairStreamCounts& source) const;

 private:
  void count(const LiveFrame& frame);
  std::string text() const;

  bool is_visible_;
  std::chrono::steady_clock::time_point start_, shown_, newest_;  ///< newest_: of the last pair
  Latencies latencies_;
  std::uint64_t pairs_ = 0, dropped_ = 0, passed_over_ = 0;
  std::optional<std::uint64_t> next_number_;  ///< that would be without a drop
};
