#include "detect/detect_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/draw/draw.hpp"
#include "flies/evolve/evolve.hpp"

namespace {

struct Equation {
  flies::FitnessFunction function;
  const char* title;
};
constexpr std::array<Equation, 2> kEquations = {{{flies::FitnessFunction::louchet, "Eq. (1), louchet"},
                                                 {flies::FitnessFunction::covariance, "Eq. (2), covariance"}}};

/// A view-angle of one degree holds about one in a hundred flies; fewer would leave most of its intervals empty.
constexpr int kHistogramFlies = 60'000;

/// Random flies of this frame, as they fall, scored by `function`. Their places depend on the seed alone, so that two
/// functions score the same flies.
flies::Population random_flies(const ProcessedFrame& frame, flies::FitnessFunction function, int count) {
  flies::FitnessOptions fitness = frame.options.fitness;
  fitness.function = function;
  flies::EvolveOptions evolve = frame.options.evolve;
  evolve.flies = count;
  evolve.generations = 0;
  evolve.steering_share = 0.0;
  evolve.informative_gray = 0.0;
  evolve.scouts = 0;
  evolve.uniqueness.enforce = false;
  evolve.refine.share = 0.0;
  return flies::evolve(frame.pair, flies::Projection(frame.camera), frame.detection->road.plane, frame.options.field,
                       fitness, evolve, {frame.options.seed, frame.index})
      .flies;
}

/// The field of detection, drawn `height_px` high.
flies::TopView top_view(const ProcessedFrame& frame, double height_px) {
  const auto& field = frame.options.field;
  flies::TopView view;
  view.max_x_m = 5.0 * std::ceil(field.x_max_m / 5.0);
  view.half_width_m = std::min(std::max(std::abs(field.y_min_m), std::abs(field.y_max_m)), view.max_x_m);
  view.pixels_per_m = height_px / view.max_x_m;
  return view;
}

struct Aim {
  double x_m, y_m;
  const char* label;
};

/// What the histogram looks at; nothing when nothing was found.
std::optional<Aim> nearest_found(const flies::Detection& detection) {
  if (!detection.pedestrians.empty())
    return Aim{detection.pedestrians[0].x_m, detection.pedestrians[0].y_m, "pedestrian"};
  if (!detection.obstacles.empty()) return Aim{detection.obstacles[0].x_m, detection.obstacles[0].y_m, "obstacle"};
  return std::nullopt;
}

}  // namespace

cv::Mat ProcessedFrame::left() const { return flies::mat_of(pair.left); }

cv::Mat overlay_picture(const ProcessedFrame& frame) {
  const flies::Detection& detection = *frame.detection;
  return flies::draw_overlay(frame.left(), detection.obstacles, detection.pedestrians,
                             {detection.scan, frame.camera, detection.road.plane});
}

cv::Mat top_view_picture(const ProcessedFrame& frame) {
  const flies::Detection& detection = *frame.detection;
  // The scan says what the flies saw; both at once are hard to read. --flies and --ply have the flies.
  const flies::Population shown = detection.scan.empty() ? detection.evolved.flies : flies::Population{};
  return flies::draw_top_view(frame.camera, shown, detection.obstacles, detection.pedestrians, top_view(frame, 800),
                              detection.scan);
}

cv::Mat concentrating_picture(const ProcessedFrame& frame) {
  return flies::draw_concentrating(frame.left(), frame.detection->concentrate, frame.detection->rois);
}

cv::Mat fitness_picture(const ProcessedFrame& frame) {
  std::vector<flies::TitledFlies> columns;
  for (const auto& [function, title] : kEquations)
    columns.push_back({title, random_flies(frame, function, frame.options.evolve.flies)});
  return flies::draw_fitness_comparison(frame.left(), frame.camera, columns, top_view(frame, 640));
}

cv::Mat histogram_picture(const ProcessedFrame& frame) {
  const auto aim = nearest_found(*frame.detection);
  const double azimuth_rad = aim ? std::atan2(aim->y_m, aim->x_m) : 0.0;
  std::vector<flies::HistogramPlot> plots;
  for (const auto& [function, title] : kEquations) {
    const auto sampling = flies::sample_histograms(random_flies(frame, function, kHistogramFlies), frame.options.field,
                                                   frame.options.concentrate);
    flies::HistogramPlot plot;
    plot.title = fmt::format("{}, {} flies", title, kHistogramFlies);
    plot.axis = sampling.axis;
    for (const auto& angle : sampling.view_angles)
      if (azimuth_rad >= angle.min_azimuth_rad && azimuth_rad < angle.max_azimuth_rad) plot.view_angle = angle;
    if (aim) {
      plot.marked_x_m = aim->x_m;
      plot.mark_label = aim->label;
    }
    plots.push_back(plot);
  }
  return flies::draw_histograms(plots);
}
