#pragma once

#include <utility>
#include <vector>

#include "flies/rig/board.hpp"

namespace flies {

/// Picks views for a calibration out of what two living cameras show: those in which the board is held still, and
/// elsewhere or otherwise than in all views picked so far.
class ViewPicker {
 public:
  enum class Answer {
    no_board,  ///< not in both images
    moving,    ///< not where it was a moment ago
    known,     ///< as in a view that was picked before
    picked,
  };

  /// @param width_px of the images
  explicit ViewPicker(int width_px) : width_px_(width_px) {}

  /// Looks at the next pair and keeps it in `views` when it is picked.
  /// @param time_s of the pair, later than those before
  Answer look(BoardPair pair, double time_s);

  const std::vector<BoardPair>& views() const { return views_; }
  std::vector<BoardPair> take() { return std::move(views_); }

 private:
  int width_px_;
  BoardPair last_;
  double last_s_ = 0.0;
  std::vector<BoardPair> views_;
};

}  // namespace flies
