#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "flies/concentrate/concentrate.hpp"
#include "flies/concentrate/steps.hpp"

namespace flies {
namespace {

/// The `count` fullest intervals that are local maxima, fullest first. Two samples of one view-angle are worth their
/// mean shifts only when they start on different surfaces.
void find_fullest_intervals(const std::vector<double>& votes, int count, std::vector<std::size_t>& fullest) {
  // Every interval is written, and overwritten by the next one unless it is a maximum: a branch would be mispredicted.
  fullest.resize(votes.size());
  std::size_t maxima = 0;
  for (std::size_t k = 0; k < votes.size(); ++k) {
    const double before = k > 0 ? votes[k - 1] : 0.0, after = k + 1 < votes.size() ? votes[k + 1] : 0.0;
    fullest[maxima] = k;
    maxima += static_cast<std::size_t>(votes[k] >= before) & static_cast<std::size_t>(votes[k] > after);
  }
  fullest.resize(maxima);
  std::sort(fullest.begin(), fullest.end(),
            [&](std::size_t a, std::size_t b) { return votes[a] > votes[b] || (votes[a] == votes[b] && a < b); });
  fullest.resize(std::min(fullest.size(), static_cast<std::size_t>(count)));
}

/// Of an azimuth below 90 degrees; beyond, where no point ahead is, infinite.
double tangent(double azimuth_rad) {
  return azimuth_rad < 0.5 * std::numbers::pi ? std::tan(azimuth_rad) : std::numeric_limits<double>::infinity();
}

void lay_out_views(const HistogramAxis& axis, const ConcentrateOptions& options, std::vector<ViewAngle>& views) {
  const double width_rad = radians(options.view_angle_deg);
  const double first_azimuth_rad = -radians(options.half_field_deg);
  views.resize(count_view_angles(options));
  double right_rad = first_azimuth_rad;
  for (std::size_t a = 0; a < views.size(); ++a) {
    auto& view = views[a];
    view.min_azimuth_rad = right_rad;
    view.max_azimuth_rad = right_rad = first_azimuth_rad + static_cast<double>(a + 1) * width_rad;
    view.votes.assign(static_cast<std::size_t>(axis.bins), 0.0);
    view.samples.clear();
    view.samples.reserve(static_cast<std::size_t>(options.samples));
  }
}

/// The flies come from right to left, so that the view-angles are gone through once and no azimuth is computed.
void vote(const Sightings& flies, const HistogramAxis& axis, std::vector<ViewAngle>& views) {
  auto view = views.begin();
  double left = tangent(view->max_azimuth_rad);
  const double right_most = std::tan(views.front().min_azimuth_rad);
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (flies.tangent[i] < right_most) continue;
    for (; flies.tangent[i] >= left; left = tangent(view->max_azimuth_rad))
      if (++view == views.end()) return;
    const double bin = std::floor((flies.x_m[i] - axis.min_m) / axis.bin_m);
    if (bin < 0 || bin >= axis.bins) continue;
    view->votes[static_cast<std::size_t>(bin)] += flies.fitness[i];
  }
}

}  // namespace

std::size_t count_view_angles(const ConcentrateOptions& options) {
  return static_cast<std::size_t>(std::max(1L, std::lround(2.0 * options.half_field_deg / options.view_angle_deg)));
}

void sample_histograms(const Sightings& flies, const FieldOptions& field, const ConcentrateOptions& options,
                       std::vector<std::size_t>& fullest, HistogramAxis& axis, std::vector<ViewAngle>& views) {
  axis = {field.x_min_m, options.bin_m,
          std::max(1, static_cast<int>(std::ceil((field.x_max_m - field.x_min_m) / options.bin_m)))};
  fullest.reserve(static_cast<std::size_t>(axis.bins));
  lay_out_views(axis, options, views);
  vote(flies, axis, views);
  for (auto& view : views) {
    const double middle = std::tan(0.5 * (view.min_azimuth_rad + view.max_azimuth_rad));
    find_fullest_intervals(view.votes, options.samples, fullest);
    for (const auto k : fullest) {
      const double d = axis.min_m + (static_cast<double>(k) + 0.5) * axis.bin_m;
      view.samples.push_back({d, d * middle});
    }
  }
}

HistogramSampling sample_histograms(const Population& flies, const FieldOptions& field,
                                    const ConcentrateOptions& options) {
  check_options(options, "concentrate options");
  check_field(field, "field options");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const FieldOptions ahead{field.x_min_m, kInfinity, -kInfinity, kInfinity, -kInfinity, kInfinity};
  Sightings sightings;
  FlySighter().sight(flies, {}, ahead, sightings);
  HistogramSampling result;
  std::vector<std::size_t> fullest;
  sample_histograms(sightings, field, options, fullest, result.axis, result.view_angles);
  return result;
}

}  // namespace flies
