#pragma once

#include <optional>
#include <span>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {

/// A corner of the left image and where it is found in the right one.
struct CornerMatch {
  double u_px = 0.0, v_px = 0.0;              ///< in the left image
  double right_u_px = 0.0, right_v_px = 0.0;  ///< in the right image
};

/// Follows up to 600 corners of the left image into the right one, rows left free (Lucas-Kanade over a pyramid, there
/// and back). Near things with large disparities are not found; they are not needed here. Levels may differ, as by
/// another exposure: those of the right image are brought to those of the left one.
std::vector<CornerMatch> match_corners(const RectifiedPair& pair);

/// By how much rows of a pair that should be rectified differ: in the middle row, the same point lies `at(u)` rows
/// lower in the right image than in the left one.
struct RowError {
  double offset_px = 0.0;   ///< in the middle of the image
  double slope = 0.0;       ///< growth from column to column: the roll of one camera against the other, radians
  double scatter_px = 0.0;  ///< median absolute difference of the corners from that line, `growth` included
  int corners = 0;          ///< that agree with it
  double middle_u_px = 0.0;
  /// Growth from row to row: by how much the right image is larger than the left one, up and down; 0 where the corners
  /// do not tell it from 0. Moving rows does not make up for it, because columns are as much too far apart.
  double growth = 0.0;
  double middle_v_px = 0.0;

  double at(double u_px) const { return offset_px + slope * (u_px - middle_u_px); }
  /// The root mean square over the columns of the image.
  double typical_px() const;
  /// The largest error of a row between both sides of the image.
  double largest_px() const;
  /// The root mean square over the image of what this error and another one of the same rig differ by.
  double differs_px(const RowError& other) const;
};

/// The line over the columns, or where rows grow apart downwards the plane, that most corners agree with (robust least
/// squares).
/// @returns nothing when fewer than 40 corners agree, or less than half of them
std::optional<RowError> fit_row_error(std::span<const CornerMatch> corners, int width_px, int height_px);

/// The error over a run: medians over pairs. @returns nothing for no pairs
std::optional<RowError> median_row_error(std::span<const RowError> errors);

/// Moves the right image so that its rows are those of the left one; what comes from outside repeats its edge.
void correct_rows(const RowError& error, GrayPair& pair);

}  // namespace flies
