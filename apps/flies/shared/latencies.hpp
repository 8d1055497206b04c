#pragma once

#include <string>
#include <vector>

/// The latencies of the newest thousand pairs.
class Latencies {
 public:
  void add(double latency_ms);

  /// Their median and the one that 99 of 100 keep below, for status lines. Not before the first pair.
  std::string text() const;

 private:
  std::vector<double> newest_ms_;
  std::size_t next_ = 0;  ///< to be overwritten
};
