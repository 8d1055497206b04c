#include "flies/reproduce/paper_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/draw/draw.hpp"
#include "flies/draw/paint.hpp"
#include "flies/draw/top_view.hpp"

namespace flies {
namespace {

using namespace paint;

const cv::Scalar kRing{0, 0, 255};
constexpr double kBirdsEyeHeight_px = 620.0;
constexpr int kGap_px = 24;

cv::Mat gray_of(const LabelledFrame& frame) { return mat_of(frame.images.left.view()); }

/// Around an upright thing that faces the camera; empty behind it.
cv::Rect upright_box(const Projection& projection, const GroundPoint& foot, double bottom_z_m, double width_m,
                     double height_m) {
  const double azimuth = std::atan2(foot.y_m, foot.x_m), half_m = 0.5 * width_m;
  const auto corner = [&](double side_m, double z_m) {
    return Point3{foot.x_m - side_m * std::sin(azimuth), foot.y_m + side_m * std::cos(azimuth), z_m};
  };
  const Point3 top_left = corner(half_m, bottom_z_m + height_m), bottom_right = corner(-half_m, bottom_z_m);
  if (!(projection.depth_m(top_left) > 0.0) || !(projection.depth_m(bottom_right) > 0.0)) return {};
  const auto a = projection.project(top_left), b = projection.project(bottom_right);
  return {pixel(a.u_px, a.v_px), pixel(b.u_px, b.v_px)};
}

/// The labelled objects that are in view, ringed as in the paper.
template <class Draw>
void for_each_ringed(const LabelledFrame& frame, const Draw& draw) {
  constexpr double kFar_m = 40.0;
  for (const auto& object : frame.truth.objects)
    if (object.visible && near_range_m(object.footprint) <= kFar_m) draw(object);
}

void put_rings_on_image(cv::Mat& canvas, const LabelledFrame& frame) {
  cv::Mat image = canvas(cv::Rect(0, 0, frame.images.left.width_px, frame.images.left.height_px));
  const Projection projection(frame.camera);
  for_each_ringed(frame, [&](const LabelledObject& object) {
    const auto& f = object.footprint;
    const cv::Rect box = upright_box(projection, {f.x_m, f.y_m}, object.bottom_z_m, seen_width_m(f), object.height_m);
    if (box.empty()) return;
    const cv::Size axes(std::max(8, box.width * 7 / 10), std::max(8, box.height * 6 / 10));
    cv::ellipse(image, (box.tl() + box.br()) / 2, axes, 0, 0, 360, kRing, 1, cv::LINE_AA);
  });
}

/// Room for the whole width of the field, or for one direction.
TopView view_of_field(const FieldOptions& field, double half_width_m) {
  TopView view;
  view.max_x_m = 5.0 * std::ceil(field.x_max_m / 5.0);
  view.half_width_m = half_width_m;
  view.pixels_per_m = kBirdsEyeHeight_px / view.max_x_m;
  return view;
}

struct TitledPopulation {
  std::string title;
  const Population* flies;
};

/// Bird's-eye views side by side; `decorate(ground, plot)` adds to each.
template <class Decorate>
cv::Mat draw_birds_eyes(const std::array<TitledPopulation, 2>& columns, const StereoCamera& camera, const TopView& view,
                        const Decorate& decorate) {
  const GroundPlot first = ground_plot(view, {0, 0});
  const int width_px = first.area.br().x + kGap_px;
  cv::Mat canvas(first.area.br().y + kBottomMargin_px, 2 * width_px, CV_8UC3, kWhite);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const GroundPlot plot = ground_plot(view, {static_cast<int>(i) * width_px, 0});
    put_grid(canvas, plot, columns[i].title);
    put_flies(canvas, plot, *columns[i].flies, 1.0);
    put_field_of_view(canvas, plot, camera);
    cv::Mat ground = canvas(plot.area);
    decorate(ground, plot);
  }
  return canvas;
}

cv::Mat draw_figure_2b(const LabelledFrame& frame, const PersonExperiment& experiment, const FieldOptions& field) {
  const TopView view = view_of_field(field, std::max(std::abs(field.y_min_m), std::abs(field.y_max_m)));
  return draw_birds_eyes({{{"Eq. (2), improved", &experiment.covariance}, {"Eq. (1), original", &experiment.louchet}}},
                         frame.camera, view, [&](cv::Mat& ground, const GroundPlot& plot) {
                           for_each_ringed(frame, [&](const LabelledObject& object) {
                             const auto& f = object.footprint;
                             const double radius_m = 0.5 * std::max(f.length_m, f.width_m) + 0.7;
                             cv::circle(ground, plot.at(f.x_m, f.y_m), pixel(radius_m * plot.view.pixels_per_m), kRing,
                                        1, cv::LINE_AA);
                           });
                         });
}

void put_view_edges(cv::Mat& ground, const GroundPlot& plot, const ViewAngle& view) {
  for (const double azimuth : {view.min_azimuth_rad, view.max_azimuth_rad})
    cv::line(ground, plot.at(0.0, 0.0), plot.at(plot.view.max_x_m, std::tan(azimuth) * plot.view.max_x_m), kGreen, 1,
             cv::LINE_AA);
}

/// The flies of a view-angle; a wedge of a degree is a thin line, so they are drawn larger than elsewhere.
void put_large_flies(cv::Mat& ground, const GroundPlot& plot, const Population& flies) {
  float strongest = 0.0F;
  for (const float f : flies.fitness) strongest = std::max(strongest, f);
  for (const std::size_t i : ascending(flies.fitness)) {
    const cv::Point at = plot.at(flies.x_m[i], flies.y_m[i]);
    cv::circle(ground, at, 4, fitness_bgr(strongest > 0.0F ? flies.fitness[i] / strongest : 0.0), cv::FILLED,
               cv::LINE_AA);
    cv::circle(ground, at, 4, kInk, 1, cv::LINE_AA);
  }
}

cv::Mat draw_figure_3b(const LabelledFrame& frame, const PersonExperiment& experiment, const FieldOptions& field) {
  const auto covariance = flies_in_view(experiment.covariance, experiment.covariance_view);
  const auto louchet = flies_in_view(experiment.louchet, experiment.louchet_view);
  const double far_y_m = std::abs(std::tan(experiment.covariance_view.min_azimuth_rad)) * field.x_max_m;
  constexpr double kMinHalfWidth_m = 14.0, kMargin_m = 2.0, kMaxHalfWidth_m = 30.0;
  const TopView view = view_of_field(field, std::clamp(far_y_m + kMargin_m, kMinHalfWidth_m, kMaxHalfWidth_m));
  const std::array<const Population*, 2> seen = {&covariance, &louchet};
  std::size_t column = 0;
  return draw_birds_eyes({{{fmt::format("Eq. (2), {} flies", covariance.size()), &covariance},
                           {fmt::format("Eq. (1), {} flies", louchet.size()), &louchet}}},
                         frame.camera, view, [&](cv::Mat& ground, const GroundPlot& plot) {
                           put_view_edges(ground, plot, experiment.covariance_view);
                           const auto& near = experiment.person.near;
                           cv::circle(ground, plot.at(near.x_m, near.y_m), 11, kPedestrianColor, 2, cv::LINE_AA);
                           put_large_flies(ground, plot, *seen[column++]);
                         });
}

cv::Mat draw_figure_3c(const PersonExperiment& experiment) {
  HistogramPlot plot;
  plot.axis = experiment.axis;
  plot.marked_x_m = experiment.person.near.x_m;
  plot.mark_label = "person";
  std::array<HistogramPlot, 2> plots = {plot, plot};
  plots[0].title = "Eq. (2)";
  plots[0].view_angle = experiment.covariance_view;
  plots[1].title = "Eq. (1)";
  plots[1].view_angle = experiment.louchet_view;
  return draw_histograms(plots);
}

std::vector<PaperFigure> draw_figure_4(const LabelledFrame& frame, const Detection& d) {
  const cv::Mat left = gray_of(frame);
  ConcentrateResult samples = d.concentrate, candidates = d.concentrate;
  samples.candidates.clear();
  candidates.shifted.clear();
  const auto kept = std::count_if(candidates.candidates.begin(), candidates.candidates.end(),
                                  [](const Candidate& candidate) { return candidate.kept; });
  return {
      {"4, top left",
       fmt::format("Sample points of histogram sampling after the last generation, {} in all.", samples.shifted.size()),
       draw_concentrating(left, samples), true},
      {"4, top right",
       fmt::format("Candidates after mean shift and clustering: {} of {} are kept as objects of interest (OOI), the "
                   "others are discarded for their low fitness density.",
                   kept, candidates.candidates.size()),
       draw_concentrating(left, candidates), true},
      {"4, bottom left",
       fmt::format("Regions of interest (ROI) for the classifier: {} boxes of several heights and places around {} "
                   "OOI, one an object is drawn.",
                   d.rois.size(), d.obstacles.size()),
       draw_concentrating(left, {}, d.rois), true},
      {"4, bottom right",
       fmt::format("Verdicts of the classifier, with their range in metres. Pedestrians: {}.", d.pedestrians.size()),
       draw_overlay(left, {}, d.pedestrians), true}};
}

Detection detect(const LabelledFrame& frame, const PersonOptions& options) {
  DetectorOptions method = options.method;
  method.seed = options.first_seed;
  return Detector(frame.camera, method).process(frame.images.view());
}

/// Up to `count` other frames with people, spread over the set.
std::vector<std::size_t> further_frames(const SetResult& result, std::size_t shown_frame, std::size_t count) {
  std::vector<std::size_t> others;
  for (const auto& person : result.people)
    if (person.frame != shown_frame && (others.empty() || others.back() != person.frame))
      others.push_back(person.frame);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < std::min(count, others.size()); ++i)
    chosen.push_back(others[i * others.size() / std::min(count, others.size())]);
  return chosen;
}

