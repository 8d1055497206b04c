#pragma once

#include <array>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "flies/io/formats/pose.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// The rotation about an axis by the length of that vector, radians (Rodrigues).
std::array<double, 9> rotation_about(const std::array<double, 3>& axis_angle);

/// A rotation, 3 x 3, row by row: 9 numbers, or 3 of a rotation vector, or 4 of a quaternion whose order its largest
/// number tells, as that of two cameras that look the same way.
/// @param notes takes what is to be told: another form than 9 numbers
/// @throws InputError when it is missing, of another count, or a quaternion that is not of length 1
std::array<double, 9> rotation_of(const NumberTable& table, const std::string& key, CalibrationNotes& notes);

/// A rigid motion: 4 x 4 or 3 x 4 numbers, row by row or column by column (the translation below, MATLAB's way), which
/// only one of can be.
/// @param notes takes what is to be told, once: that it stands column by column
/// @throws InputError when it is missing, of another count, or neither
Pose pose_of(const NumberTable& table, const std::string& key, CalibrationNotes& notes);

/// @returns what is improbable: cameras turned so much against each other that they see little of the same; empty when
///          nothing is
/// @throws InputError when one camera looks away from what the other sees
std::string check_turn(const std::array<double, 9>& right_from_left, const std::string& source, const std::string& key);

}  // namespace flies::detail
