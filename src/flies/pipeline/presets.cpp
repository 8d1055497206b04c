#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {
namespace {

/// Li, Toulminet, Nashashibi 2010, with Louchet's published settings where that text is silent. What it leaves open,
/// and what of ours is switched off here, is listed in docs/method.md.
DetectorOptions paper_options() {
  DetectorOptions o;
  o.field = {.x_min_m = 4.0, .x_max_m = 45.0, .y_min_m = -20.0, .y_max_m = 20.0, .z_min_m = 0.0, .z_max_m = 2.0};
  o.fitness.function = FitnessFunction::covariance;
  o.fitness.sampling = PatchSampling::nearest;
  o.fitness.row_step = 1;
  o.road.estimate = false;
  o.evolve.flies = 3000;
  o.evolve.generations = 3;
  o.evolve.initial = InitialDistribution::image;
  o.evolve.informative_gray = 0.0;
  o.evolve.scouts = 0;
  o.evolve.keep_share = 0.5;
  o.evolve.crossover_share = 0.2;
  o.evolve.immigration_share = 0.1;
  o.evolve.steering_share = 0.0;
  o.evolve.sharing = {.cell_px = 7, .strength = 1.0};
  o.evolve.mutation = {.image_px = 4.0, .disparity_px = 1.6, .cooling = 1.0};
  o.evolve.uniqueness.enforce = false;
  o.evolve.refine.share = 0.0;
  o.scan.enable = false;
  o.propose.heights = 3;
  o.propose.step = 2.0 / 12.0;
  o.propose.vertical_shifts = 0;
  o.concentrate.samples = 1;
  o.concentrate.min_density_share = 0.03;
  o.concentrate.assemble.position = ObstaclePosition::candidate;
  o.concentrate.assemble.merge = false;
  o.concentrate.assemble.min_extent_m = 0.0;
  o.concentrate.assemble.min_height_m = 0.0;
  o.concentrate.assemble.min_height_px = 0.0;
  o.concentrate.assemble.min_score = 0.0;
  o.concentrate.assemble.min_flies = 1;
  o.concentrate.whole.enable = false;
  return o;
}

/// Floors, table legs, shoes and cables: sizes of rooms instead of roads.
DetectorOptions robot_options() {
  DetectorOptions o;
  o.field = {.x_min_m = 0.3, .x_max_m = 12.0, .y_min_m = -6.0, .y_max_m = 6.0, .z_min_m = 0.03, .z_max_m = 1.6};
  o.road.x_min_m = 0.4;
  o.road.x_max_m = 8.0;
  o.road.half_width_m = 2.0;
  o.road.max_height_m = 0.1;
  o.scan.x_min_m = 0.3;
  o.scan.x_max_m = 30.0;
  o.scan.z_min_m = 0.05;
  o.scan.z_max_m = 1.6;
  o.scan.evidence.seen_through = 0.1;  // between the legs of tables and chairs much is seen that stands behind
  o.concentrate.samples = 3;
  o.concentrate.min_density_share = 0.002;
  o.concentrate.bin_m = 0.15;
  o.concentrate.assemble.min_score = 0.006;
  o.concentrate.assemble.lateral_gap_m = 0.15;
  o.concentrate.assemble.see_through_gap_m = 0.15;
  o.concentrate.assemble.max_width_m = 1.5;
  o.concentrate.assemble.max_surface_m = 1.5;
  o.concentrate.assemble.min_height_m = 0.05;
  o.concentrate.assemble.min_extent_m = 0.04;
  o.concentrate.whole = {.step_m = 0.1,
                         .step_share = 0.03,
                         .depth_m = 1.5,
                         .join_depth_m = 0.15,
                         .max_width_m = 4.0,
                         .gap_m = 0.1,
                         .min_new_width_m = 0.2,
                         .min_new_confidence = 0.9,
                         .max_new_range_m = 8.0};
  return o;
}

/// What a walker, a hand or a drone before trees sees: steep ground, things of all sizes.
DetectorOptions handheld_options() {
  DetectorOptions o = robot_options();
  o.field = {.x_min_m = 0.3, .x_max_m = 20.0, .y_min_m = -10.0, .y_max_m = 10.0, .z_min_m = 0.15, .z_max_m = 3.0};
  o.road.x_max_m = 12.0;
  o.road.max_slope = 0.2;
  o.road.max_bank = 0.15;
  o.road.max_height_m = 0.2;
  o.scan.x_max_m = 60.0;
  o.scan.z_min_m = 0.2;
  o.scan.z_max_m = 2.5;
  o.concentrate.bin_m = 0.25;
  o.concentrate.assemble.lateral_gap_m = 0.5;
  o.concentrate.assemble.max_surface_m = 3.0;
  o.concentrate.assemble.min_height_m = 0.2;
  o.concentrate.assemble.min_extent_m = 0.1;
  o.concentrate.whole.join_depth_m = 0.3;
  o.concentrate.whole.max_new_range_m = 12.0;
  return o;
}

/// The interval of its own width with the camera in the middle.
void centre_on(double height_m, double& z_min_m, double& z_max_m) {
  const double half_m = 0.5 * (z_max_m - z_min_m);
  z_min_m = height_m - half_m;
  z_max_m = height_m + half_m;
}

/// A camera that looks over the top of the field in its nearer half, as a drone before trees does, wants to know what
/// is at its own height.
void lift_to_camera(const StereoCamera& camera, double lower_edge_rad, DetectorOptions& options) {
  constexpr double kHighest_m = 20.0, kHighestBody_m = 10.0;  // that the options can say
  auto& field = options.field;
  const double height_m = camera.mount.height_m, middle_m = std::sqrt(field.x_min_m * field.x_max_m);
  const double lowest_seen_m = height_m - middle_m * std::tan(std::clamp(lower_edge_rad, 0.0, 1.5));
  const bool is_over_it = camera.height_px > 0 && lowest_seen_m > field.z_max_m;
  if (!is_over_it || height_m + field.z_max_m > kHighest_m) return;
  centre_on(height_m, field.z_min_m, field.z_max_m);
  centre_on(height_m, options.scan.z_min_m, options.scan.z_max_m);
  options.scan.top_m = options.scan.z_max_m;
  options.scan.evidence.body_height_m = std::min(options.scan.z_max_m, kHighestBody_m);
}

}  // namespace

