#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/planar_motion.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/scan/cell_layout.hpp"
#include "flies/scan/scan_options.hpp"

namespace flies {

/// One thing seen: along its line of sight nothing stands up to its place, where something does.
struct Seen {
  double parallax_px = 0.0;       ///< of what is seen
  double road_parallax_px = 0.0;  ///< of the road along the same line of sight; not positive above the horizon
  double weight = 0.0;            ///< >= 0, 1 for a cell that is believed in full
};

/// What speaks for and against an obstacle at every disparity of every column. Its last disparity, number
/// `disparities`, stands for no obstacle at all.
class Evidence {
 public:
  /// Adds up what cells and flies show.
  void collect(const CellLayout& layout, std::span<const CellPoint> points, const Population& flies,
               const Projection& projection, const RoadPlane& road, const ScanOptions& options);

  /// Adds what was known at the pair before (`EvidenceOptions::memory`) to columns where this pair shows little: every
  /// place asks what was known of it, as if all things stood still. The camera is taken to look along the vehicle's x.
  /// @param motion from that pair to this one
  void recall(const Evidence& before, const PlanarMotion& motion);

  int columns() const { return columns_; }
  int labels() const { return labels_; }  ///< disparities + 1
  /// Costs of all labels, column by column.
  std::span<const float> costs() const { return cost_; }
  std::span<const float> cost(int column) const { return row(cost_, column); }
  /// Cells' worth of support for each disparity of a column; of no obstacle 0.
  std::span<const float> support(int column) const { return row(support_, column); }

 private:
  void add(int column, const Seen& seen);
  void price(int column);
  std::size_t start(int column) const { return static_cast<std::size_t>(column) * static_cast<std::size_t>(labels_); }
  std::span<const float> row(const std::vector<float>& values, int column) const {
    return {values.data() + start(column), static_cast<std::size_t>(labels_)};
  }

  int columns_ = 0, labels_ = 0;
  double nearest_px_ = 0.0;                      ///< parallax of disparity number 0
  double camera_height_m_ = 0.0;                 ///< above the road
  double depth_parallax_ = 0.0;                  ///< depth times parallax, m px
  double first_slope_ = 0.0, slope_step_ = 0.0;  ///< y over x of the first column, and from one to the next
  ScanOptions options_;
  std::vector<float> against_, support_;  ///< `against_` holds differences from label to label while it is collected
  std::vector<float> cost_;
};

/// Height above the road of what is seen.
inline double height_above_road_m(double camera_height_m, double road_parallax_px, double parallax_px) {
  return camera_height_m * (1.0 - road_parallax_px / parallax_px);
}

}  // namespace flies
