#pragma once

#include <span>

#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// Standard deviation of image noise that the correlation of poor texture is lowered for; roads are poor in texture.
inline constexpr double kRoadNoise_gray = 1.0;

/// A second match this many pixels off and this close in correlation makes a place ambiguous.
inline constexpr int kAmbiguousDistance_px = 3;
inline constexpr double kAmbiguousMargin = 0.05;

/// Correlations of the wide, flat neighbourhood of a left pixel with those at a row of disparities, in steps of one
/// pixel from `lowest_px`; 0 where a neighbourhood leaves its image.
/// @param pair images of one height; the right one may be wider
void correlate_disparities(const RectifiedPair& pair, const StereoPoint& image, double lowest_px,
                           std::span<float> correlation);

/// The best of a row of correlations.
/// @returns its index between steps of one pixel; negative when it is poorer than `min_correlation`, the first or the
///          last, or has a rival elsewhere
double unambiguous_best(std::span<const float> correlation, double min_correlation);

}  // namespace flies
