#include "flies/train/samples.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace flies {
namespace {

auto key_of(const TrainingWindow& w) {
  return std::tuple(w.picture, w.is_mirrored, w.window.u_px, w.window.v_px, w.window.width_px, w.window.height_px);
}

}  // namespace

HoldOut split_in_runs(std::size_t pictures, double share) {
  constexpr std::size_t kRuns = 20;
  const std::size_t runs = std::min(kRuns, pictures);
  const auto is_kept_apart = [&](std::size_t run) {
    const auto before = std::floor(static_cast<double>(run) * share);
    return std::floor(static_cast<double>(run + 1) * share) > before;
  };
  HoldOut split;
  for (std::size_t i = 0; i < pictures; ++i)
    (is_kept_apart(i * runs / pictures) ? split.kept_apart : split.learnt).push_back(static_cast<std::uint32_t>(i));
  // A small share of few runs may be none of them, and a large one all.
  if (split.kept_apart.empty() && split.learnt.size() > 1) {
    split.kept_apart.push_back(split.learnt.back());
    split.learnt.pop_back();
  }
  if (split.learnt.empty() && split.kept_apart.size() > 1) {
    split.learnt.push_back(split.kept_apart.back());
    split.kept_apart.pop_back();
  }
  return split;
}

Samples people_samples(std::span<const TrainingPicture> pictures, std::span<const std::uint32_t> chosen,
                       const HogGeometry& geometry, const TrainOptions& options) {
  std::vector<TrainingWindow> windows;
  for (const std::uint32_t i : chosen)
    std::ranges::copy(windows_with_people(pictures[i], i, options.positives, options.seed),
                      std::back_inserter(windows));
  Samples samples;
  samples.features = features_of(pictures, windows, geometry);
  samples.people = windows.size();
  samples.is_person.assign(windows.size(), 1);
  return samples;
}

void add_background(Samples& samples, std::span<const TrainingPicture> pictures,
                    std::span<const TrainingWindow> windows, const HogGeometry& geometry) {
  std::set<decltype(key_of(windows.front()))> known;
  for (const auto& window : samples.background) known.insert(key_of(window));
  std::vector<TrainingWindow> added;
  for (const auto& window : windows)
    if (known.insert(key_of(window)).second) added.push_back(window);

  const Matrix features = features_of(pictures, added, geometry);
  samples.features.values.insert(samples.features.values.end(), features.values.begin(), features.values.end());
  samples.features.rows += features.rows;
  samples.features.columns = features.columns;
  samples.is_person.resize(samples.features.rows, 0);
  samples.background.insert(samples.background.end(), added.begin(), added.end());
}

void keep_background(Samples& samples, const std::function<bool(std::span<const float> features)>& is_kept) {
  const std::size_t columns = samples.features.columns;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples.background.size(); ++i) {
    const std::size_t row = samples.people + i;
    if (!is_kept(samples.features.row(row))) continue;
    const auto from = samples.features.values.begin() + static_cast<std::ptrdiff_t>(row * columns);
    const auto to = samples.features.values.begin() + static_cast<std::ptrdiff_t>((samples.people + kept) * columns);
    if (from != to) std::copy(from, from + static_cast<std::ptrdiff_t>(columns), to);
    samples.background[kept++] = samples.background[i];
  }
  samples.background.resize(kept);
  samples.features.rows = samples.people + kept;
  samples.features.values.resize(samples.features.rows * columns);
  samples.is_person.resize(samples.features.rows);
}

}  // namespace flies
