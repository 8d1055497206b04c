#pragma once

#include <cstddef>

/// A bar on standard error that counts pairs; silent when that is no terminal or there are less than two pairs.
class ProgressBar {
 public:
  explicit ProgressBar(std::size_t total);
  ~ProgressBar();  ///< clears the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::size_t done) const;

 private:
  std::size_t total_;
  bool is_visible_;
};
