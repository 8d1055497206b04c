#include "flies/rig/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/name_hint.hpp"
#include "flies/core/options.hpp"

namespace flies {
namespace {

/// A chessboard looks the same upside down, but for its colours: its corners may come in the opposite order.
void turn_as(const SeenBoard& left, SeenBoard& right) {
  if (left.corners.size() != right.corners.size() || left.corners.size() < 2) return;
  const auto along = [](const SeenBoard& board) {
    return std::array{board.corners.back().u_px - board.corners.front().u_px,
                      board.corners.back().v_px - board.corners.front().v_px};
  };
  const auto a = along(left), b = along(right);
  if (a[0] * b[0] + a[1] * b[1] >= 0.0) return;
  const auto count = static_cast<int>(right.corners.size());
  for (auto& corner : right.corners) corner.corner = count - 1 - corner.corner;
  std::reverse(right.corners.begin(), right.corners.end());
}

void keep_common(const SeenBoard& other, SeenBoard& board) {
  std::erase_if(board.corners, [&](const BoardCorner& corner) {
    return std::none_of(other.corners.begin(), other.corners.end(),
                        [&](const BoardCorner& o) { return o.corner == corner.corner; });
  });
}

}  // namespace

void check_board(const Board& board) {
  constexpr int kLeast = 3, kMost = 100;
  const int least = board.kind == BoardKind::aprilgrid ? 1 : kLeast;
  if (board.columns < least || board.rows < least || board.columns > kMost || board.rows > kMost)
    throw InputError("board", "size",
                     fmt::format("found {} x {}, expected {} to {} each way", board.columns, board.rows, least, kMost));
  constexpr double kSmallest_m = 0.001, kLargest_m = 1.0;
  if (!(board.square_m >= kSmallest_m && board.square_m <= kLargest_m))
    throw InputError("board", "square",
                     fmt::format("found {} m, expected {} to {} m: metres, not millimetres", board.square_m,
                                 kSmallest_m, kLargest_m));
  if (board.kind == BoardKind::chessboard) return;
  if (!(board.marker_m > 0.0 && board.marker_m < board.square_m))
    throw InputError("board", "marker",
                     fmt::format("found {} m, expected more than 0 and less than the {} m of {}", board.marker_m,
                                 board.square_m, board.kind == BoardKind::charuco ? "a square" : "a tag"));
  const auto& names = marker_dictionaries();
  if (std::find(names.begin(), names.end(), board.dictionary) == names.end())
    throw InputError("board", "dictionary",
                     fmt::format("found '{}', unknown{}", board.dictionary, did_you_mean(board.dictionary, names)));
}

BoardPair matched_boards(const Board& board, const std::string& name, SeenBoard left, SeenBoard right) {
  if (board.kind == BoardKind::chessboard) turn_as(left, right);
  keep_common(left, right);
  keep_common(right, left);
  return {name, std::move(left), std::move(right)};
}

}  // namespace flies
