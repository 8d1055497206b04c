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

}  // namespace

DetectorOptions preset_options(Preset preset) { return preset == Preset::paper ? paper_options() : DetectorOptions{}; }

Preset preset_named(std::string_view name, const std::string& source) {
  return static_cast<Preset>(detail::parse_name(name, EnumNames<Preset>::names, "--preset", source));
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
