#include "flies/classify/classify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "flies/classify/second_look.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr std::string_view kOptionsSource = "classify options";

/// Whether the two verdicts speak of one person. Side by side people differ across the line of sight; in depth the
/// obstacles of one person scatter, so the radius grows with range, and boxes that cover the same part of the image
/// are one person at any range: nobody is seen through another.
bool same_person(const Roi& a, const Roi& b, const ClassifyOptions& options) {
  if (covered_share(a.person, b.person) > options.max_overlap) return true;
  const double a_range_m = std::hypot(a.x_m, a.y_m), b_range_m = std::hypot(b.x_m, b.y_m);
  const double across_m =
      std::abs(std::atan2(a.y_m, a.x_m) - std::atan2(b.y_m, b.x_m)) * std::min(a_range_m, b_range_m);
  const double deep_m = std::abs(a_range_m - b_range_m);
  return across_m < options.lateral_radius_m && deep_m < options.depth_radius * std::max(a_range_m, b_range_m);
}

std::vector<ImageBox> windows_of(std::span<const Roi> rois) {
  std::vector<ImageBox> windows;
  for (const Roi& roi : rois) windows.push_back(roi.window);
  return windows;
}

double middle_height_m(std::span<const Roi> rois) {
  std::set<double> heights_m;
  for (const Roi& roi : rois) heights_m.insert(roi.height_m);
  return *std::next(heights_m.begin(), static_cast<std::ptrdiff_t>(heights_m.size() / 2));
}

/// The first look: at the middle height of an obstacle, and where that is hopeless at no
/// other. A person a fifth taller or smaller than a box still looks a little like one.
std::vector<double> screen(CheckedLooks& looks, std::span<const Roi> rois, bool looks_twice,
                           const ClassifyOptions& options) {
  std::vector<double> probabilities(rois.size(), 0.0);
  const auto screen_those = [&](const auto& is_looked_at) {
    std::vector<std::size_t> some;
    for (std::size_t i = 0; i < rois.size(); ++i)
      if (is_looked_at(rois[i])) some.push_back(i);
    const auto of_some = looks.screen(some);
    for (std::size_t k = 0; k < some.size(); ++k) probabilities[some[k]] = of_some[k];
    return some;
  };
  if (rois.empty() || !looks_twice) {
    screen_those([](const Roi&) { return true; });
    return probabilities;
  }
  const double middle_m = middle_height_m(rois);
  std::map<std::size_t, double> surest;  // of an obstacle's boxes of the middle height
  for (const std::size_t i : screen_those([&](const Roi& roi) { return roi.height_m == middle_m; })) {
    double& of_obstacle = surest.try_emplace(rois[i].obstacle, 0.0).first->second;
    of_obstacle = std::max(of_obstacle, probabilities[i]);
  }
  screen_those([&](const Roi& roi) {
    const auto found = surest.find(roi.obstacle);  // none where its windows were like those of another obstacle
    return roi.height_m != middle_m && (found == surest.end() || found->second >= options.min_middle_probability);
  });
  return probabilities;
}

/// Where the person is between the boxes that were tried: the mean of those of its obstacle that cover the same part of
/// the image, weighted by their odds.
Roi averaged(const Roi& surest, std::span<const Roi> rois, std::span<const double> probabilities,
             const ClassifyOptions& options) {
  constexpr double kNearlyOne = 1.0 - 1e-12;  // keeps odds finite
  Roi mean{};
  double sum = 0.0;
  for (std::size_t i = 0; i < rois.size(); ++i) {
    const Roi& roi = rois[i];
    if (roi.obstacle != surest.obstacle || covered_share(roi.person, surest.person) <= options.max_overlap) continue;
    const double probability = std::min(probabilities[i], kNearlyOne), odds = probability / (1.0 - probability);
    sum += odds;
    mean.person.u_px += odds * roi.person.u_px;
    mean.person.v_px += odds * roi.person.v_px;
    mean.person.width_px += odds * roi.person.width_px;
    mean.person.height_px += odds * roi.person.height_px;
    mean.x_m += odds * roi.x_m;
    mean.y_m += odds * roi.y_m;
    mean.height_m += odds * roi.height_m;
  }
  if (!(sum > 0.0)) return surest;
  for (double* value : {&mean.person.u_px, &mean.person.v_px, &mean.person.width_px, &mean.person.height_px, &mean.x_m,
                        &mean.y_m, &mean.height_m})
    *value /= sum;
  return mean;
}

}  // namespace

ProposeOptions for_classifier(ProposeOptions options, const PeopleClassifier& classifier) {
  if (options.step == 0.0) options.step = classifier.step();
  return options;
}

double report_threshold(const PeopleClassifier& classifier, const ClassifyOptions& options) {
  check_options(options, kOptionsSource);
  const double offset = classifier.looks_twice() ? options.threshold_offset : options.one_stage_threshold_offset;
  const double odds = classifier.threshold() / (1.0 - classifier.threshold()) * std::exp(offset);
  return std::isinf(odds) ? 1.0 : odds / (1.0 + odds);
}

double first_look_threshold(const PeopleClassifier& classifier, const ClassifyOptions& options) {
  if (!classifier.looks_twice()) return report_threshold(classifier, options);
  check_options(options, kOptionsSource);
  return std::max(classifier.screen_threshold(), options.min_first_probability);
}

std::vector<std::size_t> suppress_in_metres(std::span<const Roi> rois, std::span<const double> probabilities,
                                            double threshold, const ClassifyOptions& options) {
  assert(rois.size() == probabilities.size());
  check_options(options, kOptionsSource);
  std::vector<std::size_t> kept;
  for (const std::size_t i : surest_first(probabilities, threshold))
    if (std::none_of(kept.begin(), kept.end(),
                     [&](std::size_t surer) { return same_person(rois[surer], rois[i], options); }))
      kept.push_back(i);
  return kept;
}

ClassifyResult find_people(const GrayView& left, std::span<const Roi> rois, const PeopleClassifier& classifier,
                           const ClassifyOptions& options) {
  check_options(options, kOptionsSource);
  ClassifyResult result;
  const auto windows = windows_of(rois);
  CheckedLooks looks(classifier, left, windows);
  result.screened = screen(looks, rois, classifier.looks_twice(), options);
  const double threshold = report_threshold(classifier, options);
  const double first_threshold = first_look_threshold(classifier, options);
  const auto places = suppress_in_metres(rois, result.screened, first_threshold, options);
  const Verdicts verdicts = classifier.looks_twice()
                                ? look_again(looks, rois, places, result.screened, first_threshold, options)
                                : verdicts_of_one_look(rois, places, result.screened);
  // What was found between the boxes moves places, so that two of them may have become one person.
  std::vector<Roi> moved;
  for (const std::size_t box : verdicts.surest)
    moved.push_back(averaged(verdicts.boxes[box], verdicts.boxes, verdicts.of_boxes, options));
  for (const std::size_t i : suppress_in_metres(moved, verdicts.of_places, threshold, options)) {
    const Roi& roi = moved[i];
    result.pedestrians.push_back(
        {roi.x_m, roi.y_m, std::hypot(roi.x_m, roi.y_m), roi.height_m, verdicts.of_places[i], roi.person});
  }
  std::stable_sort(result.pedestrians.begin(), result.pedestrians.end(),
                   [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return result;
}

}  // namespace flies
