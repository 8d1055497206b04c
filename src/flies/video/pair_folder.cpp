#include "flies/video/pair_folder.hpp"

#include <cassert>
#include <utility>

namespace flies {

PairFolder::PairFolder(std::vector<PairPaths> pairs, const PairReading& reading, double rate_hz,
                       std::vector<double> times_s)
    : pairs_(std::move(pairs)), reading_(reading), rate_hz_(rate_hz), times_s_(std::move(times_s)) {
  assert(times_s_.empty() || times_s_.size() == pairs_.size());
}

bool PairFolder::read(SourceFrame& frame) {
  if (next_ >= pairs_.size()) return false;
  if (!times_s_.empty()) frame.own_time_s = times_s_[next_] - times_s_.front();
  const PairPaths& paths = pairs_[next_++];
  frame.left_name = paths.left;
  frame.right_name = paths.right;
  frame.images = load_pair(paths, reading_);
  return true;
}

}  // namespace flies
