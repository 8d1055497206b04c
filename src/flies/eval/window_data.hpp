#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/eval/window_rates.hpp"

namespace flies {

/// Pictures that belong together.
struct PictureSet {
  std::string name;
  std::vector<std::string> files;  ///< in name order
};

/// Where to look for windows of known content: docs/evaluation.md describes the folder.
struct WindowData {
  std::vector<PictureSet> positives;   ///< a window with a person each
  std::vector<std::string> negatives;  ///< pictures without people
};

/// Finds `positives` (sub-folders are sets; pictures that lie in it directly are the set "positives") and `negatives`
/// (with sub-folders) in a folder.
/// @throws InputError naming the folder when one of the two is missing or holds no pictures
WindowData open_window_data(const std::filesystem::path& folder);

/// How windows are drawn from the pictures without people.
struct WindowSampling {
  int negatives = 204000;
  double min_height_px = 80.0;
  std::uint64_t seed = 1;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("negatives", self.negatives, Range{1, 50000000},
          "number of windows without people, spread evenly over the pictures");
    field("min_height_px", self.min_height_px, Range{8, 4096}, "height of the smallest of these windows");
    field("seed", self.seed, "seed of their positions");
  }
};

/// Windows of aspect 1:2 at places drawn evenly, their heights log-uniform from the lowest to the highest that fits.
/// @param picture numbers the pictures, so that each has windows of its own
/// @returns none when the picture is too small
std::vector<ImageBox> draw_windows(int image_width_px, int image_height_px, int count, const WindowSampling& sampling,
                                   std::uint32_t picture);

/// A classifier: one score per window of a picture.
using WindowClassifier = std::function<std::vector<double>(const GrayView&, std::span<const ImageBox>)>;

/// Lets every classifier look at all windows. One picture is in memory at a time, and of each window its score.
/// @param progress called with the number of pictures done
/// @returns in the order of the classifiers
/// @throws InputError from reading a picture, when a window with a person is not twice as high as wide, and when no
///         picture is large enough for a window without one
std::vector<WindowScores> score_windows(const WindowData& data, std::span<const WindowClassifier> classifiers,
                                        const WindowSampling& sampling = {},
                                        const std::function<void(std::size_t)>& progress = {});

/// Pictures that `score_windows` goes through.
std::size_t count_pictures(const WindowData& data);

}  // namespace flies
