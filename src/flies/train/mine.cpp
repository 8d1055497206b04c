#include "flies/train/mine.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

namespace flies {
namespace {

struct Hard {
  double score = 0.0;
  TrainingWindow window;
};

/// Keeps the highest scores, in falling order; among equals the first.
void keep_hardest(std::vector<Hard>& hard, int count) {
  std::stable_sort(hard.begin(), hard.end(), [](const Hard& a, const Hard& b) { return a.score > b.score; });
  hard.resize(std::min(hard.size(), static_cast<std::size_t>(count)));
}

std::vector<Hard> hard_windows_in(const TrainingPicture& picture, std::uint32_t index, const HogGeometry& geometry,
                                  const WindowScorer& scorer, std::uint32_t round, const TrainOptions& options) {
  const GrayImage image = load_picture(picture);
  const auto windows = windows_without_people(picture, image.width_px, image.height_px, index, round,
                                              options.negatives.windows_per_picture, options);
  const Matrix features = features_in(image, windows, geometry);
  std::vector<Hard> hard;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const double score = scorer(features.row(i));
    if (score > options.negatives.hard_above) hard.push_back({score, windows[i]});
  }
  keep_hardest(hard, options.negatives.per_picture);
  return hard;
}

}  // namespace

std::vector<TrainingWindow> mine_hard_windows(std::span<const TrainingPicture> pictures,
                                              std::span<const std::uint32_t> chosen, const HogGeometry& geometry,
                                              const WindowScorer& scorer, std::uint32_t round,
                                              const TrainOptions& options,
                                              const std::function<void(std::size_t)>& progress) {
  std::vector<std::vector<Hard>> by_picture(chosen.size());
  std::mutex counting;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    by_picture[i] = hard_windows_in(pictures[chosen[i]], chosen[i], geometry, scorer, round, options);
    const std::scoped_lock lock(counting);
    ++done;
    if (progress) progress(done);
  });
  std::vector<Hard> all;
  for (auto& hard : by_picture) std::move(hard.begin(), hard.end(), std::back_inserter(all));
  keep_hardest(all, options.negatives.per_round);
  std::vector<TrainingWindow> windows;
  for (const auto& hard : all) windows.push_back(hard.window);
  return windows;
}

}  // namespace flies
