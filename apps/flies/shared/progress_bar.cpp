#include "shared/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "shared/notes.hpp"

namespace {

constexpr std::chrono::seconds kBetweenLines{30};

std::string duration(double seconds) {
  const auto whole = std::lround(seconds);
  if (whole < 100) return fmt::format("{} s", whole);
  const auto minutes = std::lround(seconds / 60.0);
  return minutes < 100 ? fmt::format("{} min", minutes) : fmt::format("{:.1f} h", seconds / 3600.0);
}

}  // namespace

ProgressBar::ProgressBar(std::size_t total, const char* what)
    : total_(total),
      what_(what),
      is_silent_(total <= 1 || verbosity() == Verbosity::quiet),
      is_terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (!is_silent_ && is_terminal_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done) {
  if (is_silent_ || done == 0) return;
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - began_).count();
  const std::string left =
      duration(passed_s * static_cast<double>(total_ - done) / static_cast<double>(done)) + " left";
  if (is_terminal_) {
    constexpr std::size_t kWidth = 30;
    const std::size_t filled = kWidth * done / total_;
    const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
    fmt::print(stderr, "\r[{}] {} of {} {}, {}\033[K", bar, done, total_, what_, left);
  } else if (now - told_ >= kBetweenLines) {
    told_ = now;
    fmt::print(stderr, "flies: {} of {} {}, {}\n", done, total_, what_, left);
  }
}
