#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {
namespace {

/// Li, Toulminet, Nashashibi 2010. What the text leaves open is set to the plainest choice, see docs/method.md.
DetectorOptions paper_options() {
  DetectorOptions options;
  options.field.z_min_m = 0.0;
  options.field.z_max_m = 2.0;
  options.fitness.function = FitnessFunction::covariance;
  options.fitness.sampling = PatchSampling::nearest;
  options.road.estimate = false;
  options.evolve.flies = 3000;
  options.evolve.generations = 3;
  options.concentrate.samples = 1;
  options.concentrate.assemble.merge = false;
  options.concentrate.assemble.near_quantile = 0.5;
  return options;
}

}  // namespace

DetectorOptions preset_options(Preset preset) { return preset == Preset::paper ? paper_options() : DetectorOptions{}; }

void check_detector_options(const DetectorOptions& options, const std::string& source) {
  check_options(options, source);
  check_field(options.field, source);
  check_evolve_options(options.evolve, source);
}

}  // namespace flies
