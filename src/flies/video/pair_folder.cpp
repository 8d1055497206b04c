#include "flies/video/pair_folder.hpp"

#include <utility>

namespace flies {

PairFolder::PairFolder(std::vector<PairPaths> pairs, const PairReading& reading, double rate_hz)
    : pairs_(std::move(pairs)), reading_(reading), rate_hz_(rate_hz) {}

bool PairFolder::read(SourceFrame& frame) {
  if (next_ >= pairs_.size()) return false;
  const PairPaths& paths = pairs_[next_++];
  frame.left_name = paths.left;
  frame.right_name = paths.right;
  frame.images = load_pair(paths, reading_);
  return true;
}

}  // namespace flies
