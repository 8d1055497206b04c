#include <fmt/format.h>

#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "flies/draw/draw.hpp"
#include "flies/draw/paint.hpp"
#include "flies/draw/scan_paint.hpp"

namespace flies {
namespace {

using namespace paint;

constexpr int kStripHeight_px = 34;
/// Room for the legends.
constexpr int kOverlayMinWidth_px = 470;
constexpr int kScannedMinWidth_px = 710;
constexpr int kConcentratingMinWidth_px = 950;

const cv::Scalar kRoadGray{90, 90, 90};

void put_overlay_legend(cv::Mat& canvas, int top, bool has_scan) {
  constexpr int kBarWidth_px = 160;
  constexpr double kLast_m = 40.0;
  const int baseline = top + 14;
  put_text(canvas, "obstacle range", {8, baseline}, kWhite);
  const cv::Rect bar(122, top + 5, kBarWidth_px, 10);
  put_color_bar(canvas, bar, [](double fraction) { return range_color(fraction * kLast_m); });
  for (int range_m = 0; range_m <= 40; range_m += 10) {
    const int u = bar.x + static_cast<int>(range_m / kLast_m * kBarWidth_px);
    cv::line(canvas, {u, bar.br().y}, {u, bar.br().y + 3}, kGray);
    put_centred_text(canvas, range_m == 40 ? "40 m" : fmt::format("{}", range_m), {u, top + 30}, kWhite, 0.36);
  }
  cv::rectangle(canvas, cv::Rect(320, top + 4, 9, 18), kPedestrianColor, 2);
  put_text(canvas, "pedestrian, range", {338, baseline + 3}, kWhite);
  if (!has_scan) return;
  // The samples lie on grey, as most roads are.
  const auto sample = [&](int left, const char* name, const auto& put) {
    const cv::Rect place(left, top + 5, 22, 16);
    canvas(place).setTo(kRoadGray);
    put(canvas, place);
    put_text(canvas, name, {left + 30, baseline + 3}, kWhite);
  };
  sample(478, "seen free", put_free_sample);
  sample(592, "unknown", put_unknown_sample);
}

/// All the boxes of an object would hide it; the one for a person of common height stands for them.
std::vector<Roi> one_per_obstacle(const std::vector<Roi>& rois) {
  constexpr double kCommonHeight_m = 1.7;
  const auto unlikeness = [](const Roi& roi) { return std::abs(roi.height_m - kCommonHeight_m); };
  std::map<std::size_t, Roi> chosen;
  for (const auto& roi : rois) {
    const auto [best, is_new] = chosen.emplace(roi.obstacle, roi);
    if (!is_new && unlikeness(roi) < unlikeness(best->second)) best->second = roi;
  }
  std::vector<Roi> result;
  for (const auto& [obstacle, roi] : chosen) result.push_back(roi);
  return result;
}

/// The range, with its standard deviation where that is a twentieth and more.
std::string range_label(double range_m, double range_sd_m) {
  constexpr double kWorthSaying = 0.05;
  if (range_sd_m < kWorthSaying * range_m) return fmt::format("{:.1f} m", range_m);
  return fmt::format("{:.1f}+-{:.1f} m", range_m, range_sd_m);
}

cv::Rect image_area(const cv::Mat& left) { return {0, 0, left.cols, left.rows}; }

}  // namespace

cv::Mat draw_overlay(const cv::Mat& left, const std::vector<Obstacle>& obstacles,
                     const std::vector<Pedestrian>& pedestrians, const RoadScan& scanned) {
  const bool has_scan = !scanned.scan.empty();
  cv::Mat canvas = with_strip(left, kStripHeight_px, has_scan ? kScannedMinWidth_px : kOverlayMinWidth_px);
  cv::Mat image = canvas(image_area(left));
  if (!image.empty()) {
    put_scan_on_road(image, scanned.scan, scanned.camera, scanned.road);
    for (auto obstacle = obstacles.rbegin(); obstacle != obstacles.rend(); ++obstacle)
      cv::rectangle(image, pixel_rect(obstacle->box), range_color(obstacle->range_m), 1);
    for (const auto& pedestrian : pedestrians) cv::rectangle(image, pixel_rect(pedestrian.box), kPedestrianColor, 2);

    // The labels that matter most choose their place first.
    LabelPlacer labels(image_area(left));
    for (const auto& pedestrian : pedestrians)
      labels.put(image, range_label(pedestrian.range_m, pedestrian.range_sd_m), pixel_rect(pedestrian.box),
                 {255, 170, 255});
    for (const auto& obstacle : obstacles)
      labels.put(image, range_label(obstacle.range_m, obstacle.range_sd_m), pixel_rect(obstacle.box),
                 range_color(obstacle.range_m));
  }
  put_overlay_legend(canvas, left.rows, has_scan);
  return canvas;
}

cv::Mat draw_concentrating(const cv::Mat& left, const ConcentrateResult& result, const std::vector<Roi>& rois) {
  cv::Mat canvas = with_strip(left, kStripHeight_px, kConcentratingMinWidth_px);
  cv::Mat image = canvas(image_area(left));
  const cv::Scalar box_color{200, 200, 200}, sample_color{0, 230, 255};
  const auto put_sample = [&](cv::Mat& onto, cv::Point at) {
    cv::circle(onto, at, 3, kBlack, cv::FILLED, cv::LINE_AA);
    cv::circle(onto, at, 2, sample_color, cv::FILLED, cv::LINE_AA);
  };
  const auto put_kept = [&](cv::Mat& onto, cv::Point at) {
    cv::circle(onto, at, 7, kBlack, cv::FILLED, cv::LINE_AA);
    cv::circle(onto, at, 6, kGreen, cv::FILLED, cv::LINE_AA);
  };
  const auto put_discarded = [&](cv::Mat& onto, cv::Point at) {
    cv::drawMarker(onto, at, kBlack, cv::MARKER_TILTED_CROSS, 10, 3);
    cv::drawMarker(onto, at, kRed, cv::MARKER_TILTED_CROSS, 9, 1);
  };
  if (!image.empty()) {
    for (const auto& roi : one_per_obstacle(rois)) cv::rectangle(image, pixel_rect(roi.window), box_color, 1);
    for (const auto& point : result.shifted) put_sample(image, pixel(point.start.u_px, point.start.v_px));
    for (const bool kept : {false, true})
      for (const auto& candidate : result.candidates)
        if (candidate.kept == kept)
          (kept ? put_kept(image, pixel(candidate.pixel.u_px, candidate.pixel.v_px))
                : put_discarded(image, pixel(candidate.pixel.u_px, candidate.pixel.v_px)));
  }
  const int middle = left.rows + kStripHeight_px / 2;
  put_kept(canvas, {14, middle});
  put_text(canvas, "part of an obstacle", {26, middle + 4}, kWhite);
  put_discarded(canvas, {182, middle});
  put_text(canvas, "discarded", {192, middle + 4}, kWhite);
  put_sample(canvas, {276, middle});
  put_text(canvas, "sample point: fullest range of a view-angle", {286, middle + 4}, kWhite);
  cv::rectangle(canvas, cv::Rect(608, middle - 9, 9, 18), box_color, 1);
  put_text(canvas, "looked at for a person, one box a place", {624, middle + 4}, kWhite);
  return canvas;
}

}  // namespace flies