DetectorOptions preset_options(Preset preset) {
  switch (preset) {
    case Preset::paper:
      return paper_options();
    case Preset::robot:
      return robot_options();
    case Preset::handheld:
      return handheld_options();
    case Preset::standard:
      break;
  }
  return {};
}

DetectorOptions fitted_options(const StereoCamera& camera, DetectorOptions options) {
  constexpr double kLeastRange_m = 0.3;
  constexpr double kNearestDisparityShare = 0.35;  // of the width
  constexpr double kBeforeTheRoad = 0.7;           // things are seen nearer than the road below them
  constexpr double kHalfHidden =
      0.4;  // nearer, more than the lower half of what is as high as the camera is out of view
  constexpr double kNearestOfCars_m = 4.0;
  constexpr double kWorstDeviation = 0.15;   // of a range
  constexpr double kFlattestRoad_px = 40.0;  // below the horizon
  constexpr double kScanBefore = 0.875, kLatestScan_m = 3.5;
  constexpr double kNever_m = 1e6;
  constexpr double kWidestField_deg = 89.0;
  const double scale = camera.fx_px * camera.baseline_m;
  const double lower_edge_rad =
      camera.mount.pitch_rad + std::atan((camera.height_px - 1 - camera.cy_px) / camera.fy_px);
  const double road_m = camera.height_px > 0 && lower_edge_rad > 0.0
                            ? camera.mount.height_m / std::tan(std::min(lower_edge_rad, 1.5))
                            : kNever_m;
  const double both_m = camera.width_px > 0 ? scale / (kNearestDisparityShare * camera.width_px) : 0.0;
  const bool sees_road = road_m < kNever_m;
  const double near_m = std::max({kLeastRange_m, both_m, sees_road ? kBeforeTheRoad * road_m : 0.0});
  const double far_m = std::max(range_of_deviation_m(camera, kWorstDeviation), 4.0 * near_m);

  lift_to_camera(camera, lower_edge_rad, options);
  auto& field = options.field;
  const double before = std::log(field.x_max_m / field.x_min_m);
  if (sees_road) field.x_min_m = std::max(std::min(field.x_min_m, near_m), kHalfHidden * road_m);
  field.x_min_m = std::max(field.x_min_m, both_m);
  field.x_min_m = std::min(field.x_min_m, kNearestOfCars_m);
  field.x_max_m = std::max(std::min(field.x_max_m, far_m), 2.0 * field.x_min_m);
  // Flies are spread evenly over the logarithm of the range: as many as before for each piece of it.
  if (const double now = std::log(field.x_max_m / field.x_min_m); now > before)
    options.evolve.flies = static_cast<int>(std::lround(options.evolve.flies * now / before));
  // Matching far more disparities than the scene has makes the scan blind.
  if (sees_road) options.scan.x_min_m = std::clamp(kScanBefore * near_m, 0.2, kLatestScan_m);
  if (camera.width_px > 0) {
    // In whole view-angles, which would else end before the field does.
    const double widest_px = std::max(camera.cx_px, camera.width_px - 1 - camera.cx_px);
    const double half_angle_deg = 0.5 * options.concentrate.view_angle_deg;
    const double half_deg = half_angle_deg * std::ceil(degrees(std::atan(widest_px / camera.fx_px)) / half_angle_deg);
    options.concentrate.half_field_deg =
        std::max(options.concentrate.half_field_deg, std::min(half_deg, kWidestField_deg));
  }

  auto& road = options.road;
  road.x_min_m = std::min(road.x_min_m, std::max(kLeastRange_m, road_m));
  const double flat_m = camera.fy_px * camera.mount.height_m / kFlattestRoad_px;
  road.x_max_m = std::max(std::min({road.x_max_m, flat_m, far_m}), 2.5 * road.x_min_m);
  road.half_width_m = std::min(road.half_width_m, 0.3 * road.x_max_m);
  return options;
}

Preset preset_named(std::string_view name, const std::string& source) {
  return static_cast<Preset>(detail::parse_name(name, EnumNames<Preset>::names, "preset", source));
}

void check_detector_options(const DetectorOptions& options, const std::string& source) {
  check_options(options, source);
  check_field(options.field, source);
  check_evolve_options(options.evolve, source);
  check_propose_options(options.propose, source);
  check_road_options(options.road, source);
  check_scan_options(options.scan, source);
}

}  // namespace flies
