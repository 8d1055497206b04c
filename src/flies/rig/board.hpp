#pragma once

#include <array>
#include <string>
#include <vector>

namespace flies {

enum class BoardKind {
  chessboard,  ///< black and white squares
  charuco,     ///< a chessboard with an ArUco marker in each white square
  aprilgrid,   ///< a grid of AprilTags 36h11, as Kalibr prints it
};

/// A flat board that is held before the cameras.
struct Board {
  BoardKind kind = BoardKind::chessboard;
  int columns = 9;                    ///< chessboard: inner corners; charuco: squares; aprilgrid: tags
  int rows = 6;                       ///< as `columns`
  double square_m = 0.0;              ///< side of a square, of an aprilgrid: of a tag
  double marker_m = 0.0;              ///< charuco: side of a marker; aprilgrid: gap between tags
  std::string dictionary = "4x4_50";  ///< charuco: of its markers, by OpenCV's name without DICT_
};

/// Where a corner lies on the board, metres. Its number counts along the rows; of an aprilgrid four a tag.
std::array<double, 2> corner_on_board_m(const Board& board, int corner);

int corner_count(const Board& board);

/// The names of dictionaries, the commonest first.
const std::vector<std::string>& marker_dictionaries();

/// @throws InputError when sizes are out of range, a marker does not fit into its square, or the dictionary is unknown
void check_board(const Board& board);

/// A corner as an image shows it.
struct BoardCorner {
  int corner = 0;
  double u_px = 0.0, v_px = 0.0;
};

inline constexpr const char* kMisfit = "found ";  ///< what a misfit begins with
/// What a misfit ends with that may be the board, seen in part.
inline constexpr const char* kPartOfBoard = " (if it has as many, part of it is hidden or outside)";

/// A board as an image shows it.
struct SeenBoard {
  std::vector<BoardCorner> corners;  ///< in the order of their numbers
  double blur_px = 0.0;              ///< over how many pixels black becomes white, median over corners
  std::string misfit = {};           ///< without corners: what the image shows in place of the board, if anything
};

/// A board as both images of a pair show it: the corners that both do.
struct BoardPair {
  std::string name;
  SeenBoard left, right;
};

/// Keeps the corners that both images show, and turns a chessboard that one image was read from its other end.
BoardPair matched_boards(const Board& board, const std::string& name, SeenBoard left, SeenBoard right);

}  // namespace flies
