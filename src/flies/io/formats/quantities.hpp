#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Quantities of a pair by whichever of their names a file has, whatever its capitals, `_` and the keys that they stand
/// below. A key below no other comes first; several others must say the same.

/// A number, and where it was read.
struct FoundNumber {
  std::string key;
  double value = 0.0;
};

/// Focal lengths and principal point: fx, fy, cx, cy, a camera matrix, or focal_length and principal_point.
struct FoundCamera {
  std::string key;
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cx_right_px = 0.0, cy_px = 0.0;
};

/// Whether the file says of one camera what `camera_in` reads, or the greater part of it.
bool has_camera(const NumberTable& table);

/// @param notes takes what is to be told: a matrix that stands column by column
/// @throws InputError when a part is missing, two places say different things, or a matrix is none
FoundCamera camera_in(const NumberTable& table, CalibrationNotes& notes);

/// Metres: baseline, baseline_mm, ..., or bf, over the focal length; in the unit that the file names beside it.
/// @returns nothing when the file has none
/// @throws InputError when two places say different things
std::optional<FoundNumber> baseline_in(const NumberTable& table, double fx_px);

/// What a file says of the baseline by that name below no other key, in metres; of any format, whose own baseline it
/// may be. Words and unknown units are left out.
std::vector<FoundNumber> named_baselines(const NumberTable& table);

/// Middlebury's `doffs`: the column of the right principal point less that of the left one.
std::optional<FoundNumber> doffs_in(const NumberTable& table);

/// The largest error, in pixels, that a file says its calibration left: rms, avg_reprojection_error, ...
std::optional<FoundNumber> calibration_error_in(const NumberTable& table);

/// Metres per unit of the length at this key, where the file says so in its name (`T_mm`), beside it or below no other
/// key: `units: mm`.
/// @throws InputError when it names an unknown one
std::optional<double> unit_of(const NumberTable& table, const std::string& length);

/// The same; nothing for an unknown one.
std::optional<double> known_unit_of(const NumberTable& table, const std::string& length);

/// @throws InputError unless two lengths of one thing are alike
void check_same_length(const FoundNumber& one, const FoundNumber& other, const std::string& source);

}  // namespace flies::detail
