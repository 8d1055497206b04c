#pragma once

#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/diagnose/image_noise.hpp"

namespace flies {

/// In what the images of two cameras differ that should see alike. Ratios are those of the right image over the left.
struct SideDifference {
  /// Of the cells of a grid of 20 x 8 that show something, those whose place in the other image shows nothing: 0.04 at
  /// most in 53 good pairs.
  double left_blind_share = 0.0, right_blind_share = 0.0;
  double sharpness = 1.0;   ///< of gradients, less what noise adds, over contrast; 0.84 to 1.14 in good pairs
  double contrast = 1.0;    ///< of the standard deviations of the grey levels; 0.89 to 1.07 in good pairs
  double brightness = 1.0;  ///< of the mean grey levels; 0.85 to 1.07 in good pairs
  ImageNoise left_noise = {}, right_noise = {};
  /// Of the image, the largest patch of one level where the other image shows something all about: 0.005 at most in 58
  /// good pairs, a disc of 120 px in 1242 x 375 has 0.01. Black that reaches in from the border, as rectifying leaves
  /// it, is none.
  double left_blind_patch = 0.0, right_blind_patch = 0.0;
  /// Of the rows, those of one level throughout, between others, where the other image shows something: none in good
  /// pairs.
  double left_lost_rows = 0.0, right_lost_rows = 0.0;
  double left_lost_columns = 0.0, right_lost_columns = 0.0;  ///< likewise of the columns
  /// The sharpness of the sixth of the columns that differs most towards either side: 0.7 and 2.7 in good pairs.
  double least_sharpness = 1.0, most_sharpness = 1.0;

  /// Whether exposure or gain of the cameras are not the same.
  bool is_exposed_unlike() const;
  /// Whether one image is noisy and the other one is not.
  bool is_noisy_on_one_side() const;
  /// Of the noisier image.
  const ImageNoise& noise() const;
};

/// @param pair both images of one size, at least 64 x 48 px
SideDifference compare_sides(const RectifiedPair& pair);

/// Member by member the median. @returns no difference for no pairs
SideDifference median_side_difference(const std::vector<SideDifference>& pairs);

/// What is wrong with one of the cameras, one sentence each; empty when both see alike.
std::vector<std::string> complaints(const SideDifference& difference);

}  // namespace flies
