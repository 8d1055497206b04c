#include "shared/progress_bar.hpp"

#include <unistd.h>

#include <cstdio>
#include <string>

ProgressBar::ProgressBar(std::size_t total, const char* what)
    : total_(total), what_(what), is_visible_(total > 1 && isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (is_visible_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::size_t done) const {
  constexpr std::size_t kWidth = 30;
  if (!is_visible_) return;
  const std::size_t filled = kWidth * done / total_;
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r[%s] %zu of %zu %s", bar.c_str(), done, total_, what_);
}
