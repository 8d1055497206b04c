#include "shared/latencies.hpp"

#include <fmt/format.h>

#include <algorithm>

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
  auto sorted = newest_ms_;
  std::ranges::sort(sorted);
  return fmt::format("latency {:.1f} ms, p99 {:.1f} ms", sorted[sorted.size() / 2], sorted[sorted.size() * 99 / 100]);
}
