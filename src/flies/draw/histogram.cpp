#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flies/draw/draw.hpp"
#include "flies/draw/paint.hpp"

namespace flies {
namespace {

using namespace paint;

constexpr int kPlotWidth_px = 640;
constexpr int kPlotHeight_px = 380;
const cv::Rect kAxes{86, 66, kPlotWidth_px - 86 - 20, kPlotHeight_px - 66 - 52};

/// A step of 1, 2 or 5 times a power of ten that divides the span into at most eight parts.
double tick_step(double span) {
  const double rough = span / 8.0;
  const double magnitude = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * magnitude >= rough) return factor * magnitude;
  return 10.0 * magnitude;
}

struct Scale {
  double min_x_m, max_x_m, max_votes;
  int u(double x_m) const { return pixel(kAxes.x + (x_m - min_x_m) / (max_x_m - min_x_m) * kAxes.width); }
  int v(double votes) const { return pixel(kAxes.br().y - votes / max_votes * kAxes.height); }
};

Scale scale_of(const HistogramPlot& plot) {
  const auto& votes = plot.view_angle.votes;
  const double span_m = plot.axis.bin_m * static_cast<double>(votes.size());
  const double highest = votes.empty() ? 0.0 : *std::max_element(votes.begin(), votes.end());
  return {plot.axis.min_m, plot.axis.min_m + (span_m > 0.0 ? span_m : 1.0),
          std::isfinite(highest) && highest > 0.0 ? 1.08 * highest : 1.0};
}

void put_axes(cv::Mat& canvas, const Scale& scale) {
  const double step_x = tick_step(scale.max_x_m - scale.min_x_m);
  for (double x_m = std::ceil(scale.min_x_m / step_x) * step_x; x_m <= scale.max_x_m + 1e-9; x_m += step_x) {
    cv::line(canvas, {scale.u(x_m), kAxes.y}, {scale.u(x_m), kAxes.br().y + 4}, kGridLine);
    put_centred_text(canvas, short_number(x_m), {scale.u(x_m), kAxes.br().y + 18}, kInk);
  }
  const double step_votes = tick_step(scale.max_votes);
  for (double votes = 0.0; votes <= scale.max_votes; votes += step_votes) {
    cv::line(canvas, {kAxes.x - 4, scale.v(votes)}, {kAxes.br().x, scale.v(votes)}, kGridLine);
    const std::string number = short_number(votes);
    put_text(canvas, number, {kAxes.x - 7 - text_size(number, 0.38).width, scale.v(votes) + 4}, kInk, 0.38);
  }
  put_centred_text(canvas, "x forward, m", {kAxes.x + kAxes.width / 2, kAxes.br().y + 40}, kInk);
  put_upward_text(canvas, "summed fitness", {12, kAxes.y + kAxes.height / 2}, kInk);
}

void put_marker(cv::Mat& canvas, const Scale& scale, double x_m, const cv::Scalar& color) {
  if (x_m < scale.min_x_m || x_m > scale.max_x_m) return;
  // Thin, so as not to hide a bar; the flag at the top makes up for it.
  const cv::Point top(scale.u(x_m), kAxes.y);
  cv::line(canvas, top, {top.x, kAxes.br().y}, color, 1);
  cv::fillConvexPoly(canvas, std::vector<cv::Point>{top, {top.x - 6, top.y - 9}, {top.x + 6, top.y - 9}}, color);
}

int put_key(cv::Mat& canvas, int left, const std::string& text, const cv::Scalar& color) {
  cv::line(canvas, {left, 42}, {left + 16, 42}, color, 2);
  put_text(canvas, text, {left + 22, 46}, kInk);
  return left + 22 + text_size(text).width + 18;
}

}  // namespace

cv::Mat draw_histogram(const HistogramPlot& plot) {
  cv::Mat canvas(kPlotHeight_px, kPlotWidth_px, CV_8UC3, kWhite);
  const ViewAngle& angle = plot.view_angle;
  put_text(canvas,
           fmt::format("{}{}view-angle {:.1f} to {:.1f} deg", plot.title, plot.title.empty() ? "" : ", ",
                       degrees(angle.min_azimuth_rad), degrees(angle.max_azimuth_rad)),
           {14, 24}, kInk, 0.48);
  const Scale scale = scale_of(plot);
  put_axes(canvas, scale);
  const cv::Scalar bar_color{200, 150, 70};
  for (std::size_t k = 0; k < angle.votes.size(); ++k) {
    if (!(angle.votes[k] > 0.0)) continue;
    const double near_m = plot.axis.min_m + static_cast<double>(k) * plot.axis.bin_m;
    const cv::Point top_left(scale.u(near_m), scale.v(angle.votes[k]));
    cv::rectangle(canvas, top_left, {std::max(top_left.x, scale.u(near_m + plot.axis.bin_m) - 1), kAxes.br().y},
                  bar_color, cv::FILLED);
  }
  int key_left = kAxes.x;
  if (plot.marked_x_m) {
    const std::string label = plot.mark_label.empty() ? "object" : plot.mark_label;
    put_marker(canvas, scale, *plot.marked_x_m, kPedestrianColor);
    key_left = put_key(canvas, key_left, fmt::format("{}, x = {:.1f} m", label, *plot.marked_x_m), kPedestrianColor);
  }
  for (const auto& sample : angle.samples) put_marker(canvas, scale, sample.x_m, kGreen);
  if (!angle.samples.empty()) {
    const char* name = angle.samples.size() == 1 ? "sample point" : "sample points, fullest";
    put_key(canvas, key_left, fmt::format("{}, x = {:.1f} m", name, angle.samples[0].x_m), kGreen);
  } else {
    put_text(canvas, "no fly with fitness: no sample point", {key_left, 46}, kInk);
  }
  cv::rectangle(canvas, kAxes, kGray);
  return canvas;
}

cv::Mat draw_histograms(std::span<const HistogramPlot> plots) {
  cv::Mat canvas(kPlotHeight_px, std::max<int>(1, static_cast<int>(plots.size())) * kPlotWidth_px, CV_8UC3, kWhite);
  for (std::size_t i = 0; i < plots.size(); ++i)
    draw_histogram(plots[i]).copyTo(
        canvas(cv::Rect(static_cast<int>(i) * kPlotWidth_px, 0, kPlotWidth_px, kPlotHeight_px)));
  return canvas;
}

}  // namespace flies
