#include "live/live_status.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "shared/notes.hpp"

namespace {

constexpr double kShowEvery_s = 0.25;

}  // namespace

LiveStatus::LiveStatus(bool is_line_wanted)
    : is_visible_(is_line_wanted && verbosity() != Verbosity::quiet && isatty(STDERR_FILENO) != 0) {}

void LiveStatus::take(const LiveFrame& frame) {
  const auto now = std::chrono::steady_clock::now();
  if (pairs_++ == 0) start_ = shown_ = now;
  newest_ = now;
  latencies_.add(frame.snapshot->latency_ms);
  count(frame);
  if (!is_visible_ || std::chrono::duration<double>(now - shown_).count() < kShowEvery_s) return;
  shown_ = now;
  std::fprintf(stderr, "\r\033[K%s", text().c_str());
}

void LiveStatus::pass_over(const LiveFrame& frame) {
  ++passed_over_;
  count(frame);
}

/// Numbers that are left out are pairs that were dropped.
void LiveStatus::count(const LiveFrame& frame) {
  const std::uint64_t number = frame.pair->number;
  if (next_number_ && number > *next_number_) dropped_ += number - *next_number_;
  next_number_ = number + 1;
}

std::string LiveStatus::text() const {
  if (pairs_ == 0) return "no pair";
  const std::chrono::duration<double> elapsed = newest_ - start_;
  const double rate = pairs_ > 1 && elapsed.count() > 0.0 ? static_cast<double>(pairs_ - 1) / elapsed.count() : 0.0;
  return fmt::format("{} {}, {:.1f} per second; {}; {} dropped", pairs_, pairs_ == 1 ? "pair" : "pairs", rate,
                     latencies_.text(), dropped_);
}

void LiveStatus::finish(const flies::PairStreamCounts& source) const {
  if (verbosity() == Verbosity::quiet) return;
  std::string line = text();
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) line += fmt::format("; {}: {}", what, count);
  };
  add(passed_over_, "no pairs");
  add(source.broken, "broken pictures");
  add(source.skipped, "pictures that could not be read in time");
  add(source.unpaired, "pictures without a partner");
  add(source.losses, "source lost");
  std::fprintf(stderr, "%sflies: %s\n", is_visible_ ? "\r\033[K" : "", line.c_str());
}
