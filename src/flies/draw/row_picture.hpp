#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "flies/core/gray_view.hpp"
#include "flies/diagnose/row_error.hpp"

namespace flies {

/// Both images of a pair side by side with rows drawn through (in a rectified pair they pass through the same things),
/// and a dot for every corner in both: green where its rows agree, yellow from half a pixel, red from a whole one.
/// CV_8UC3 in BGR order, a new image.
/// @param rows the line that corners agree with, written in the title; may be empty
cv::Mat draw_rows(const RectifiedPair& pair, std::span<const CornerMatch> corners, const std::optional<RowError>& rows);

}  // namespace flies
