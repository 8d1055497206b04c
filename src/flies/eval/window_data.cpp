#include "flies/eval/window_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> pictures_among(const std::vector<fs::path>& files) {
  std::vector<std::string> pictures;
  for (const auto& file : files)
    if (detail::is_image_name(file)) pictures.push_back(file.string());
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

/// All pictures of a folder and those below it, in name order.
std::vector<std::string> pictures_below(const fs::path& folder) {
  return pictures_among(detail::files_below(folder, detail::is_image_name));
}

fs::path part_of(const fs::path& folder, const char* name) {
  if (!detail::is_there_as_folder(folder)) throw InputError(folder.string(), "", "is not a folder");
  if (!detail::is_there_as_folder(folder / name))
    throw InputError(folder.string(), name, "not found, expected the folders positives and negatives");
  return folder / name;
}

std::vector<PictureSet> positive_sets(const fs::path& folder) {
  std::vector<PictureSet> sets;
  for (const auto& below : detail::folders_of(folder))
    sets.push_back({below.filename().string(), pictures_below(below)});
  sets.push_back({"positives", pictures_among(detail::files_of(folder))});
  std::erase_if(sets, [](const PictureSet& set) { return set.files.empty(); });
  std::sort(sets.begin(), sets.end(), [](const PictureSet& a, const PictureSet& b) { return a.name < b.name; });
  return sets;
}

/// The picture as one window.
ImageBox whole_window(const GrayView& image, const std::string& file) {
  if (2 * image.width_px != image.height_px)
    throw InputError(
        file, "size",
        fmt::format("found {} x {} px, expected a window twice as high as wide", image.width_px, image.height_px));
  return {0.0, 0.0, static_cast<double>(image.width_px), static_cast<double>(image.height_px)};
}

}  // namespace

WindowData open_window_data(const fs::path& folder) {
  const fs::path with_people = part_of(folder, "positives"), without = part_of(folder, "negatives");
  WindowData data{positive_sets(with_people), pictures_below(without)};
  const std::string empty = fmt::format("holds no pictures, expected {}", detail::kReadableImages);
  if (data.positives.empty()) throw InputError(with_people.string(), "", empty);
  if (data.negatives.empty()) throw InputError(without.string(), "", empty);
  return data;
}

std::vector<ImageBox> draw_windows(int image_width_px, int image_height_px, int count, const WindowSampling& sampling,
                                   std::uint32_t picture) {
  const double max_height_px = std::min(static_cast<double>(image_height_px), 2.0 * image_width_px);
  std::vector<ImageBox> windows;
  if (max_height_px < sampling.min_height_px) return windows;
  for (int i = 0; i < count; ++i) {
    FlyRandom random(sampling.seed, 0, picture, static_cast<std::uint32_t>(i));
    const double height_px = std::exp(random.uniform(std::log(sampling.min_height_px), std::log(max_height_px)));
    const double width_px = height_px / 2.0;
    windows.push_back({random.uniform(0.0, image_width_px - width_px), random.uniform(0.0, image_height_px - height_px),
                       width_px, height_px});
  }
  return windows;
}

std::size_t count_pictures(const WindowData& data) {
  std::size_t count = data.negatives.size();
  for (const auto& set : data.positives) count += set.files.size();
  return count;
}

std::vector<WindowScores> score_windows(const WindowData& data, std::span<const WindowClassifier> classifiers,
                                        const WindowSampling& sampling,
                                        const std::function<void(std::size_t)>& progress) {
  std::vector<WindowScores> scores(classifiers.size());
  std::size_t done = 0;
  const auto count_one = [&] {
    ++done;
    if (progress) progress(done);
  };
  for (const auto& set : data.positives) {
    for (auto& of_classifier : scores) of_classifier.positives.push_back({set.name, {}});
    for (const auto& file : set.files) {
      const GrayImage image = load_gray_image(file);
      const ImageBox window = whole_window(image.view(), file);
      for (std::size_t c = 0; c < classifiers.size(); ++c)
        scores[c].positives.back().scores.push_back(classifiers[c](image.view(), {&window, 1}).front());
      count_one();
    }
  }
  const int pictures = static_cast<int>(data.negatives.size());
  bool has_any = false;
  for (int i = 0; i < pictures; ++i) {
    const GrayImage image = load_gray_image(data.negatives[static_cast<std::size_t>(i)]);
    const int count = sampling.negatives / pictures + (i < sampling.negatives % pictures ? 1 : 0);
    const auto windows = draw_windows(image.width_px, image.height_px, count, sampling, static_cast<std::uint32_t>(i));
    has_any = has_any || !windows.empty();
    for (std::size_t c = 0; c < classifiers.size(); ++c)
      scores[c].negatives.push_back(classifiers[c](image.view(), windows));
    count_one();
  }
  if (!has_any)
    throw InputError(data.negatives.front(), "size",
                     fmt::format("neither this picture nor the others hold a window {} px high, expected larger ones",
                                 sampling.min_height_px));
  return scores;
}

}  // namespace flies
