#pragma once

#include <chrono>
#include <cstddef>

/// Tells on standard error how much is done and how long the rest will take: a bar on a terminal, elsewhere a line now
/// and then. Silent with `--quiet` and when there are less than two.
class ProgressBar {
 public:
  /// @param what is counted, in the plural; it must outlive the bar
  explicit ProgressBar(std::size_t total, const char* what = "pairs");
  ~ProgressBar();  ///< clears the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::size_t total_;
  const char* what_;
  bool is_silent_, is_terminal_;
  Clock::time_point began_ = Clock::now(), told_ = began_;
};
