#include "flies/draw/top_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "flies/draw/paint.hpp"
#include "flies/draw/scan_paint.hpp"
#include "flies/io/fitness_color.hpp"

namespace flies {
namespace paint {
namespace {

constexpr double kBehind_m = 2.5;  ///< shown behind the origin, for the vehicle
constexpr double kGridStep_m = 5.0;

TopView checked(const TopView& view) {
  return {std::clamp(view.max_x_m, 5.0, 200.0), std::clamp(view.half_width_m, 2.0, 100.0),
          std::clamp(view.pixels_per_m, 2.0, 100.0)};
}

}  // namespace

cv::Point GroundPlot::at(double x_m, double y_m) const {
  return pixel((view.half_width_m - y_m) * view.pixels_per_m, (view.max_x_m - x_m) * view.pixels_per_m);
}

GroundPlot ground_plot(const TopView& view, cv::Point corner) {
  const TopView v = checked(view);
  return {v,
          {corner.x + kLeftMargin_px, corner.y + kTopMargin_px, pixel(2.0 * v.half_width_m * v.pixels_per_m),
           pixel((v.max_x_m + kBehind_m) * v.pixels_per_m)}};
}

void put_grid(cv::Mat& canvas, const GroundPlot& plot, const std::string& title) {
  cv::Mat ground = canvas(plot.area);
  ground.setTo(kPaper);
  for (double x_m = 0.0; x_m <= plot.view.max_x_m; x_m += kGridStep_m) {
    const int v = plot.at(x_m, 0.0).y;
    cv::line(ground, {0, v}, {ground.cols, v}, kGridLine);
    const std::string number = fmt::format("{:.0f}", x_m);
    put_text(canvas, number, {plot.area.x - 6 - text_size(number).width, plot.area.y + v + 5}, kInk);
  }
  const double last_m = std::floor(plot.view.half_width_m / kGridStep_m) * kGridStep_m;
  for (double y_m = -last_m; y_m <= last_m; y_m += kGridStep_m) {
    const int u = plot.at(0.0, y_m).x;
    cv::line(ground, {u, 0}, {u, ground.rows}, kGridLine);
    put_centred_text(canvas, fmt::format("{:.0f}", y_m), {plot.area.x + u, plot.area.br().y + 16}, kInk);
  }
  cv::rectangle(canvas, plot.area, kGray);
  put_centred_text(canvas, "y to the left, m", {plot.area.x + plot.area.width / 2, plot.area.br().y + 36}, kInk);
  put_upward_text(canvas, "x forward, m", {plot.area.x - 44, plot.area.y + plot.area.height / 2}, kInk);
  put_text(canvas, title, {plot.area.x, plot.area.y - 12}, kInk, kTitleText);

  constexpr double kVehicleWidth_m = 1.8;
  const cv::Rect vehicle(plot.at(0.0, kVehicleWidth_m / 2.0), plot.at(-kBehind_m, -kVehicleWidth_m / 2.0));
  cv::rectangle(ground, vehicle, {190, 190, 190}, cv::FILLED);
  cv::rectangle(ground, vehicle, kInk);
  cv::circle(ground, plot.at(0.0, 0.0), 3, kInk, cv::FILLED, cv::LINE_AA);
}

void put_field_of_view(cv::Mat& canvas, const GroundPlot& plot, const StereoCamera& camera) {
  if (camera.width_px <= 0 || !(camera.fx_px > 0.0)) return;
  cv::Mat ground = canvas(plot.area);
  for (const double u_px : {0.0, double(camera.width_px)}) {
    const double slope = (camera.cx_px - u_px) / camera.fx_px;  // y per metre forward
    cv::line(ground, plot.at(0.0, 0.0), plot.at(plot.view.max_x_m, slope * plot.view.max_x_m), {170, 140, 90}, 1,
             cv::LINE_AA);
  }
}

void put_flies(cv::Mat& canvas, const GroundPlot& plot, const Population& flies, double strength) {
  cv::Mat ground = canvas(plot.area);
  const double top = full_scale_fitness(flies.fitness);
  for (const std::size_t i : ascending(flies.fitness)) {
    const cv::Scalar color = fitness_bgr(flies.fitness[i] / top) * strength + kPaper * (1.0 - strength);
    cv::circle(ground, plot.at(flies.x_m[i], flies.y_m[i]), 1, color, cv::FILLED);
  }
}

namespace {

/// Width of an obstacle's bar along the line of sight, where its depth is not known.
constexpr double kBarDepth_m = 0.35;
/// Thinner bars would vanish between two grid lines.
constexpr double kMinBarWidth_m = 0.3;

/// A line from one standard deviation of the range before an obstacle to one behind it.
void put_deviation(cv::Mat& ground, const GroundPlot& plot, const Obstacle& obstacle) {
  if (!(obstacle.range_sd_m > 0.0) || !std::isfinite(obstacle.range_sd_m)) return;
  const auto at = [&](double deviations) {
    const double factor = 1.0 + deviations * obstacle.range_sd_m / obstacle.range_m;
    return plot.at(obstacle.x_m * factor, obstacle.y_m * factor);
  };
  cv::line(ground, at(-1.0), at(1.0), kInk, 1, cv::LINE_AA);
}

void put_obstacle(cv::Mat& ground, const GroundPlot& plot, const Obstacle& obstacle) {
  const double range = std::hypot(obstacle.x_m, obstacle.y_m);
  if (!std::isfinite(range) || range <= 0.0) return;
  const double ahead_x = obstacle.x_m / range, ahead_y = obstacle.y_m / range;
  const double half_m = std::max(obstacle.width_m, kMinBarWidth_m) / 2.0;
  const auto left_m = [&](double across) { return obstacle.middle_offset_m + across * half_m; };
  std::vector<cv::Point> corners;
  for (const auto& [across, along] : {std::pair{-1.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {-1.0, 1.0}})
    corners.push_back(plot.at(obstacle.x_m - left_m(across) * ahead_y + along * kBarDepth_m * ahead_x,
                              obstacle.y_m + left_m(across) * ahead_x + along * kBarDepth_m * ahead_y));
  cv::fillConvexPoly(ground, corners, range_color(obstacle.range_m), cv::LINE_AA);
  put_deviation(ground, plot, obstacle);
  cv::polylines(ground, corners, true, kInk, 1, cv::LINE_AA);
}

constexpr int kLegendWidth_px = 215;

void put_top_view_legend(cv::Mat& canvas, const GroundPlot& plot, bool has_flies, bool has_scan) {
  const int left = plot.area.br().x + 18;
  int top = plot.area.y + 4;
  const auto heading = [&](const std::string& text) {
    put_text(canvas, text, {left, top + 10}, kInk);
    top += 18;
  };
  const auto bar_with_ends = [&](const std::function<cv::Scalar(double)>& color, const std::string& low,
                                 const std::string& high) {
    const cv::Rect bar(left, top, 150, 10);
    put_color_bar(canvas, bar, color);
    put_text(canvas, low, {left, top + 24}, kInk, 0.38);
    put_text(canvas, high, {bar.br().x - text_size(high, 0.38).width, top + 24}, kInk, 0.38);
    top += 44;
  };
  heading("obstacle, width and range");
  bar_with_ends([](double fraction) { return range_color(40.0 * fraction); }, "0 m", "40 m");
  cv::line(canvas, {left + 6, top - 2}, {left + 6, top + 12}, kInk, 1, cv::LINE_AA);
  put_text(canvas, "range, standard deviation", {left + 22, top + 10}, kInk);
  top += 24;
  cv::circle(canvas, {left + 6, top + 6}, 6, kPedestrianColor, cv::FILLED, cv::LINE_AA);
  cv::circle(canvas, {left + 6, top + 6}, 6, kInk, 1, cv::LINE_AA);
  put_text(canvas, "pedestrian, range", {left + 22, top + 10}, kInk);
  top += 32;
  if (has_scan) {
    const auto entry = [&](const char* name, const auto& put) {
      put(cv::Rect(left, top - 2, 14, 14));
      put_text(canvas, name, {left + 22, top + 10}, kInk);
      top += 24;
    };
    entry("seen free", [&](const cv::Rect& place) { put_free_sample(canvas, place); });
    entry("unknown", [&](const cv::Rect& place) { put_unknown_sample(canvas, place); });
    entry("obstacle in the scan", [&](const cv::Rect& place) {
      cv::line(canvas, {place.x, place.y + 8}, {place.br().x, place.y + 8}, kInk, 3, cv::LINE_AA);
    });
    top += 8;
  }
  if (has_flies) {
    heading("flies, fitness");
    bar_with_ends(fitness_bgr, "low", "high");
  }
  cv::line(canvas, {left, top + 6}, {left + 14, top + 6}, {170, 140, 90}, 1);
  put_text(canvas, "field of view", {left + 22, top + 10}, kInk);
  top += 32;
  const int five_m = pixel(5.0 * plot.view.pixels_per_m);
  cv::line(canvas, {left, top + 6}, {left + five_m, top + 6}, kInk, 2);
  for (const int u : {left, left + five_m}) cv::line(canvas, {u, top + 2}, {u, top + 10}, kInk, 2);
  put_text(canvas, "5 m", {left + five_m + 8, top + 10}, kInk);
}

}  // namespace
}  // namespace paint

cv::Mat draw_top_view(const StereoCamera& camera, const Population& flies, const std::vector<Obstacle>& obstacles,
                      const std::vector<Pedestrian>& pedestrians, const TopView& view, const Scan& scan) {
  using namespace paint;
  const GroundPlot plot = ground_plot(view, {});
  constexpr int kMinLegendRows_px = 344;
  cv::Mat canvas(std::max(plot.area.br().y + kBottomMargin_px, kMinLegendRows_px),
                 plot.area.br().x + std::max(kLegendWidth_px, pixel(5.0 * plot.view.pixels_per_m) + 60), CV_8UC3,
                 kWhite);
  put_grid(canvas, plot, "bird's-eye view");
  put_scan_on_ground(canvas, plot, scan);
  put_flies(canvas, plot, flies, 0.45);
  put_field_of_view(canvas, plot, camera);

  cv::Mat ground = canvas(plot.area);
  for (auto obstacle = obstacles.rbegin(); obstacle != obstacles.rend(); ++obstacle)
    put_obstacle(ground, plot, *obstacle);
  const int radius_px = std::max(5, pixel(0.3 * plot.view.pixels_per_m));
  LabelPlacer labels({{}, ground.size()}, kPaper);
  const auto disc = [&](const Pedestrian& pedestrian) {
    const cv::Point centre = plot.at(pedestrian.x_m, pedestrian.y_m);
    return cv::Rect(centre.x - radius_px, centre.y - radius_px, 2 * radius_px, 2 * radius_px);
  };
  for (const auto& pedestrian : pedestrians) labels.block(disc(pedestrian));
  for (const auto& pedestrian : pedestrians) {
    const cv::Point centre = plot.at(pedestrian.x_m, pedestrian.y_m);
    cv::circle(ground, centre, radius_px, kPedestrianColor, cv::FILLED, cv::LINE_AA);
    cv::circle(ground, centre, radius_px, kInk, 1, cv::LINE_AA);
    labels.put(ground, fmt::format("{:.1f} m", pedestrian.range_m), disc(pedestrian), {150, 0, 150});
  }
  for (const auto& obstacle : obstacles) {
    const cv::Point centre = plot.at(obstacle.x_m, obstacle.y_m);
    labels.put(ground, fmt::format("{:.1f} m", obstacle.range_m), {centre.x - 6, centre.y - 6, 12, 12}, kInk);
  }
  put_top_view_legend(canvas, plot, !flies.empty(), !scan.empty());
  return canvas;
}

}  // namespace flies
