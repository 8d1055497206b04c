#include "flies/rig/marker_layout_module.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/core/quantile.hpp"

namespace flies {
namespace {

/// How a board may be laid out in place of what was said.
struct Reading {
  Board board;
  bool is_legacy = false, is_from_top = false;
};

/// Middle of a marker, in squares or tags from the upper left; false when the board has no such marker.
bool find_middle(const Reading& reading, int id, cv::Point2f& middle) {
  const auto& board = reading.board;
  int row = 0, column = 0;
  if (board.kind == BoardKind::aprilgrid) {
    row = id / board.columns;
    column = id % board.columns;
    if (!reading.is_from_top) row = board.rows - 1 - row;
  } else {
    while (row < board.rows && markers_above(board, row + 1, reading.is_legacy) <= id) ++row;
    const bool is_first_white = (row % 2 == 1) != reading.is_legacy;
    column = 2 * (id - markers_above(board, row, reading.is_legacy)) + (is_first_white ? 0 : 1);
  }
  middle = cv::Point2f(static_cast<float>(column), static_cast<float>(row));
  return row >= 0 && row < board.rows;
}

struct Fit {
  double off = std::numeric_limits<double>::infinity();  ///< of the middles, squares or tags
  double side = 0.0;                                     ///< of the markers, in the same unit
  bool is_telling = true;                                ///< two rows of two markers tell where the others are
};

/// Negative when the board would have to be mirrored.
double side_of(const std::vector<cv::Point2f>& corners, const cv::Mat& to_board) {
  std::vector<cv::Point2f> flat;
  cv::perspectiveTransform(corners, flat, to_board);
  const double turn = (flat[1] - flat[0]).cross(flat[2] - flat[1]);
  return std::copysign(std::sqrt(cv::contourArea(flat)), turn);
}

cv::Point2f middle_of(const std::vector<cv::Point2f>& corners) {
  // Where the diagonals meet, which perspective keeps.
  const auto a = corners[2] - corners[0], b = corners[3] - corners[1], c = corners[1] - corners[0];
  const float along = static_cast<float>(c.cross(b) / a.cross(b));
  return corners[0] + along * a;
}

Fit fit_of(const Markers& markers, const Reading& reading) {
  constexpr double kMostBeyond = 0.2;  // what is no marker is read as one now and then
  std::vector<cv::Point2f> seen, expected, found;
  std::map<float, int> in_row;
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    cv::Point2f middle;
    if (!find_middle(reading, markers.ids[i], middle)) {
      ++beyond;
      continue;
    }
    ++in_row[middle.y];
    expected.push_back(middle);
    seen.push_back(middle_of(markers.corners[i]));
  }
  if (static_cast<double>(beyond) > kMostBeyond * static_cast<double>(markers.ids.size())) return {};
  Fit fit;
  fit.is_telling = std::ranges::count_if(in_row, [](const auto& row) { return row.second > 1; }) > 1;
  if (!fit.is_telling) return fit;
  const cv::Mat to_board = cv::findHomography(seen, expected);
  if (to_board.empty()) return {};
  cv::perspectiveTransform(seen, found, to_board);
  std::vector<double> offs, sides;
  for (std::size_t i = 0; i < seen.size(); ++i) offs.push_back(cv::norm(found[i] - expected[i]));
  for (const auto& corners : markers.corners) sides.push_back(side_of(corners, to_board));
  fit.side = upper_median(std::move(sides));
  if (fit.side > 0.0) fit.off = upper_median(std::move(offs));
  return fit;
}

/// What else a board may be: its counts exchanged, one or two more or less across, tags numbered from above. How many
/// rows there are decides nothing: numbers are counted from the first of them.
std::vector<Reading> other_readings(const Board& board) {
  constexpr int kManyRows = 100;
  const bool is_grid = board.kind == BoardKind::aprilgrid;
  std::vector<Reading> others;
  for (const bool is_other_way : {false, true})
    for (const int columns :
         {board.columns, board.rows, board.columns + 1, board.columns - 1, board.columns + 2, board.columns - 2})
      if (columns > 0) {
        Reading other{board, !is_grid && is_other_way, is_grid && is_other_way};
        other.board.columns = columns;
        other.board.rows = kManyRows;
        others.push_back(other);
      }
  return others;
}

std::string size_misfit(const Board& board, double side) {
  constexpr double kMostOff = 0.2;  // corners of small markers are read as much as a tenth too far inside
  const bool is_grid = board.kind == BoardKind::aprilgrid;
  const double expected =
      is_grid ? board.square_m / (board.square_m + board.marker_m) : board.marker_m / board.square_m;
  if (std::abs(side / expected - 1.0) <= kMostOff) return {};
  if (is_grid)
    return fmt::format(
        "{}tags with gaps of {:.2f} of their side between them, expected {:.2f} by --square and --marker", kMisfit,
        1.0 / side - 1.0, board.marker_m / board.square_m);
  return fmt::format(
      "{}markers of {:.2f} of a square's side, expected {:.2f} by --square and --marker (where squares "
      "measure {} m, about {:.3f} m)",
      kMisfit, side, expected, board.square_m, side * board.square_m);
}

std::string layout_misfit(const Markers& markers, const Board& board, double most_off) {
  const char* what = board.kind == BoardKind::aprilgrid ? "tags" : "markers";
  for (const auto& other : other_readings(board)) {
    if (fit_of(markers, other).off > most_off) continue;
    if (other.is_from_top && other.board.columns == board.columns)
      return fmt::format("{}tags that are numbered from the top, expected from the bottom as Kalibr prints them",
                         kMisfit);
    if (other.board.columns == board.columns)
      return fmt::format("{}{} of more rows than the {} of --board {}x{}", kMisfit, what, board.rows, board.columns,
                         board.rows);
    return fmt::format("{}{} that stand as those of a board of {} columns, expected {} by --board{}", kMisfit, what,
                       other.board.columns, board.columns,
                       other.board.columns == board.rows ? " (are its counts exchanged?)" : "");
  }
  return fmt::format("{}{} that do not stand as --board {}x{} has them", kMisfit, what, board.columns, board.rows);
}

}  // namespace

int markers_above(const Board& board, int row, bool is_legacy) {
  // Rows begin with a black and a white square in turn.
  const int white = (board.columns + 1) / 2, black = board.columns / 2;
  const int even = (row + 1) / 2, odd = row / 2;
  return is_legacy ? even * white + odd * black : even * black + odd * white;
}

MarkerLayout layout_of(const Markers& markers, const Board& board) {
  constexpr std::size_t kEnough = 6;  // fewer fit many boards
  // A lens bends rows of squares by a tenth of one, another layout moves markers by a square.
  constexpr double kMostOff = 0.2;
  MarkerLayout layout;
  if (markers.ids.size() < kEnough) return layout;
  Fit fit = fit_of(markers, {board, false, false});
  if (!fit.is_telling) return layout;
  if (board.kind == BoardKind::charuco && fit.off > kMostOff) {
    const Fit legacy = fit_of(markers, {board, true, false});
    layout.is_legacy = legacy.off < kMostOff;
    if (layout.is_legacy) fit = legacy;
  }
  layout.misfit = fit.off > kMostOff ? layout_misfit(markers, board, kMostOff) : size_misfit(board, fit.side);
  return layout;
}

}  // namespace flies
