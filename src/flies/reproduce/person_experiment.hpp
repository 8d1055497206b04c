#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/score.hpp"
#include "flies/pipeline/detector.hpp"

/// The paper's experiments on a person whose place is known (Li 2010, V, docs/reproduce.md).
namespace flies {

/// Where a person is known to stand, on the ground of the vehicle frame.
struct PersonPlace {
  std::string name;      ///< "Pedestrian 2"
  GroundPoint near;      ///< the near point: range of its near face, azimuth of the middle of its footprint
  GroundPoint middle;    ///< middle of its footprint
  double width_m = 0.0;  ///< across the line of sight
  double height_m = 0.0;
  /// Places where other things are known to be seen: fitness found there is right, though not the person's.
  std::vector<GroundPoint> others;

  double range_m() const;  ///< of the near point
};

struct PersonOptions {
  std::uint64_t first_seed = 1;
  int seeds = 5;  ///< runs, with seeds counting up from the first, > 0
  DetectorOptions method = preset_options(Preset::paper);
  MatchOptions match;  ///< when a fly or an obstacle is at a place
};

/// Where histogram sampling and mean shift put the person; x_m minus that of the near point, positive: too far.
struct LocalizationError {
  double sample_x_m = 0.0;   ///< of the fullest interval of the person's view-angle
  double shifted_x_m = 0.0;  ///< of the end of that sample point's mean shift, re-projected to the ground
};

/// One run with one seed. A value is missing when no fly, no sample point or no obstacle was there to give it.
struct PersonRun {
  std::uint64_t seed = 0;
  /// Root of the fitness-weighted mean of the squared ground distance to the near point, over the flies in the
  /// person's view-angle. Flies as they are spread at random, the same for both equations.
  std::optional<double> rms_louchet_m, rms_covariance_m;
  /// The same without the flies that are at others and not at the person.
  std::optional<double> rms_louchet_alone_m, rms_covariance_alone_m;
  std::optional<LocalizationError> spread;   ///< flies as they are spread, scored by the method's function
  std::optional<LocalizationError> evolved;  ///< flies after the method's generations
  /// Range of the obstacle nearest to the near point minus that of the near point, when it matches.
  std::optional<double> obstacle_range_m;
};

/// All runs, and the flies and histograms of the first.
struct PersonExperiment {
  PersonPlace person;
  std::vector<PersonRun> runs;
  Population louchet, covariance;  ///< the spread flies of the first seed, scored by Eq. (1) and by Eq. (2)
  HistogramAxis axis;
  ViewAngle louchet_view, covariance_view;  ///< the person's view-angle with its histogram
};

/// Repeats the paper's experiments on one person.
/// The person's view-angle is a view-angle of histogram sampling: all of them are turned, by at most half of one, so
/// that one is centred on the near point. The ground is taken as nominal, as in the paper.
/// @throws InputError when the camera or an option is out of range or the person stands outside all view-angles
PersonExperiment measure_person(const RectifiedPair& pair, const StereoCamera& camera, const PersonPlace& person,
                                const PersonOptions& options = {});

/// The flies of a view-angle, in their order.
Population flies_in_view(const Population& flies, const ViewAngle& view);

/// Root of the fitness-weighted mean squared ground distance from the flies to a point; nothing when no fly has
/// fitness.
std::optional<double> weighted_rms_distance_m(const Population& flies, const GroundPoint& point);

/// Median, smallest and largest of the values that are there.
struct Spread {
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
  std::size_t count = 0;
};
/// @returns nothing when no value is there. The median of an even number of values is the mean of the middle two.
std::optional<Spread> spread_of(std::span<const std::optional<double>> values);

}  // namespace flies
