#include "flies/draw/paint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "flies/draw/draw.hpp"
#include "flies/io/fitness_color.hpp"

namespace flies {
namespace {

constexpr double kFarthestColored_m = 40.0;

/// Turbo from a clear blue to a clear red; its ends are too dark to be told from black.
cv::Scalar turbo(double fraction) {
  static const cv::Mat colors = [] {
    cv::Mat ramp(1, 256, CV_8UC1), mapped;
    for (int i = 0; i < 256; ++i) ramp.at<uchar>(i) = static_cast<uchar>(i);
    cv::applyColorMap(ramp, mapped, cv::COLORMAP_TURBO);
    return mapped;
  }();
  constexpr double kFirst = 25.0, kLast = 235.0;
  const double clamped = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  const auto& color = colors.at<cv::Vec3b>(static_cast<int>(std::lround(kFirst + (kLast - kFirst) * clamped)));
  return {double(color[0]), double(color[1]), double(color[2])};
}

}  // namespace

cv::Scalar range_color(double range_m) { return turbo(1.0 - range_m / kFarthestColored_m); }

}  // namespace flies

namespace flies::paint {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

}  // namespace

int pixel(double position_px) {
  constexpr double kFarOutside_px = 20000.0;
  if (!std::isfinite(position_px)) return static_cast<int>(-kFarOutside_px);
  return static_cast<int>(std::lround(std::clamp(position_px, -kFarOutside_px, kFarOutside_px)));
}

cv::Point pixel(double u_px, double v_px) { return {pixel(u_px), pixel(v_px)}; }

cv::Rect pixel_rect(const ImageBox& box) {
  return {pixel(box.u_px, box.v_px), pixel(box.u_px + box.width_px, box.v_px + box.height_px)};
}

cv::Mat as_bgr(const cv::Mat& image) {
  cv::Mat bgr;
  if (image.empty()) return cv::Mat(0, 0, CV_8UC3);
  if (image.channels() == 1)
    cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  else
    bgr = image.clone();
  return bgr;
}

cv::Mat with_strip(const cv::Mat& image, int strip_height_px, int min_width_px) {
  const cv::Mat bgr = as_bgr(image);
  cv::Mat canvas(bgr.rows + strip_height_px, std::max(bgr.cols, min_width_px), CV_8UC3, kPanel);
  if (!bgr.empty()) bgr.copyTo(canvas(cv::Rect(0, 0, bgr.cols, bgr.rows)));
  return canvas;
}

cv::Size text_size(const std::string& text, double scale) {
  int below_baseline = 0;
  return cv::getTextSize(text, kFont, scale, 1, &below_baseline);
}

void put_text(cv::Mat& canvas, const std::string& text, cv::Point left_baseline, const cv::Scalar& color,
              double scale) {
  cv::putText(canvas, text, left_baseline, kFont, scale, color, 1, cv::LINE_AA);
}

void put_outlined_text(cv::Mat& canvas, const std::string& text, cv::Point left_baseline, const cv::Scalar& color,
                       const cv::Scalar& outline) {
  cv::putText(canvas, text, left_baseline, kFont, kSmallText, outline, 3, cv::LINE_AA);
  put_text(canvas, text, left_baseline, color);
}

void put_centred_text(cv::Mat& canvas, const std::string& text, cv::Point centre_baseline, const cv::Scalar& color,
                      double scale) {
  put_text(canvas, text, {centre_baseline.x - text_size(text, scale).width / 2, centre_baseline.y}, color, scale);
}

void put_upward_text(cv::Mat& canvas, const std::string& text, cv::Point centre, const cv::Scalar& color,
                     double scale) {
  constexpr int kPadding_px = 6;
  const cv::Size size = text_size(text, scale);
  const cv::Rect place(centre.x - size.height / 2 - kPadding_px, centre.y - size.width / 2,
                       size.height + 2 * kPadding_px, size.width);
  if ((place & cv::Rect({}, canvas.size())) != place) return;
  cv::Mat sideways;
  cv::rotate(canvas(place), sideways, cv::ROTATE_90_CLOCKWISE);
  put_text(sideways, text, {0, size.height + kPadding_px}, color, scale);
  cv::rotate(sideways, sideways, cv::ROTATE_90_COUNTERCLOCKWISE);
  sideways.copyTo(canvas(place));
}

void LabelPlacer::put(cv::Mat& canvas, const std::string& text, const cv::Rect& box, const cv::Scalar& color) {
  constexpr int kGap_px = 3;
  const cv::Size size = text_size(text);
  const cv::Rect visible = box & area_;
  if (visible.empty()) return;
  const int left = std::clamp(visible.x, area_.x, std::max(area_.x, area_.br().x - size.width));
  const std::array<int, 4> tops = {visible.y - size.height - kGap_px, visible.y + kGap_px, visible.br().y + kGap_px,
                                   visible.br().y - size.height - kGap_px};
  for (const int top : tops) {
    const cv::Rect place(left, top, size.width + kGap_px, size.height + kGap_px);
    const bool inside = top >= area_.y && place.br().y <= area_.br().y;
    const bool is_free =
        std::none_of(taken_.begin(), taken_.end(), [&](const cv::Rect& other) { return (other & place).area() > 0; });
    if (!inside || !is_free) continue;
    taken_.push_back(place);
    put_outlined_text(canvas, text, {left, top + size.height}, color, outline_);
    return;
  }
}

cv::Scalar fitness_bgr(double relative_fitness) {
  const auto [red, green, blue] = fitness_color(relative_fitness);
  return {double(blue), double(green), double(red)};
}

void put_color_bar(cv::Mat& canvas, const cv::Rect& bar, const std::function<cv::Scalar(double)>& color) {
  for (int i = 0; i < bar.width; ++i)
    cv::line(canvas, {bar.x + i, bar.y}, {bar.x + i, bar.br().y - 1}, color((i + 0.5) / bar.width));
  cv::rectangle(canvas, bar, kGray);
}

std::vector<std::size_t> ascending(const std::vector<float>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

std::string short_number(double value) { return fmt::format("{:.3g}", value); }

}  // namespace flies::paint
