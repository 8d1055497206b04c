#include "flies/rig/coverage_picture.hpp"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "flies/draw/paint.hpp"
#include "flies/rig/coverage.hpp"

namespace flies {
namespace {

using paint::kInk;
using paint::kPaper;
using paint::put_text;

constexpr int kTitle_px = 26, kGap_px = 6, kHatch_px = 12;
constexpr double kFair_px = 0.5, kPoor_px = 1.0;
const cv::Scalar kGood(60, 160, 60), kFair(20, 170, 220), kPoor(60, 60, 230), kEmpty(190, 190, 230),
    kGrid(200, 200, 200);

cv::Scalar color_of(double error_px) { return error_px < kFair_px ? kGood : error_px < kPoor_px ? kFair : kPoor; }

void hatch(cv::Mat part) {
  for (int x = -part.rows; x < part.cols; x += kHatch_px)
    cv::line(part, {x, part.rows}, {x + part.rows, 0}, kEmpty, 2, cv::LINE_AA);
}

void paint_image(cv::Mat image, const std::vector<BoardPair>& pairs, const RigSolution& solution, bool is_right) {
  const auto coverage = coverage_of(pairs, is_right, image.cols, image.rows);
  for (int row = 0; row < Coverage::kRows; ++row)
    for (int column = 0; column < Coverage::kColumns; ++column) {
      const cv::Rect part(column * image.cols / Coverage::kColumns, row * image.rows / Coverage::kRows,
                          image.cols / Coverage::kColumns, image.rows / Coverage::kRows);
      if (!coverage.covers(column, row)) hatch(image(part));
      cv::rectangle(image, part, kGrid);
    }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& corners = (is_right ? pairs[i].right : pairs[i].left).corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto& error = solution.views[i].corners[k];
      const cv::Point at(cvRound(corners[k].u_px), cvRound(corners[k].v_px));
      cv::circle(image, at, 2, color_of(is_right ? error.right_px : error.left_px), cv::FILLED, cv::LINE_AA);
    }
  }
}

}  // namespace

cv::Mat draw_coverage(const std::vector<BoardPair>& pairs, const RigSolution& solution) {
  const int width = solution.raw.width_px, height = solution.raw.height_px;
  cv::Mat canvas(height + kTitle_px, 2 * width + kGap_px, CV_8UC3, kPaper);
  cv::Mat left = canvas(cv::Rect(0, kTitle_px, width, height));
  cv::Mat right = canvas(cv::Rect(width + kGap_px, kTitle_px, width, height));
  left.setTo(cv::Scalar::all(250));
  right.setTo(cv::Scalar::all(250));
  paint_image(left, pairs, solution, false);
  paint_image(right, pairs, solution, true);
  put_text(canvas,
           fmt::format("{} views, left and right image; corners off by less than 0.5 px green, 1 px yellow, more red; "
                       "hatched: no board was there",
                       pairs.size()),
           {6, kTitle_px - 8}, kInk);
  return canvas;
}

}  // namespace flies
