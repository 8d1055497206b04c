#pragma once

#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/io/rectifier.hpp"
#include "flies/rig/board.hpp"

namespace flies {

/// How far a corner lies from where the solution sees it.
struct CornerError {
  double left_px = 0.0, right_px = 0.0;
  double row_px = 0.0;  ///< between the rows of the rectified images
};

struct ViewError {
  std::vector<CornerError> corners;  ///< in the order of the pair's
  double rms_px = 0.0;               ///< over the corners of both images
  double row_px = 0.0;               ///< mean over the corners
  double distance_m = 0.0;           ///< of the board's first corner from the left camera
  double tilt_across_deg = 0.0;      ///< of the board: positive, its right side is nearer
  double tilt_down_deg = 0.0;        ///< positive, its lower side is nearer
};

/// Two cameras that explain what was seen of a board.
struct RigSolution {
  RawStereo raw;
  double rms_px = 0.0;
  double alone_rms_px = 0.0;     ///< where each camera is solved for alone, of the worse
  double row_px = 0.0;           ///< mean over all corners
  double focal_deviation = 0.0;  ///< standard deviation of the focal length over it, of the worse camera
  std::vector<ViewError> views;
  std::string failure;  ///< why there is no solution; empty when there is one
};

/// OpenCV's part, which lives in a module of its own.
class BoardTools {
 public:
  virtual ~BoardTools() = default;
  /// Whether charuco boards and aprilgrids can be found: not where OpenCV's aruco was missing when this was built.
  virtual bool has_markers() const = 0;
  /// The board in an image; no corners when it is not there or not whole (a chessboard must be whole).
  virtual SeenBoard find(const GrayView& image, const Board& board) const = 0;
  /// @param lens `brown` or `equidistant`
  virtual RigSolution solve(const std::vector<BoardPair>& pairs, const Board& board, int width_px, int height_px,
                            Lens lens) const = 0;
};

/// Loads the module. @throws InputError when it is not installed
const BoardTools& board_tools();

}  // namespace flies
