#include "flies/rig/turned_images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace flies {
namespace {

struct Change {
  bool is_mirrored = false, is_turned = false;
  const char* name = "";
  const char* remedy = "";
};

constexpr Change kChanges[] = {{false, true, "upside down", "turn them by 180 degrees"},
                               {true, false, "mirrored left to right", "mirror them back"},
                               {true, true, "mirrored top to bottom", "mirror them back"}};

/// The board as the changed image would show it.
SeenBoard changed(SeenBoard seen, const Change& change, const Board& board, int width_px, int height_px) {
  const bool is_across = change.is_mirrored != change.is_turned;
  for (auto& corner : seen.corners) {
    if (is_across) corner.u_px = width_px - 1 - corner.u_px;
    if (change.is_turned) corner.v_px = height_px - 1 - corner.v_px;
    if (change.is_mirrored)  // a mirrored board is counted from its other side
      corner.corner += board.columns - 1 - 2 * (corner.corner % board.columns);
  }
  std::ranges::sort(seen.corners, {}, &BoardCorner::corner);
  return seen;
}

bool is_right_beyond_left(const RawStereo& raw) { return raw.translation_m[0] < 0.0; }

}  // namespace

std::string turned_images(const BoardTools& tools, const Board& board, const std::vector<BoardPair>& pairs,
                          const RigSolution& solution) {
  if (board.kind != BoardKind::chessboard) return {};  // markers tell how they lie
  constexpr std::size_t kEnoughViews = 6;
  constexpr double kShare = 0.1, kFits_px = 1.5;
  const int width_px = solution.raw.width_px, height_px = solution.raw.height_px;
  for (const auto& change : kChanges) {
    std::vector<BoardPair> others;
    for (std::size_t i = 0; i < std::min(pairs.size(), kEnoughViews); ++i)
      others.push_back(matched_boards(board, pairs[i].name, pairs[i].left,
                                      changed(pairs[i].right, change, board, width_px, height_px)));
    const auto found = tools.solve(others, board, width_px, height_px, solution.raw.left.lens);
    if (!found.failure.empty() || found.rms_px > std::min(kFits_px, kShare * solution.rms_px)) continue;
    return fmt::format(
        "those of the {} camera are {}: {} (with the others so, corners are {:.2f} px off instead of "
        "{:.0f})",
        is_right_beyond_left(found.raw) ? "right" : "left", change.name, change.remedy, found.rms_px, solution.rms_px);
  }
  return {};
}

}  // namespace flies
