#pragma once

#include <filesystem>
#include <optional>

#include "flies/io/calibration.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Where the file of the right camera lies beside that of the left one, by its name; it need not be there.
std::optional<std::filesystem::path> right_file_beside(const std::filesystem::path& left);

/// The file of the right camera, where each camera has its own: the one that was asked for, or the one beside the left
/// with "right" for "left" or "cam1" for "cam0" in its name or in the name of its folder.
/// @throws InputError when there is none
NumberTable read_right_file(const NumberTable& left, const CalibrationRequest& request);

}  // namespace flies::detail
