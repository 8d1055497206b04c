#include "flies/draw/row_picture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <string>

#include "flies/draw/paint.hpp"

namespace flies {
namespace {

using paint::kInk;
using paint::kPaper;
using paint::put_text;

constexpr int kTitle_px = 26, kGap_px = 6, kRows = 12;
constexpr double kFair_px = 0.5, kPoor_px = 1.0;
const cv::Scalar kGood(80, 200, 80), kFair(40, 210, 240), kPoor(60, 60, 240), kRow(200, 160, 60);

cv::Mat colored(const GrayView& image) {
  cv::Mat canvas(image.height_px, image.width_px, CV_8UC3);
  for (int v = 0; v < image.height_px; ++v)
    for (int u = 0; u < image.width_px; ++u) {
      const std::uint8_t level = image.row(v)[u];
      canvas.at<cv::Vec3b>(v, u) = {level, level, level};
    }
  return canvas;
}

}  // namespace

cv::Mat draw_rows(const RectifiedPair& pair, std::span<const CornerMatch> corners,
                  const std::optional<RowError>& rows) {
  const int width = pair.left.width_px, height = pair.left.height_px;
  cv::Mat canvas(height + kTitle_px, 2 * width + kGap_px, CV_8UC3, kPaper);
  cv::Mat left = canvas(cv::Rect(0, kTitle_px, width, height));
  cv::Mat right = canvas(cv::Rect(width + kGap_px, kTitle_px, width, height));
  colored(pair.left).copyTo(left);
  colored(pair.right).copyTo(right);
  for (int i = 1; i < kRows; ++i) {
    const int v = kTitle_px + i * height / kRows;
    cv::line(canvas, {0, v}, {canvas.cols, v}, kRow, 1);
  }
  for (const auto& corner : corners) {
    const double apart_px = std::abs(corner.right_v_px - corner.v_px);
    const cv::Scalar color = apart_px < kFair_px ? kGood : apart_px < kPoor_px ? kFair : kPoor;
    cv::circle(left, {static_cast<int>(corner.u_px), static_cast<int>(corner.v_px)}, 3, color, cv::FILLED, cv::LINE_AA);
    cv::circle(right, {static_cast<int>(corner.right_u_px), static_cast<int>(corner.right_v_px)}, 3, color, cv::FILLED,
               cv::LINE_AA);
  }
  std::string title =
      fmt::format("{} corners; rows apart by less than 0.5 px green, 1 px yellow, more red", corners.size());
  if (rows) title += fmt::format("; right lower by {:+.2f} px in the middle", rows->offset_px);
  put_text(canvas, title, {6, kTitle_px - 8}, kInk);
  return canvas;
}

}  // namespace flies
