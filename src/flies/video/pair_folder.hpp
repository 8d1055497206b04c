#pragma once

#include <vector>

#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/video/frame_stream.hpp"

namespace flies {

/// Pairs of image files, one after the other. A file that cannot be read is a broken frame.
class PairFolder final : public FrameReader {
 public:
  /// @param rate_hz pairs a second
  /// @param times_s of the pairs, from anywhere, ascending; none: they come at an even rate
  PairFolder(std::vector<PairPaths> pairs, const PairReading& reading, double rate_hz,
             std::vector<double> times_s = {});
  bool read(SourceFrame& frame) override;
  double rate_hz() const override { return rate_hz_; }

 private:
  std::vector<PairPaths> pairs_;
  PairReading reading_;
  double rate_hz_;
  std::vector<double> times_s_;
  std::size_t next_ = 0;
};

}  // namespace flies
