#include "flies/draw/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "flies/draw/paint.hpp"

namespace flies {
namespace {

using namespace paint;

constexpr int kWidth_px = 720, kHeight_px = 480;
constexpr int kKeyRow_px = 18;
const cv::Rect kAxes{76, 40, kWidth_px - 76 - 24, kHeight_px - 40 - 56};
const cv::Scalar kPositiveColor{60, 160, 0}, kNegativeColor{60, 60, 220};

/// Colours that stay apart for colour-blind readers (Okabe and Ito), BGR.
const std::array<cv::Scalar, 6> kCurveColors = {cv::Scalar{178, 114, 0}, cv::Scalar{0, 94, 213},
                                                cv::Scalar{115, 158, 0}, cv::Scalar{167, 121, 204},
                                                cv::Scalar{0, 159, 230}, cv::Scalar{40, 40, 40}};
const cv::Scalar& curve_color(std::size_t i) { return kCurveColors[i % kCurveColors.size()]; }

/// Pixels along one axis.
struct Axis {
  double low = 0.0, high = 1.0;
  int start_px = 0, end_px = 0;
  bool is_logarithmic = false;

  double share(double value) const {
    return is_logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  }
  int at(double value) const {
    const double clamped = std::clamp(value, low, high);
    return pixel(start_px + share(clamped) * (end_px - start_px));
  }
};

Axis across(double low, double high, bool is_logarithmic) { return {low, high, kAxes.x, kAxes.br().x, is_logarithmic}; }
Axis upwards(double low, double high, bool is_logarithmic) {
  return {low, high, kAxes.br().y, kAxes.y, is_logarithmic};
}

std::vector<double> linear_ticks(double low, double high) {
  const double rough = (high - low) / 8.0, magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * magnitude;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * magnitude >= rough) step = factor * magnitude;
  std::vector<double> ticks;
  for (double k = std::ceil(low / step); k * step <= high; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

/// 1, 2 and 5 times the powers of ten; the powers alone where these would be too many.
std::vector<double> logarithmic_ticks(double low, double high) {
  constexpr double kManyDecades = 2.5, kSlack = 1e-9;
  const bool is_long = std::log10(high / low) > kManyDecades;
  std::vector<double> ticks;
  for (double decade = std::pow(10.0, std::floor(std::log10(low) + kSlack)); decade <= high * (1.0 + kSlack);
       decade *= 10.0)
    for (const double factor : {1.0, 2.0, 5.0})
      if ((factor == 1.0 || !is_long) && factor * decade >= low * (1.0 - kSlack) &&
          factor * decade <= high * (1.0 + kSlack))
        ticks.push_back(factor * decade);
  return ticks;
}

std::vector<double> ticks_of(const Axis& axis) {
  return axis.is_logarithmic ? logarithmic_ticks(axis.low, axis.high) : linear_ticks(axis.low, axis.high);
}

void put_frame(cv::Mat& canvas, const Axis& u, const Axis& v, const std::string& u_label, const std::string& v_label) {
  for (const double value : ticks_of(u)) {
    cv::line(canvas, {u.at(value), kAxes.y}, {u.at(value), kAxes.br().y + 4}, kGridLine);
    put_centred_text(canvas, short_number(value), {u.at(value), kAxes.br().y + 18}, kInk);
  }
  for (const double value : ticks_of(v)) {
    cv::line(canvas, {kAxes.x - 4, v.at(value)}, {kAxes.br().x, v.at(value)}, kGridLine);
    const std::string number = short_number(value);
    put_text(canvas, number, {kAxes.x - 8 - text_size(number).width, v.at(value) + 4}, kInk);
  }
  put_centred_text(canvas, u_label, {kAxes.x + kAxes.width / 2, kAxes.br().y + 40}, kInk);
  put_upward_text(canvas, v_label, {14, kAxes.y + kAxes.height / 2}, kInk);
  cv::rectangle(canvas, kAxes, kGray);
}

void put_key(cv::Mat& canvas, cv::Point left, const std::string& text, const cv::Scalar& color) {
  cv::line(canvas, {left.x, left.y - 4}, {left.x + 18, left.y - 4}, color, 2, cv::LINE_AA);
  put_text(canvas, text, {left.x + 24, left.y}, kInk);
}

bool is_point(const ErrorPoint& point) {
  return std::isfinite(point.false_positives) && std::isfinite(point.miss_rate);
}

void put_curve(cv::Mat& canvas, const Axis& u, const Axis& v, const ErrorCurve& curve, const cv::Scalar& color) {
  std::vector<cv::Point> steps;
  for (const auto& point : curve.points) {
    if (!is_point(point) || point.false_positives > u.high) continue;
    const cv::Point next(u.at(point.false_positives), v.at(point.miss_rate));
    if (!steps.empty()) steps.push_back({next.x, steps.back().y});
    steps.push_back(next);
  }
  if (!steps.empty()) steps.push_back({kAxes.br().x, steps.back().y});
  cv::polylines(canvas, steps, false, color, 2, cv::LINE_AA);
  const auto& chosen = curve.operating_point;
  if (chosen && is_point(*chosen))
    cv::circle(canvas, {u.at(chosen->false_positives), v.at(chosen->miss_rate)}, 5, color, cv::FILLED, cv::LINE_AA);
}

/// Shares of the values in equal intervals of [low, high].
std::vector<double> shares(const std::vector<double>& values, double low, double high, std::size_t intervals) {
  std::vector<double> counts(intervals, 0.0);
  double total = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    const double place = (value - low) / (high - low) * static_cast<double>(intervals);
    counts[std::min(static_cast<std::size_t>(std::max(0.0, place)), intervals - 1)] += 1.0;
    total += 1.0;
  }
  if (total > 0.0)
    for (double& count : counts) count /= total;
  return counts;
}

/// From the smallest to the largest score; widened where there is nothing between them.
std::pair<double, double> finite_span(const ScorePlot& plot) {
  std::vector<double> finite;
  for (const auto* values : {&plot.positives, &plot.negatives})
    std::copy_if(values->begin(), values->end(), std::back_inserter(finite),
                 [](double value) { return std::isfinite(value); });
  if (finite.empty()) return {-1.0, 1.0};
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  return *low < *high ? std::pair(*low, *high) : std::pair(*low - 1.0, *high + 1.0);
}

}  // namespace

cv::Mat draw_error_curves(std::span<const ErrorCurve> curves, const ErrorAxes& axes) {
  assert(axes.min_false_positives > 0.0 && axes.min_false_positives < axes.max_false_positives);
  assert(axes.min_miss_rate > 0.0 && axes.min_miss_rate < axes.max_miss_rate);
  cv::Mat canvas(kHeight_px, kWidth_px, CV_8UC3, kWhite);
  const Axis u = across(axes.min_false_positives, axes.max_false_positives, true);
  const Axis v = upwards(axes.min_miss_rate, axes.max_miss_rate, true);
  put_frame(canvas, u, v, axes.false_positives_label, axes.miss_rate_label);
  for (std::size_t i = 0; i < curves.size(); ++i) put_curve(canvas, u, v, curves[i], curve_color(i));
  // Good curves leave the lower left corner last, so the keys stand there.
  const int rows = static_cast<int>(curves.size());
  for (int i = 0; i < rows; ++i)
    put_key(canvas, {kAxes.x + 14, kAxes.br().y - 12 - (rows - 1 - i) * kKeyRow_px},
            curves[static_cast<std::size_t>(i)].title, curve_color(static_cast<std::size_t>(i)));
  return canvas;
}

cv::Mat draw_reliability(std::span<const ReliabilityCurve> curves) {
  cv::Mat canvas(kHeight_px, kWidth_px, CV_8UC3, kWhite);
  const Axis u = across(0.0, 1.0, false), v = upwards(0.0, 1.0, false);
  put_frame(canvas, u, v, "probability", "share of people");
  cv::line(canvas, {u.at(0.0), v.at(0.0)}, {u.at(1.0), v.at(1.0)}, kGray, 1, cv::LINE_AA);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<cv::Point> line;
    for (const auto& [probability, share] : curves[i].points)
      if (std::isfinite(probability) && std::isfinite(share)) line.push_back({u.at(probability), v.at(share)});
    cv::polylines(canvas, line, false, curve_color(i), 2, cv::LINE_AA);
    for (const cv::Point& point : line) cv::circle(canvas, point, 4, curve_color(i), cv::FILLED, cv::LINE_AA);
    const int rows_below = static_cast<int>(curves.size() - 1 - i);
    put_key(canvas, {kAxes.br().x - 250, kAxes.br().y - 12 - rows_below * kKeyRow_px}, curves[i].title, curve_color(i));
  }
  return canvas;
}

