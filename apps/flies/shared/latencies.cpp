#include "shared/latencies.hpp"

#include <fmt/format.h>

#include "flies/core/quantile.hpp"

namespace {

constexpr std::size_t kMost = 1000;

}  // namespace

void Latencies::add(double latency_ms) {
  if (newest_ms_.size() < kMost)
    newest_ms_.push_back(latency_ms);
  else
    newest_ms_[next_] = latency_ms;
  next_ = (next_ + 1) % kMost;
}

std::string Latencies::text() const {
  return fmt::format("latency {:.1f} ms, p99 {:.1f} ms", *flies::median(newest_ms_), flies::quantile(newest_ms_, 0.99));
}
