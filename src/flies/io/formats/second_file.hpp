#pragma once

#include "flies/io/calibration.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// The file of the right camera, where each camera has its own: the one that was asked for, or the one beside the left
/// with "right" for "left" or "cam1" for "cam0" in its name or in the name of its folder.
/// @throws InputError when there is none
NumberTable read_right_file(const NumberTable& left, const CalibrationRequest& request);

}  // namespace flies::detail
