#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace flies {

/// What is known of a sector of the scan.
enum class SectorState {
  obstacle,  ///< something stands at its range
  free,      ///< nothing stands in it up to the range that the ground was seen free
  unknown,   ///< cannot be told: no texture, out of view, saturated. Neither free nor an obstacle
};
inline constexpr std::array<std::string_view, 3> kSectorStateNames = {"obstacle", "free", "unknown"};

/// What a laser scanner on the left camera, sweeping what stands on the road, would have measured: one entry a sector
/// in every vector. Angles are measured from straight ahead (x) in the ground plane, counter-clockwise, so they grow to
/// the left. Field names are those of ROS's LaserScan where they mean the same.
struct Scan {
  double angle_min_rad = 0.0;        ///< middle of the first sector, the rightmost
  double angle_increment_rad = 0.0;  ///< from one sector to the next, > 0; also their width
  std::vector<double> ranges_m;      ///< of the nearest obstacle along the ground; NaN where none is reported
  std::vector<double> free_m;        ///< range up to which the ground was seen free; 0 where none was
  std::vector<double> confidence;    ///< of the state, 0..1; of unknown sectors 0
  std::vector<SectorState> states;

  std::size_t size() const { return states.size(); }
  bool empty() const { return states.empty(); }
  double angle_rad(std::size_t sector) const {
    return angle_min_rad + static_cast<double>(sector) * angle_increment_rad;
  }
};

}  // namespace flies
