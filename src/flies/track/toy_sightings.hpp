#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/track/tracks.hpp"

/// What tests let a tracker see: things before a camera that stands or drives.
namespace flies::testing {

inline constexpr double kDt_s = 0.1;

inline StereoCamera camera() {
  return {.fx_px = 720,
          .fy_px = 720,
          .cx_px = 620,
          .cx_right_px = 620,
          .cy_px = 180,
          .baseline_m = 0.54,
          .width_px = 1242,
          .height_px = 375,
          .mount = {.height_m = 1.65}};
}

inline Sighting at(double x_m, double y_m, double width_m = 0.6) { return {x_m, y_m, width_m, 1.7, {}, std::nullopt}; }
inline EgoMotion standing() { return given_ego_motion(kDt_s, 0.0, 0.0, 0.0); }
inline EgoMotion standing_for(double dt_s) { return given_ego_motion(dt_s, 0.0, 0.0, 0.0); }

inline std::vector<std::uint64_t> ids_of(const std::vector<Track>& tracks) {
  std::vector<std::uint64_t> ids;
  for (const auto& track : tracks) ids.push_back(track.id);
  return ids;
}

}  // namespace flies::testing
