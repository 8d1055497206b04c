#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

/// What the self-contained HTML reports share.
namespace flies {

/// Style sheet of a report: the content of its `<style>` element. Cells of class `met` are green, `missed` red.
extern const std::string_view kHtmlStyle;

/// The text with the characters that mean something in HTML escaped; fit for attributes as well.
std::string html_text(std::string_view text);

/// The picture as a `data:` address for an `<img>`, so that a report is one file.
/// @param is_photo as JPEG; otherwise as PNG, without loss
std::string html_image(const cv::Mat& picture, bool is_photo = false);

}  // namespace flies