std::string number_and_rms(const std::optional<double>& rms_m) {
  return rms_m ? fmt::format("{:.2f} m", *rms_m) : "not defined (no fitness)";
}

}  // namespace

cv::Mat draw_view_angle(const LabelledFrame& frame, const ViewAngle& view, const PersonPlace& person) {
  constexpr double kOutside = 0.55;
  cv::Mat image = as_bgr(gray_of(frame));
  const Projection projection(frame.camera);
  const double depth_px = projection.disparity_at_depth(10.0);  // any depth: the line of sight is what counts
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const Point3 at = projection.triangulate({double(u), double(v), depth_px});
      const double azimuth = std::atan2(at.y_m, at.x_m);
      if (azimuth < view.min_azimuth_rad || azimuth >= view.max_azimuth_rad) image.at<cv::Vec3b>(v, u) *= kOutside;
    }
  }
  const cv::Rect box = upright_box(projection, person.near, 0.0, person.width_m, person.height_m);
  if (!box.empty()) cv::rectangle(image, box, kPedestrianColor, 2);
  return image;
}

std::vector<PaperFigure> paper_figures(const FrameSet& set, const SetResult& result, const PersonOptions& options) {
  const auto& shown = result.people[result.shown];
  const auto& e = shown.experiment;
  const LabelledFrame& frame = set.frames[shown.frame];
  const auto& field = options.method.field;

  cv::Mat image_of_flies = draw_flies(gray_of(frame), e.covariance, frame.camera, "Eq. (2)");
  put_rings_on_image(image_of_flies, frame);
  std::vector<PaperFigure> figures = {
      {"2a",
       fmt::format("{} flies spread at random and not evolved, coloured by their fitness after Eq. (2): blue low, red "
                   "high. Labelled objects are ringed. Frame: {}.",
                   e.covariance.size(), frame.name),
       image_of_flies, true},
      {"2b",
       "The same flies in bird's-eye view (metres), scored by Eq. (2) and by Eq. (1). Labelled objects are ringed.",
       draw_figure_2b(frame, e, field), false},
      {"3a",
       fmt::format("The view-angle of {:.0f} degree that holds {}, {:.2f} m away (x {:.2f} m, y {:.2f} m). The box is "
                   "as wide as the label across the line of sight.",
                   degrees(e.covariance_view.max_azimuth_rad - e.covariance_view.min_azimuth_rad), e.person.name,
                   e.person.range_m(), e.person.near.x_m, e.person.near.y_m),
       draw_view_angle(frame, e.covariance_view, e.person), true},
      {"3b",
       "The flies of that view-angle in bird's-eye view (metres), coloured by fitness; red is the fittest of them. The "
       "ring is the person's near point.",
       draw_figure_3b(frame, e, field), false},
      {"3c",
       fmt::format("Their histograms over x. Fitness-weighted RMS distance to the person with this seed: Eq. (2) {}, "
                   "Eq. (1) {}; the paper has 2.94 m and 6.86 m.",
                   number_and_rms(e.runs.front().rms_covariance_m), number_and_rms(e.runs.front().rms_louchet_m)),
       draw_figure_3c(e), false}};
  for (auto& figure : draw_figure_4(frame, detect(frame, options))) figures.push_back(std::move(figure));

  constexpr std::size_t kFurther = 3;
  for (const std::size_t i : further_frames(result, shown.frame, kFurther)) {
    const LabelledFrame& further = set.frames[i];
    const Detection d = detect(further, options);
    figures.push_back(
        {"5",
         fmt::format("Verdicts of the classifier in {}. Pedestrians: {}; labelled people to be found: {}.",
                     further.name, d.pedestrians.size(), people_in(further.truth, options.match).size()),
         draw_overlay(gray_of(further), {}, d.pedestrians), true});
  }
  return figures;
}

}  // namespace flies
