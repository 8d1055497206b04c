#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flies/synth/paste.hpp"
#include "flies/synth/surroundings.hpp"

namespace flies::synth {

/// Disparities within this are one surface: so far off are lidar and matching.
inline constexpr float kSameSurface_px = 0.7F;

/// A cut-out in a place.
struct Place {
  const CutOut* cut = nullptr;
  double height_m = 0.0, height_px = 0.0, depth_m = 0.0;
  double u_px = 0.0, foot_v_px = 0.0;  ///< middle of the feet in the left image
  double disparity_px = 0.0;

  double scale() const { return height_px / cut->body.height_px; }
  ImageBox box() const {
    const double width_px = scale() * cut->body.width_px;
    return {u_px - width_px / 2, foot_v_px - height_px, width_px, height_px};
  }
};

/// Draws people and places on ground that is seen, in both images and not hidden by half.
/// @returns the farthest first, as they are painted
std::vector<Place> draw_places(const RealPair& pair, const Surroundings& around, std::span<const CutOut> cut_outs,
                               const PasteOptions& options, std::uint32_t frame);

}  // namespace flies::synth