cv::Mat draw_score_histograms(const ScorePlot& plot) {
  constexpr std::size_t kIntervals = 80;
  constexpr double kLeastShare = 1e-5;
  const auto span = finite_span(plot);
  const double low = span.first, high = span.second;
  cv::Mat canvas(kHeight_px, kWidth_px, CV_8UC3, kWhite);
  const Axis u = across(low, high, false), v = upwards(kLeastShare, 1.0, true);
  put_frame(canvas, u, v, "score", "share of windows");
  put_text(canvas, plot.title, {14, 24}, kInk, kTitleText);
  const auto put_outline = [&](const std::vector<double>& values, const cv::Scalar& color) {
    const auto heights = shares(values, low, high, kIntervals);
    std::vector<cv::Point> outline;
    for (std::size_t i = 0; i < kIntervals; ++i)
      for (const std::size_t edge : {i, i + 1})
        outline.push_back({u.at(low + (high - low) * static_cast<double>(edge) / kIntervals), v.at(heights[i])});
    cv::polylines(canvas, outline, false, color, 2, cv::LINE_AA);
  };
  put_outline(plot.negatives, kNegativeColor);
  put_outline(plot.positives, kPositiveColor);
  put_key(canvas, {kAxes.br().x - 250, kAxes.y + 18}, fmt::format("{} with a person", plot.positives.size()),
          kPositiveColor);
  put_key(canvas, {kAxes.br().x - 250, kAxes.y + 18 + kKeyRow_px}, fmt::format("{} without", plot.negatives.size()),
          kNegativeColor);
  if (plot.threshold && std::isfinite(*plot.threshold) && *plot.threshold >= low && *plot.threshold <= high) {
    cv::line(canvas, {u.at(*plot.threshold), kAxes.y}, {u.at(*plot.threshold), kAxes.br().y}, kInk, 1);
    put_key(canvas, {kAxes.br().x - 250, kAxes.y + 18 + 2 * kKeyRow_px},
            fmt::format("threshold {:.3g}", *plot.threshold), kInk);
  }
  return canvas;
}

}  // namespace flies
