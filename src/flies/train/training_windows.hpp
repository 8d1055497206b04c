#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/classify/hog.hpp"
#include "flies/classify/people_model.hpp"
#include "flies/train/train_options.hpp"
#include "flies/train/training_picture.hpp"

namespace flies {

/// A window to learn from, as a place and not as pixels: its features are computed when they are needed.
struct TrainingWindow {
  std::uint32_t picture = 0;  ///< index into the pictures
  bool is_mirrored = false;   ///< the window's pixels are, left to right
  ImageBox window;            ///< aspect 1:2, in the picture as it is; may reach beyond it

  bool operator==(const TrainingWindow& other) const;
};

/// The windows of all people in a picture: the exact one, its mirror, and jittered ones, every second mirrored.
/// @param index of the picture; with the seed it decides the jitter
std::vector<TrainingWindow> windows_with_people(const TrainingPicture& picture, std::uint32_t index,
                                                const PositiveOptions& options, std::uint64_t seed);

/// The exact windows of all people in a picture.
std::vector<TrainingWindow> exact_windows_with_people(const TrainingPicture& picture, std::uint32_t index,
                                                      double person_share);

/// Windows without people, clear of those that are labelled: `count` at random, log-uniform in height, or the flies'
/// proposals, at most `count` of them, drawn at random. Half of them are mirrored.
/// @param round another round gives other windows
std::vector<TrainingWindow> windows_without_people(const TrainingPicture& picture, int width_px, int height_px,
                                                   std::uint32_t index, std::uint32_t round, int count,
                                                   const TrainOptions& options);

/// The features of windows of one picture.
/// @returns a row each
Matrix features_in(const GrayImage& image, std::span<const TrainingWindow> windows, const HogGeometry& geometry);

/// The features of windows of any pictures, each of which is read once, a few at a time. Runs on oneTBB's current
/// arena.
/// @returns a row each, in the order of the windows
/// @throws InputError from reading a picture
Matrix features_of(std::span<const TrainingPicture> pictures, std::span<const TrainingWindow> windows,
                   const HogGeometry& geometry);

}  // namespace flies
