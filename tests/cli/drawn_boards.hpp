#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace flies::testing {

/// A film of both images side by side: a chessboard of 9 x 6 inner corners and squares of 0.05 m, held still at nine
/// places for three pictures each, before a rig of a baseline of 0.12 m whose focal length is 0.55 of the width.
/// @param size of one image
void write_film_of_boards(const std::filesystem::path& film, cv::Size size);

}  // namespace flies::testing
