#include "tests/fuzz/sound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <initializer_list>

namespace flies::testing {
namespace {

void require_finite(std::initializer_list<double> values) {
  for (const double value : values) require(std::isfinite(value));
}

void require_share(double value) { require(value >= 0.0 && value <= 1.0); }

void require_sound(const Obstacle& o) {
  require_finite({o.x_m, o.y_m, o.range_m, o.width_m, o.middle_offset_m, o.depth_m, o.height_m, o.ground_z_m, o.score,
                  o.range_sd_m});
  require(o.range_m >= 0.0 && o.width_m >= 0.0 && o.depth_m >= 0.0 && o.score >= 0.0 && o.range_sd_m >= 0.0);
  testing::require_sound(o.box);
}

void require_sound(const Pedestrian& p) {
  require_finite({p.x_m, p.y_m, p.range_m, p.height_m, p.range_sd_m});
  require(p.range_m >= 0.0 && p.height_m > 0.0 && p.range_sd_m >= 0.0);
  require_share(p.probability);
  testing::require_sound(p.box);
}

void require_sound(const Roi& roi) {
  require_finite({roi.x_m, roi.y_m, roi.height_m});
  require(roi.height_m > 0.0);
  testing::require_sound(roi.window);
  testing::require_sound(roi.person);
}

void require_sound(const RoadResult& road) {
  require_finite({road.plane.height_m, road.plane.slope, road.plane.bank});
  for (const auto& probe : road.probes) require(probe.correlation >= -1.0 && probe.correlation <= 1.0);
}

template <class Item>
void require_nearest_first(const std::vector<Item>& items) {
  for (const auto& item : items) require_sound(item);
  require(std::ranges::is_sorted(items, std::less<>(), &Item::range_m));
}

}  // namespace

void require(bool ok) {
  if (!ok) std::abort();
}

void require_sound(const ImageBox& box) {
  require_finite({box.u_px, box.v_px, box.width_px, box.height_px});
  require(box.width_px >= 0.0 && box.height_px >= 0.0);
}

void require_sound(const Scan& scan) {
  const std::size_t count = scan.size();
  require(scan.ranges_m.size() == count && scan.free_m.size() == count && scan.confidence.size() == count);
  if (scan.empty()) return;
  require_finite({scan.angle_min_rad, scan.angle_increment_rad});
  require(scan.angle_increment_rad > 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    require_finite({scan.free_m[i]});
    require(scan.free_m[i] >= 0.0);
    require_share(scan.confidence[i]);
    if (scan.states[i] == SectorState::obstacle)
      require(std::isfinite(scan.ranges_m[i]) && scan.ranges_m[i] > 0.0);
    else
      require(std::isnan(scan.ranges_m[i]));
    if (scan.states[i] == SectorState::unknown) require(scan.confidence[i] == 0.0);
  }
}

void require_sound(const Detection& found) {
  require_nearest_first(found.obstacles);
  require_nearest_first(found.pedestrians);
  require_sound(found.scan);
  require_sound(found.road);
  for (const double time_ms : found.stage_ms) require(std::isfinite(time_ms) && time_ms >= 0.0);
  const auto& flies = found.evolved.flies;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    require_finite({flies.x_m[i], flies.y_m[i], flies.z_m[i], flies.fitness[i]});
    require(flies.fitness[i] >= 0.0F);
  }
  require_nearest_first(found.concentrate.obstacles);
  for (const auto& roi : found.rois) require_sound(roi);
  require(found.roi_scores.size() == found.rois.size());
  for (const double score : found.roi_scores) require_share(score);
}

}  // namespace flies::testing
