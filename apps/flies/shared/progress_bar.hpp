#pragma once

#include <cstddef>

/// A bar on standard error that counts what is done; silent when that is no terminal or there are less than two.
class ProgressBar {
 public:
  /// @param what is counted, in the plural; it must outlive the bar
  explicit ProgressBar(std::size_t total, const char* what = "pairs");
  ~ProgressBar();  ///< clears the line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::size_t done) const;

 private:
  std::size_t total_;
  const char* what_;
  bool is_visible_;
};
