#include <algorithm>
#include <cmath>
#include <numeric>

#include "flies/concentrate/concentrate.hpp"

namespace flies {
namespace {

/// The `count` fullest intervals that are local maxima, fullest first. Two samples of one view-angle are worth their
/// mean shifts only when they start on different surfaces.
std::vector<int> fullest_intervals(const std::vector<double>& votes, int count) {
  const int bins = static_cast<int>(votes.size());
  const auto vote = [&](int k) { return k < 0 || k >= bins ? 0.0 : votes[static_cast<std::size_t>(k)]; };
  std::vector<int> maxima;
  for (int k = 0; k < bins; ++k)
    if (vote(k) > 0.0 && vote(k) >= vote(k - 1) && vote(k) > vote(k + 1)) maxima.push_back(k);
  std::stable_sort(maxima.begin(), maxima.end(), [&](int a, int b) { return vote(a) > vote(b); });
  maxima.resize(std::min(maxima.size(), static_cast<std::size_t>(count)));
  return maxima;
}

}  // namespace

HistogramSampling sample_histograms(const Population& flies, const FieldOptions& field,
                                    const ConcentrateOptions& options) {
  HistogramSampling result;
  result.axis = {field.x_min_m, options.bin_m,
                 std::max(1, static_cast<int>(std::ceil((field.x_max_m - field.x_min_m) / options.bin_m)))};
  const double width_rad = radians(options.view_angle_deg);
  const double first_azimuth_rad = -radians(options.half_field_deg);
  const int angles = std::max(1, static_cast<int>(std::lround(2.0 * options.half_field_deg / options.view_angle_deg)));
  for (int a = 0; a < angles; ++a)
    result.view_angles.push_back({first_azimuth_rad + a * width_rad,
                                  first_azimuth_rad + (a + 1) * width_rad,
                                  std::vector<double>(static_cast<std::size_t>(result.axis.bins)),
                                  {}});

  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (!(flies.fitness[i] > 0.0F)) continue;
    const double angle = std::floor((std::atan2(flies.y_m[i], flies.x_m[i]) - first_azimuth_rad) / width_rad);
    const double bin = std::floor((flies.x_m[i] - result.axis.min_m) / result.axis.bin_m);
    if (angle < 0 || angle >= angles || bin < 0 || bin >= result.axis.bins) continue;
    result.view_angles[static_cast<std::size_t>(angle)].votes[static_cast<std::size_t>(bin)] += flies.fitness[i];
  }

  for (auto& view : result.view_angles) {
    const double tangent = std::tan(0.5 * (view.min_azimuth_rad + view.max_azimuth_rad));
    for (const int k : fullest_intervals(view.votes, options.samples)) {
      const double d = result.axis.min_m + (k + 0.5) * result.axis.bin_m;
      view.samples.push_back({d, d * tangent});
    }
  }
  return result;
}

}  // namespace flies
