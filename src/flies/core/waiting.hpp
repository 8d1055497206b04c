#pragma once

#include <chrono>

namespace flies::detail {

/// A wait as long as asked for that no clock overflows by: "for ever" is a year, less than nothing is nothing at all.
/// The standard's `wait_for` adds what it is given to the time of now, and `milliseconds::max()` would be over at once.
template <class Rep, class Period>
std::chrono::steady_clock::duration bounded_wait(std::chrono::duration<Rep, Period> wanted) {
  using Seconds = std::chrono::duration<double>;
  constexpr std::chrono::steady_clock::duration kLongest = std::chrono::hours(24 * 365);
  if (!(Seconds(wanted) > Seconds::zero())) return {};  // also what is no number
  if (Seconds(wanted) >= Seconds(kLongest)) return kLongest;
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(wanted);
}

}  // namespace flies::detail
