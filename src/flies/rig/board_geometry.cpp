// What the module that finds boards needs of them, too.
#include "flies/rig/board.hpp"

namespace flies {
namespace {

constexpr int kCornersPerTag = 4;

}  // namespace

std::array<double, 2> corner_on_board_m(const Board& board, int corner) {
  if (board.kind != BoardKind::aprilgrid) {
    const int across = board.kind == BoardKind::charuco ? board.columns - 1 : board.columns;
    return {(corner % across) * board.square_m, (corner / across) * board.square_m};
  }
  // Kalibr counts tags from the lower left; corners go from a tag's upper left clockwise, and y goes down.
  const int tag = corner / kCornersPerTag, k = corner % kCornersPerTag;
  const double step_m = board.square_m + board.marker_m;
  const double x_m = (tag % board.columns) * step_m, y_m = -(tag / board.columns) * step_m;
  return {x_m + (k == 1 || k == 2 ? board.square_m : 0.0), y_m + (k >= 2 ? 0.0 : -board.square_m)};
}

int corner_count(const Board& board) {
  switch (board.kind) {
    case BoardKind::charuco:
      return (board.columns - 1) * (board.rows - 1);
    case BoardKind::aprilgrid:
      return kCornersPerTag * board.columns * board.rows;
    case BoardKind::chessboard:
      break;
  }
  return board.columns * board.rows;
}

const std::vector<std::string>& marker_dictionaries() {
  static const std::vector<std::string> names = {
      "4x4_50",   "4x4_100",  "4x4_250",        "4x4_1000",      "5x5_50",        "5x5_100",        "5x5_250",
      "5x5_1000", "6x6_50",   "6x6_100",        "6x6_250",       "6x6_1000",      "7x7_50",         "7x7_100",
      "7x7_250",  "7x7_1000", "ARUCO_ORIGINAL", "APRILTAG_16h5", "APRILTAG_25h9", "APRILTAG_36h10", "APRILTAG_36h11"};
  return names;
}

}  // namespace flies
