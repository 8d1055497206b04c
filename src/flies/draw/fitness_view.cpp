#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "flies/draw/draw.hpp"
#include "flies/draw/paint.hpp"
#include "flies/draw/top_view.hpp"
#include "flies/io/fitness_color.hpp"

namespace flies {
namespace {

using namespace paint;

constexpr int kStripHeight_px = 34;
constexpr int kMinWidth_px = 420;
constexpr int kColumnGap_px = 24;
/// Two columns of this width fit on a screen; wider images are drawn smaller in a comparison.
constexpr int kMaxColumnWidth_px = 840;

void put_fitness_bar(cv::Mat& canvas, cv::Point corner, double top_fitness, const cv::Scalar& text_color) {
  put_text(canvas, "fitness", {corner.x, corner.y + 14}, text_color);
  const cv::Rect bar(corner.x + 62, corner.y + 5, 150, 10);
  put_color_bar(canvas, bar, fitness_bgr);
  put_text(canvas, "0", {bar.x - 2, corner.y + 29}, text_color, 0.36);
  const std::string high = short_number(top_fitness) + " and more";
  put_text(canvas, high, {bar.br().x - 20, corner.y + 29}, text_color, 0.36);
}

/// The flies on a dimmed copy of the image of at most `max_width_px`, strongest on top.
cv::Mat image_with_flies(const cv::Mat& left, const Population& flies, const StereoCamera& camera,
                         int max_width_px = std::numeric_limits<int>::max()) {
  cv::Mat image = as_bgr(left);
  if (image.empty()) return image;
  image.convertTo(image, -1, 0.6);
  const double scale = std::min(1.0, max_width_px / double(image.cols));
  if (scale < 1.0) cv::resize(image, image, {}, scale, scale, cv::INTER_AREA);
  const Projection projection(camera);
  const double top = full_scale_fitness(flies.fitness);
  for (const std::size_t i : ascending(flies.fitness)) {
    if (!(projection.depth_m(flies.point(i)) > 0.0)) continue;
    const StereoPoint at = projection.project(flies.point(i));
    cv::circle(image, pixel(scale * at.u_px, scale * at.v_px), 2, fitness_bgr(flies.fitness[i] / top), cv::FILLED,
               cv::LINE_AA);
  }
  return image;
}

cv::Mat draw_column(const cv::Mat& left, const StereoCamera& camera, const TitledFlies& column, const TopView& view) {
  const cv::Mat image = image_with_flies(left, column.flies, camera, kMaxColumnWidth_px);
  const GroundPlot at_origin = ground_plot(view, {});
  const int width_px = std::max({at_origin.area.br().x + 12, image.cols, kMinWidth_px});
  const int image_top = 34;
  const int bar_top = image_top + image.rows + 4;
  const GroundPlot plot = ground_plot(view, {(width_px - at_origin.area.br().x - 12) / 2, bar_top + kStripHeight_px});
  cv::Mat canvas(plot.area.br().y + kBottomMargin_px, width_px, CV_8UC3, kWhite);
  put_text(canvas, column.title, {8, 22}, kInk, 0.65);
  if (!image.empty()) image.copyTo(canvas(cv::Rect(0, image_top, image.cols, image.rows)));
  put_fitness_bar(canvas, {8, bar_top}, full_scale_fitness(column.flies.fitness), kInk);
  put_grid(canvas, plot, "bird's-eye view");
  put_flies(canvas, plot, column.flies, 1.0);
  put_field_of_view(canvas, plot, camera);
  return canvas;
}

}  // namespace

cv::Mat draw_flies(const cv::Mat& left, const Population& flies, const StereoCamera& camera, const std::string& title) {
  cv::Mat canvas = with_strip(image_with_flies(left, flies, camera), kStripHeight_px, kMinWidth_px);
  put_fitness_bar(canvas, {8, left.rows}, full_scale_fitness(flies.fitness), kWhite);
  put_text(canvas, title, {320, left.rows + 15}, kWhite);
  return canvas;
}

cv::Mat draw_fitness_comparison(const cv::Mat& left, const StereoCamera& camera, std::span<const TitledFlies> columns,
                                const TopView& view) {
  std::vector<cv::Mat> pictures;
  for (const auto& column : columns) pictures.push_back(draw_column(left, camera, column, view));
  int width_px = 0, height_px = 0;
  for (const auto& picture : pictures) {
    width_px += picture.cols + (width_px > 0 ? kColumnGap_px : 0);
    height_px = std::max(height_px, picture.rows);
  }
  cv::Mat canvas(std::max(height_px, 1), std::max(width_px, 1), CV_8UC3, kWhite);
  int column_left = 0;
  for (const auto& picture : pictures) {
    picture.copyTo(canvas(cv::Rect(column_left, 0, picture.cols, picture.rows)));
    column_left += picture.cols + kColumnGap_px;
  }
  return canvas;
}

}  // namespace flies
