#include "flies/rig/view_picker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace flies {
namespace {

constexpr double kNever_px = std::numeric_limits<double>::infinity();
/// A hand that holds a board trembles by about a pixel from picture to picture; cameras that are some milliseconds
/// apart see a board that moves faster than that in two places.
constexpr double kStill_px = 1.5;
/// Longer ago nothing can be said about stillness.
constexpr double kMoment_s = 1.0;
/// Mean shift of the corners, as a share of the width, that makes a view new.
constexpr double kNewShare = 0.05;
constexpr std::size_t kLeastCorners = 8;

/// Mean distance of the corners that both show; without any in common they are far apart.
double distance_px(const SeenBoard& a, const SeenBoard& b) {
  double sum_px = 0.0;
  int count = 0;
  for (auto x = a.corners.begin(), y = b.corners.begin(); x != a.corners.end() && y != b.corners.end();) {
    if (x->corner == y->corner) {
      sum_px += std::hypot(x->u_px - y->u_px, x->v_px - y->v_px);
      ++count, ++x, ++y;
    } else {
      ++(x->corner < y->corner ? x : y);
    }
  }
  return count == 0 ? kNever_px : sum_px / count;
}

}  // namespace

ViewPicker::Answer ViewPicker::look(BoardPair pair, double time_s) {
  if (pair.left.corners.size() < kLeastCorners) {
    last_ = {};
    return Answer::no_board;
  }
  const bool is_still = time_s - last_s_ <= kMoment_s && distance_px(pair.left, last_.left) <= kStill_px &&
                        distance_px(pair.right, last_.right) <= kStill_px;
  last_ = pair;
  last_s_ = time_s;
  if (!is_still) return Answer::moving;
  const bool is_known = std::any_of(views_.begin(), views_.end(), [&](const BoardPair& view) {
    return distance_px(view.left, pair.left) < kNewShare * width_px_;
  });
  if (is_known) return Answer::known;
  views_.push_back(std::move(pair));
  return Answer::picked;
}

}  // namespace flies
