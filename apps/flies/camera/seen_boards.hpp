#pragma once

#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/rig/board_tools.hpp"
#include "flies/rig/calibrate_rig.hpp"

inline constexpr const char* kNoBoard = "no board in both images";

/// What images show of a board, and the size that all of them have.
struct SeenBoards {
  std::vector<flies::BoardPair> pairs;
  std::vector<flies::DroppedView> without = {};  ///< pairs that were left out
  int width_px = 0, height_px = 0;
};

/// Whether a pair was left out because it shows another board.
inline bool is_misfit(const std::string& reason) { return reason.starts_with(flies::kMisfit); }

/// Boards with the size of their images.
struct SizedBoards {
  flies::BoardPair boards;
  int width_px = 0, height_px = 0;

  std::pair<int, int> size() const { return {width_px, height_px}; }
};

/// Takes those of the size that most have, of sizes that are as frequent the one that comes first; leaves out the
/// others.
/// @param found at least one
void take_commonest_size(std::vector<SizedBoards> found, SeenBoards& seen);

/// The first of those that were left out for the reason that most were, but for its numbers.
/// @param views at least one
const flies::DroppedView& commonest_reason(const std::vector<flies::DroppedView>& views);

/// A fault of too few views with why others were left out before; any other as it is.
flies::InputError with_reason(const flies::InputError& fault, const std::vector<flies::DroppedView>& without);
