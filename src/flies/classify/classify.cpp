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

#include "flies/core/box_overlap.hpp"
#include "flies/core/error.hpp"

namespace flies {
namespace {

constexpr std::string_view kOptionsSource = "classify options";

/// Share of the smaller box that the other one covers.
double overlap(const ImageBox& a, const ImageBox& b) {
  const double both_px2 = intersection_px2(a, b);
  return both_px2 > 0.0 ? both_px2 / std::min(area_px2(a), area_px2(b)) : 0.0;
}

/// Whether the two verdicts speak of one person. Side by side people differ across the line of sight; in depth the
/// obstacles of one person scatter, so the radius grows with range, and boxes that cover the same part of the image
/// are one person at any range: nobody is seen through another.
bool same_person(const Roi& a, const Roi& b, const ClassifyOptions& options) {
  if (overlap(a.person, b.person) > options.max_overlap) return true;
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

/// Looks whose answers are as many and as probable as they must be, whoever wrote the classifier.
class CheckedLooks {
 public:
  CheckedLooks(const PeopleClassifier& classifier, const GrayView& image, std::span<const ImageBox> windows)
      : name_(classifier.name()), looks_(classifier.look_at(image, windows)) {
    if (!looks_) throw InputError(name_, "look_at", "found none, expected looks at the windows");
    const double threshold = classifier.threshold();
    if (!(threshold >= 0.0 && threshold <= 1.0))
      throw InputError(name_, "threshold", fmt::format("found {}, expected 0 to 1", threshold));
  }

  std::vector<double> screen(std::span<const std::size_t> some) { return checked(looks_->screen(some), some.size()); }
  std::vector<double> classify(std::span<const std::size_t> some) {
    return checked(looks_->classify(some), some.size());
  }

 private:
  std::vector<double> checked(std::vector<double> probabilities, std::size_t expected) const {
    if (probabilities.size() != expected)
      throw InputError(name_, "probabilities",
                       fmt::format("found {}, expected {}, one a window", probabilities.size(), expected));
    for (const double p : probabilities)
      if (!(p >= 0.0 && p <= 1.0)) throw InputError(name_, "probability", fmt::format("found {}, expected 0 to 1", p));
    return probabilities;
  }

  std::string name_;
  std::unique_ptr<PeopleLooks> looks_;
};

/// The first look, most of the time of a frame: at the middle height of an obstacle, and where that is hopeless at no
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

/// Those above the threshold.
std::vector<std::size_t> surest_first(std::span<const double> probabilities, double threshold) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < probabilities.size(); ++i)
    if (probabilities[i] > threshold) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return probabilities[a] > probabilities[b]; });
  return order;
}

std::vector<double> values_at(std::span<const double> values, std::span<const std::size_t> indices) {
  std::vector<double> result;
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

/// The surest boxes of one obstacle that show the same part of the image as the surest one of all, itself first.
std::vector<std::size_t> boxes_around(std::size_t surest, std::span<const std::size_t> by_probability,
                                      std::span<const Roi> rois, const ClassifyOptions& options) {
  std::vector<std::size_t> boxes{surest};
  for (const std::size_t i : by_probability) {
    if (boxes.size() >= static_cast<std::size_t>(options.second_looks)) break;
    if (i != surest && rois[i].obstacle == rois[surest].obstacle &&
        overlap(rois[i].person, rois[surest].person) > options.max_overlap)
      boxes.push_back(i);
  }
  return boxes;
}

/// What the surest of the boxes at one place say together: the mean of their log-odds.
/// @param missing what each vote says for which there is no box, because the first look let fewer through
double agreed(std::vector<double> probabilities, double missing, const ClassifyOptions& options) {
  constexpr double kNearlyZero = 1e-12;  // keeps log-odds finite
  std::sort(probabilities.begin(), probabilities.end(), std::greater<>());
  probabilities.resize(static_cast<std::size_t>(std::min(options.votes, options.second_looks)), missing);
  double sum = 0.0;
  for (const double probability : probabilities)
    sum += std::log(std::max(probability, kNearlyZero) / std::max(1.0 - probability, kNearlyZero));
  return 1.0 / (1.0 + std::exp(-sum / static_cast<double>(probabilities.size())));
}

/// The last word.
struct Verdicts {
  std::vector<double> of_boxes;   ///< 0 for those that were not looked at
  std::vector<double> of_places;  ///< in their order
};

/// The second look, at a few boxes of every place. A person looks like one in the boxes beside the best one too; what
/// only resembles a person does so in a box or two.
/// @param places         the surest box of each
/// @param screened        by the first look
/// @param first_threshold that lets boxes through
Verdicts look_again(CheckedLooks& looks, std::span<const Roi> rois, std::span<const std::size_t> places,
                    std::span<const double> screened, double first_threshold, const ClassifyOptions& options) {
  const auto by_probability = surest_first(screened, first_threshold);
  std::vector<std::vector<std::size_t>> boxes;
  std::set<std::size_t> chosen;
  for (const std::size_t surest : places) {
    boxes.push_back(boxes_around(surest, by_probability, rois, options));
    chosen.insert(boxes.back().begin(), boxes.back().end());
  }
  const std::vector<std::size_t> all(chosen.begin(), chosen.end());
  const auto probabilities = looks.classify(all);
  Verdicts verdicts{std::vector<double>(rois.size(), 0.0), {}};
  for (std::size_t k = 0; k < all.size(); ++k) verdicts.of_boxes[all[k]] = probabilities[k];
  for (const auto& of_place : boxes)
    verdicts.of_places.push_back(agreed(values_at(verdicts.of_boxes, of_place), first_threshold, options));
  return verdicts;
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
    if (roi.obstacle != surest.obstacle || overlap(roi.person, surest.person) <= options.max_overlap) continue;
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
                                : Verdicts{result.screened, values_at(result.screened, places)};
  std::vector<Roi> candidates;
  for (const std::size_t i : places) candidates.push_back(rois[i]);
  for (const std::size_t i : suppress_in_metres(candidates, verdicts.of_places, threshold, options)) {
    const Roi roi = averaged(candidates[i], rois, verdicts.of_boxes, options);
    result.pedestrians.push_back(
        {roi.x_m, roi.y_m, std::hypot(roi.x_m, roi.y_m), roi.height_m, verdicts.of_places[i], roi.person});
  }
  std::stable_sort(result.pedestrians.begin(), result.pedestrians.end(),
                   [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return result;
}

}  // namespace flies
