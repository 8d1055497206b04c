#include "flies/classify/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "flies/core/box_overlap.hpp"

namespace flies {
namespace {

/// Numbers of the boxes of one place.
using Boxes = std::vector<std::size_t>;

std::vector<double> values_at(std::span<const double> values, std::span<const std::size_t> indices) {
  std::vector<double> result;
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

/// The surest boxes of one obstacle that show the same part of the image as the surest one of all, itself first.
Boxes boxes_around(std::size_t surest, std::span<const std::size_t> by_probability, std::span<const Roi> rois,
                   const ClassifyOptions& options) {
  Boxes boxes{surest};
  for (const std::size_t i : by_probability) {
    if (boxes.size() >= static_cast<std::size_t>(options.second_looks)) break;
    if (i != surest && rois[i].obstacle == rois[surest].obstacle &&
        covered_share(rois[i].person, rois[surest].person) > options.max_overlap)
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

/// The same person with the box a little to the side, lower or higher, larger or smaller.
/// @param right, down of the window's height
Roi moved(Roi roi, double right, double down, double scale) {
  const double tall_px = roi.window.height_px;
  const double left_m = -right * tall_px * roi.height_m / roi.person.height_px;  // across the line of sight
  for (ImageBox* box : {&roi.window, &roi.person}) {
    box->u_px += right * tall_px + (1.0 - scale) * box->width_px / 2.0;
    box->v_px += down * tall_px + (1.0 - scale) * box->height_px / 2.0;
    box->width_px *= scale;
    box->height_px *= scale;
  }
  const double range_m = std::hypot(roi.x_m, roi.y_m);
  const double x_m = roi.x_m - left_m * roi.y_m / range_m, y_m = roi.y_m + left_m * roi.x_m / range_m;
  roi.x_m = x_m;
  roi.y_m = y_m;
  roi.height_m *= scale;
  return roi;
}

/// Half as far from the box as those that were proposed are.
std::vector<Roi> finer_boxes(const Roi& roi) {
  constexpr double kStep = 0.04, kScale = 1.1;
  return {moved(roi, kStep, 0.0, 1.0),  moved(roi, -kStep, 0.0, 1.0), moved(roi, 0.0, kStep, 1.0),
          moved(roi, 0.0, -kStep, 1.0), moved(roi, 0.0, 0.0, kScale), moved(roi, 0.0, 0.0, 1.0 / kScale)};
}

class SecondLook {
 public:
  SecondLook(CheckedLooks& looks, std::span<const Roi> rois, const ClassifyOptions& options)
      : looks_(looks),
        options_(options),
        verdicts_{{rois.begin(), rois.end()}, std::vector<double>(rois.size(), 0.0), {}, {}} {}

  /// At all these boxes, each once.
  void classify(const std::set<std::size_t>& chosen) {
    const Boxes some(chosen.begin(), chosen.end());
    const auto probabilities = looks_.classify(some);
    for (std::size_t k = 0; k < some.size(); ++k) verdicts_.of_boxes[some[k]] = probabilities[k];
  }

  double surest(const Boxes& boxes) const { return verdicts_.of_boxes[surest_box(boxes)]; }

  /// Looks between the boxes of places where a person seems to be, and is not sure to be already.
  /// @param missing as in `agreed`
  void refine(std::vector<Boxes>& places, double missing) {
    constexpr double kSurely = 0.95;  // finer boxes change nothing any more
    std::vector<ImageBox> windows;
    const std::size_t before = verdicts_.boxes.size();
    for (auto& boxes : places) {
      const std::size_t best = surest_box(boxes);
      if (!(verdicts_.of_boxes[best] > options_.min_refined_probability) ||
          agreed(values_at(verdicts_.of_boxes, boxes), missing, options_) > kSurely)
        continue;
      for (const Roi& roi : finer_boxes(verdicts_.boxes[best])) {
        boxes.push_back(before + windows.size());
        windows.push_back(roi.window);
        verdicts_.boxes.push_back(roi);
      }
    }
    const auto probabilities = looks_.classify_others(windows);
    verdicts_.of_boxes.insert(verdicts_.of_boxes.end(), probabilities.begin(), probabilities.end());
  }

  Verdicts verdicts(const std::vector<Boxes>& places, double missing) && {
    for (const auto& boxes : places) {
      verdicts_.of_places.push_back(agreed(values_at(verdicts_.of_boxes, boxes), missing, options_));
      verdicts_.surest.push_back(surest_box(boxes));
    }
    return std::move(verdicts_);
  }

 private:
  std::size_t surest_box(const Boxes& boxes) const {
    return *std::max_element(boxes.begin(), boxes.end(), [&](std::size_t a, std::size_t b) {
      return verdicts_.of_boxes[a] < verdicts_.of_boxes[b];
    });
  }

  CheckedLooks& looks_;
  const ClassifyOptions& options_;
  Verdicts verdicts_;
};

}  // namespace

double covered_share(const ImageBox& a, const ImageBox& b) {
  const double both_px2 = intersection_px2(a, b);
  return both_px2 > 0.0 ? both_px2 / std::min(area_px2(a), area_px2(b)) : 0.0;
}

std::vector<std::size_t> surest_first(std::span<const double> probabilities, double threshold) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < probabilities.size(); ++i)
    if (probabilities[i] > threshold) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return probabilities[a] > probabilities[b]; });
  return order;
}

Verdicts verdicts_of_one_look(std::span<const Roi> rois, std::span<const std::size_t> places,
                              std::span<const double> screened) {
  return {{rois.begin(), rois.end()},
          {screened.begin(), screened.end()},
          values_at(screened, places),
          {places.begin(), places.end()}};
}

Verdicts look_again(CheckedLooks& looks, std::span<const Roi> rois, std::span<const std::size_t> places,
                    std::span<const double> screened, double first_threshold, const ClassifyOptions& options) {
  const auto by_probability = surest_first(screened, first_threshold);
  SecondLook look(looks, rois, options);
  std::vector<Boxes> all, chosen;
  std::set<std::size_t> first, rest;
  for (const std::size_t surest : places) {
    all.push_back(boxes_around(surest, by_probability, rois, options));
    chosen.push_back({surest});
    first.insert(surest);
  }
  look.classify(first);
  for (std::size_t place = 0; place < places.size(); ++place) {
    if (look.surest(chosen[place]) < options.min_second_probability) continue;
    chosen[place] = all[place];
    for (const std::size_t i : chosen[place])
      if (!first.contains(i)) rest.insert(i);
  }
  look.classify(rest);
  look.refine(chosen, first_threshold);
  return std::move(look).verdicts(chosen, first_threshold);
}

}  // namespace flies
