#include "flies/train/training_windows.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "flies/core/random.hpp"
#include "flies/eval/people.hpp"
#include "flies/eval/window_data.hpp"

namespace flies {
namespace {

/// Keep the random numbers of different uses apart.
enum Purpose : std::uint32_t { kJitter = 0x7261, kPlaces, kMirror };

bool is_same_box(const ImageBox& a, const ImageBox& b) {
  return a.u_px == b.u_px && a.v_px == b.v_px && a.width_px == b.width_px && a.height_px == b.height_px;
}

ImageBox jittered(const ImageBox& window, const PositiveOptions& options, FlyRandom& random) {
  const double scale = std::exp(random.uniform(-1.0, 1.0) * std::log1p(options.jitter_scale));
  const double height_px = window.height_px * scale, width_px = window.width_px * scale;
  const double shift_px = options.jitter_shift * window.height_px;
  const double u_px = window.u_px + (window.width_px - width_px) / 2.0 + random.uniform(-shift_px, shift_px);
  const double v_px = window.v_px + (window.height_px - height_px) / 2.0 + random.uniform(-shift_px, shift_px);
  return {u_px, v_px, width_px, height_px};
}

bool is_clear_of_people(const ImageBox& window, const TrainingPicture& picture, const TrainOptions& options) {
  const auto overlaps = [&](const ImageBox& person) {
    return intersection_over_union(window, window_around(person, options.positives.person_share)) >
           options.negatives.max_overlap;
  };
  return std::none_of(picture.people.begin(), picture.people.end(), overlaps) &&
         std::none_of(picture.unclear.begin(), picture.unclear.end(), overlaps);
}

/// `count` of the proposals without repetition, all when there are no more.
std::vector<ImageBox> some_of(std::vector<ImageBox> proposals, int count, FlyRandom& random) {
  const auto wanted = std::min(static_cast<std::size_t>(count), proposals.size());
  for (std::size_t i = 0; i < wanted; ++i)
    std::swap(proposals[i], proposals[i + random.below(static_cast<std::uint32_t>(proposals.size() - i))]);
  proposals.resize(wanted);
  return proposals;
}

GrayImage mirrored(const GrayImage& image) {
  GrayImage result = image;
  for (int v = 0; v < image.height_px; ++v) {
    const auto row = result.pixels.begin() + static_cast<std::ptrdiff_t>(v) * image.width_px;
    std::reverse(row, row + image.width_px);
  }
  return result;
}

}  // namespace

bool TrainingWindow::operator==(const TrainingWindow& other) const {
  return picture == other.picture && is_mirrored == other.is_mirrored && is_same_box(window, other.window);
}

std::vector<TrainingWindow> exact_windows_with_people(const TrainingPicture& picture, std::uint32_t index,
                                                      double person_share) {
  std::vector<TrainingWindow> windows;
  for (const auto& person : picture.people) windows.push_back({index, false, window_around(person, person_share)});
  return windows;
}

std::vector<TrainingWindow> windows_with_people(const TrainingPicture& picture, std::uint32_t index,
                                                const PositiveOptions& options, std::uint64_t seed) {
  std::vector<TrainingWindow> windows;
  std::uint32_t number = 0;
  for (const auto& exact : exact_windows_with_people(picture, index, options.person_share)) {
    FlyRandom random(seed, kJitter, index, number++);
    windows.push_back(exact);
    windows.push_back({index, true, exact.window});
    for (int i = 0; i < options.jitters; ++i)
      windows.push_back({index, i % 2 == 1, jittered(exact.window, options, random)});
  }
  return windows;
}

std::vector<TrainingWindow> windows_without_people(const TrainingPicture& picture, int width_px, int height_px,
                                                   std::uint32_t index, std::uint32_t round, int count,
                                                   const TrainOptions& options) {
  FlyRandom places(options.seed, kPlaces, round, index);
  std::vector<ImageBox> boxes;
  if (picture.has_proposals) {
    boxes = some_of(picture.proposals, count, places);
  } else {
    WindowSampling sampling;
    sampling.min_height_px = options.negatives.min_height_px;
    // Another seed in every round gives other places.
    const std::uint64_t high = places.bits(), low = places.bits();
    sampling.seed = high << 32 | low;
    boxes = draw_windows(width_px, height_px, count, sampling, index);
  }
  std::vector<TrainingWindow> windows;
  FlyRandom mirror(options.seed, kMirror, round, index);
  for (const auto& box : boxes) {
    const bool is_mirrored = mirror.uniform() < 0.5;
    if (is_clear_of_people(box, picture, options)) windows.push_back({index, is_mirrored, box});
  }
  return windows;
}

Matrix features_in(const GrayImage& image, std::span<const TrainingWindow> windows, const HogGeometry& geometry) {
  const std::size_t count = feature_count(geometry);
  Matrix features{windows.size(), count, std::vector<float>(windows.size() * count)};
  GrayImage mirror;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const std::span<float> row{features.values.data() + i * count, count};
    ImageBox box = windows[i].window;
    if (windows[i].is_mirrored) {
      if (mirror.pixels.empty()) mirror = mirrored(image);
      box.u_px = image.width_px - box.u_px - box.width_px;
    }
    window_features((windows[i].is_mirrored ? mirror : image).view(), box, geometry, row);
  }
  return features;
}

Matrix features_of(std::span<const TrainingPicture> pictures, std::span<const TrainingWindow> windows,
                   const HogGeometry& geometry) {
  std::vector<std::size_t> order(windows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return windows[a].picture < windows[b].picture; });
  std::vector<std::size_t> starts;  // in `order`, of each picture
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i == 0 || windows[order[i]].picture != windows[order[i - 1]].picture) starts.push_back(i);
  starts.push_back(order.size());

  const std::size_t count = feature_count(geometry);
  Matrix features{windows.size(), count, std::vector<float>(windows.size() * count)};
  tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t p) {
    std::vector<TrainingWindow> of_picture;
    for (std::size_t i = starts[p]; i < starts[p + 1]; ++i) of_picture.push_back(windows[order[i]]);
    const TrainingPicture& picture = pictures[of_picture.front().picture];
    const GrayImage image = load_picture(picture);
    check_labels(picture, image.width_px, image.height_px);
    const Matrix rows = features_in(image, of_picture, geometry);
    for (std::size_t i = 0; i < rows.rows; ++i)
      std::ranges::copy(rows.row(i),
                        features.values.begin() + static_cast<std::ptrdiff_t>(order[starts[p] + i] * count));
  });
  return features;
}

}  // namespace flies
