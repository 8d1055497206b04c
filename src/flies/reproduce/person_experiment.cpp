#include "flies/reproduce/person_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/evolve/evolve.hpp"
#include "flies/fitness/fitness.hpp"

namespace flies {
namespace {

double distance_m(const GroundPoint& a, const GroundPoint& b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

/// Everything a run needs that does not depend on its seed.
struct Setting {
  const RectifiedPair& pair;
  const PersonPlace& person;
  PersonOptions options;
  Projection projection;
  RoadPlane road;        // nominal, as in the paper
  std::size_t view = 0;  // index of the person's view-angle
};

/// The options with the view-angles turned, by at most half of one, so that one is centred on the person: whether two
/// of them happen to share the person is no property of the method.
PersonOptions centred(PersonOptions options, const PersonPlace& person) {
  auto& concentrating = options.method.concentrate;
  const double half_deg = concentrating.half_field_deg, width_deg = concentrating.view_angle_deg;
  const double azimuth_deg = degrees(std::atan2(person.near.y_m, person.near.x_m));
  const double angles_to_centre = (azimuth_deg + half_deg) / width_deg - 0.5;
  concentrating.half_field_deg += width_deg * (std::round(angles_to_centre) - angles_to_centre);
  return options;
}

std::size_t view_of(const PersonPlace& person, const DetectorOptions& method) {
  const double azimuth_rad = std::atan2(person.near.y_m, person.near.x_m);
  const auto views = sample_histograms({}, method.field, method.concentrate).view_angles;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (azimuth_rad >= views[i].min_azimuth_rad && azimuth_rad < views[i].max_azimuth_rad) return i;
  throw InputError(person.name, "azimuth",
                   fmt::format("found {:.1f} degrees, which no view-angle covers; they reach {:g} to each side",
                               degrees(azimuth_rad), method.concentrate.half_field_deg));
}

Population spread_flies(const Setting& s, std::uint64_t seed, FitnessFunction function) {
  FitnessOptions fitness = s.options.method.fitness;
  fitness.function = function;
  EvolveOptions evolution = s.options.method.evolve;
  evolution.generations = 0;
  evolution.steering_share = 0.0;
  evolution.refine.share = 0.0;
  return evolve(s.pair, s.projection, s.road, s.options.method.field, fitness, evolution, {seed, 0}).flies;
}

/// True when enough known returns of other things lie near the fly and it is not near the person (docs/evaluation.md).
bool is_at_others(const Setting& s, const GroundPoint& fly) {
  const double radius_m = s.options.match.radius_at_m(std::hypot(fly.x_m, fly.y_m));
  if (distance_m(fly, s.person.near) <= radius_m) return false;
  return std::count_if(s.person.others.begin(), s.person.others.end(), [&](const GroundPoint& other) {
           return distance_m(fly, other) <= radius_m;
         }) >= s.options.match.min_lidar_points;
}

Population without_others(const Setting& s, const Population& flies) {
  Population alone;
  for (std::size_t i = 0; i < flies.size(); ++i)
    if (!is_at_others(s, {flies.x_m[i], flies.y_m[i]})) alone.push_back(flies.point(i), flies.fitness[i]);
  return alone;
}

/// Place of the first sample point of a view-angle in the list of all.
std::size_t first_sample(const ConcentrateResult& result, std::size_t view) {
  std::size_t index = 0;
  for (std::size_t i = 0; i < view; ++i) index += result.view_angles[i].samples.size();
  return index;
}

std::optional<LocalizationError> localize(const Setting& s, const ConcentrateResult& result) {
  const auto& samples = result.view_angles[s.view].samples;
  if (samples.empty()) return std::nullopt;
  const PixelPoint& end = result.shifted[first_sample(result, s.view)].end;
  const Point3 shifted = s.projection.meet_road(end.u_px, end.v_px, s.road);
  return LocalizationError{samples[0].x_m - s.person.near.x_m, shifted.x_m - s.person.near.x_m};
}

std::optional<double> obstacle_range_error(const Setting& s, const std::vector<Obstacle>& obstacles) {
  const auto distance = [&](const Obstacle& o) { return distance_m({o.x_m, o.y_m}, s.person.near); };
  const auto nearest = std::min_element(obstacles.begin(), obstacles.end(),
                                        [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  if (nearest == obstacles.end() || distance(*nearest) > s.options.match.radius_at_m(nearest->range_m))
    return std::nullopt;
  return nearest->range_m - s.person.range_m();
}

ConcentrateResult concentrate_flies(const Setting& s, const Population& flies) {
  return concentrate(flies, s.projection, s.road, s.options.method.field, s.options.method.concentrate);
}

/// The first experiment: how far from the person each equation puts fitness.
void measure_fitness(const Setting& s, PersonExperiment& experiment, PersonRun& run) {
  const auto& method = s.options.method;
  const auto view_after = [&](const Population& flies) {
    const auto sampling = sample_histograms(flies, method.field, method.concentrate);
    experiment.axis = sampling.axis;
    return sampling.view_angles[s.view];
  };
  auto louchet = spread_flies(s, run.seed, FitnessFunction::louchet);
  auto covariance = spread_flies(s, run.seed, FitnessFunction::covariance);
  auto louchet_view = view_after(louchet), covariance_view = view_after(covariance);

  const auto seen_louchet = flies_in_view(louchet, louchet_view);
  const auto seen_covariance = flies_in_view(covariance, covariance_view);
  run.rms_louchet_m = weighted_rms_distance_m(seen_louchet, s.person.near);
  run.rms_covariance_m = weighted_rms_distance_m(seen_covariance, s.person.near);
  run.rms_louchet_alone_m = weighted_rms_distance_m(without_others(s, seen_louchet), s.person.near);
  run.rms_covariance_alone_m = weighted_rms_distance_m(without_others(s, seen_covariance), s.person.near);
  if (run.seed != s.options.first_seed) return;
  experiment.louchet = std::move(louchet);
  experiment.covariance = std::move(covariance);
  experiment.louchet_view = std::move(louchet_view);
  experiment.covariance_view = std::move(covariance_view);
}

/// The second experiment: where histogram sampling and mean shift put the person.
void measure_position(const Setting& s, PersonRun& run) {
  const auto& method = s.options.method;
  run.spread = localize(s, concentrate_flies(s, spread_flies(s, run.seed, method.fitness.function)));
  const auto evolved = evolve(s.pair, s.projection, s.road, method.field, method.fitness, method.evolve, {run.seed, 0});
  const auto concentrated = concentrate_flies(s, evolved.flies);
  run.evolved = localize(s, concentrated);
  run.obstacle_range_m = obstacle_range_error(s, concentrated.obstacles);
}

}  // namespace

double PersonPlace::range_m() const { return std::hypot(near.x_m, near.y_m); }

PersonExperiment measure_person(const RectifiedPair& pair, const StereoCamera& camera, const PersonPlace& person,
                                const PersonOptions& options) {
  check_pair(pair);
  check_camera(camera, "camera");
  check_camera_fits(camera, pair.left.width_px, pair.left.height_px, "camera");
  check_detector_options(options.method, "options");
  if (options.seeds < 1)
    throw InputError("options", "seeds", fmt::format("found {}, expected 1 or more", options.seeds));

  const PersonOptions turned = centred(options, person);
  const Setting setting{pair, person, turned, Projection(camera), {}, view_of(person, turned.method)};
  PersonExperiment experiment;
  experiment.person = person;
  for (int i = 0; i < options.seeds; ++i) {
    PersonRun run;
    run.seed = options.first_seed + static_cast<std::uint64_t>(i);
    measure_fitness(setting, experiment, run);
    measure_position(setting, run);
    experiment.runs.push_back(run);
  }
  return experiment;
}

Population flies_in_view(const Population& flies, const ViewAngle& view) {
  Population inside;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const double azimuth_rad = std::atan2(flies.y_m[i], flies.x_m[i]);
    if (azimuth_rad >= view.min_azimuth_rad && azimuth_rad < view.max_azimuth_rad)
      inside.push_back(flies.point(i), flies.fitness[i]);
  }
  return inside;
}

std::optional<double> weighted_rms_distance_m(const Population& flies, const GroundPoint& point) {
  double votes = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const double d = distance_m({flies.x_m[i], flies.y_m[i]}, point);
    votes += flies.fitness[i];
    sum += flies.fitness[i] * d * d;
  }
  if (!(votes > 0.0)) return std::nullopt;
  return std::sqrt(sum / votes);
}

std::optional<Spread> spread_of(std::span<const std::optional<double>> values) {
  std::vector<double> present;
  for (const auto& value : values)
    if (value) present.push_back(*value);
  if (present.empty()) return std::nullopt;
  const auto [least, most] = std::ranges::minmax(present);
  return Spread{*median(present), least, most, present.size()};
}

}  // namespace flies
