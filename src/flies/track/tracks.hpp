#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/track/kalman.hpp"

namespace flies {

struct TrackOptions {
  double disparity_sd_px = 0.7;
  double along_sd_m = 0.45;
  double across_sd_m = 0.25;
  double across_sd_share = 0.3;
  double common_sd_share = 0.6;
  double acceleration_mps2 = 3.0;
  double person_acceleration_mps2 = 2.5;
  double start_speed_mps = 2.0;
  double moving_prior = 0.1;
  double person_moving_prior = 0.8;
  int moving_sightings = 3;
  double gate = 9.0;
  double corner_disparity_sd_px = 0.5;
  double corner_velocity_sd_mps = 0.2;
  int min_corners = 2;
  double first_probability = 0.7;
  double seen_odds = 10.0;
  double detection_probability = 0.8;
  double hidden_detection_probability = 0.1;
  double min_probability = 0.3;
  double max_coast_s = 2.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("disparity_sd_px", self.disparity_sd_px, Range{0.01, 10},
          "standard deviation of an obstacle's disparity, from which that of its range follows");
    field("along_sd_m", self.along_sd_m, Range{0.01, 5},
          "standard deviation of an obstacle's range, in addition to that of its disparity");
    field("across_sd_m", self.across_sd_m, Range{0.01, 5},
          "standard deviation of an obstacle's middle across the line of sight");
    field("across_sd_share", self.across_sd_share, Range{0, 1}, "the same, as a share of the obstacle's width");
    field("common_sd_share", self.common_sd_share, Range{0, 10},
          "share of these deviations that is common to all sightings of a thing, so that it does not average out");
    field("acceleration_mps2", self.acceleration_mps2, Range{0.01, 50},
          "standard deviation of the acceleration of things");
    field("person_acceleration_mps2", self.person_acceleration_mps2, Range{0.01, 50}, "the same for people");
    field("start_speed_mps", self.start_speed_mps, Range{0.1, 50}, "standard deviation of a new thing's velocity");
    field("moving_prior", self.moving_prior, Range{0.001, 0.999}, "share of things that move, as assumed beforehand");
    field("person_moving_prior", self.person_moving_prior, Range{0.001, 0.999}, "the same for people");
    field("moving_sightings", self.moving_sightings, Range{1, 100},
          "a thing is reported as moving when it seems to move this many times in a row");
    field("gate", self.gate, Range{1, 100},
          "squared Mahalanobis distance from which a sighting belongs to another thing");
    field("corner_disparity_sd_px", self.corner_disparity_sd_px, Range{0.01, 10},
          "standard deviation of the disparity of one corner, from which that of its velocity follows");
    field("corner_velocity_sd_mps", self.corner_velocity_sd_mps, Range{0.01, 10},
          "standard deviation of a velocity from many corners");
    field("min_corners", self.min_corners, Range{1, 1000}, "corners needed on a thing to measure its velocity");
    field("first_probability", self.first_probability, Range{0.01, 0.98}, "probability that a thing seen once exists");
    field("seen_odds", self.seen_odds, Range{1, 1000}, "seeing the thing again multiplies its odds by this");
    field("detection_probability", self.detection_probability, Range{0.01, 0.99},
          "probability that a thing in view is seen");
    field("hidden_detection_probability", self.hidden_detection_probability, Range{0.0, 0.99},
          "the same for a thing behind something nearer");
    field("min_probability", self.min_probability, Range{0.0, 0.98},
          "tracks less probable than this are not reported; those below 0.3 end");
    field("max_coast_s", self.max_coast_s, Range{0, 60}, "a track that is not seen for longer than this ends");
  }
};

/// What a detector saw of one thing in one pair: a measurement, in the words of the literature on tracking.
struct Sighting {
  double x_m = 0.0, y_m = 0.0;
  double width_m = 0.0, height_m = 0.0;
  ImageBox box;
  std::optional<double> person_probability;  ///< of the classifier; none: it did not call it a person
};

/// Obstacles and people of one pair as sightings: a person belongs to the obstacle where he stands, or is one himself.
std::vector<Sighting> sightings_of(std::span<const Obstacle> obstacles, std::span<const Pedestrian> people);

enum class TrackClass { other, person };
template <>
struct EnumNames<TrackClass> {
  static constexpr std::array<std::string_view, 2> names = {"other", "person"};
};

/// A thing followed over time.
struct Track {
  std::uint64_t id = 0;  ///< counts from 1, never given twice
  TrackClass kind = TrackClass::other;
  double person_log_odds = 0.0;  ///< evidence of all pairs
  double probability = 0.0;      ///< that it exists
  GroundState state;             ///< vehicle frame of now; with the error common to all sightings
  LikelyVelocity velocity;       ///< over ground, as reported: zero until it has seemed to move for several pairs
  double width_m = 0.0, height_m = 0.0;
  double age_s = 0.0;     ///< since it was first seen
  double unseen_s = 0.0;  ///< since it was last seen; 0: in this pair
  int sightings = 0;
  int moving_sightings = 0;  ///< the last so many in a row, where it seemed to move
  ImageBox box;              ///< in the left image; of the sighting, or where it should be
};

/// Follows things from pair to pair: constant velocity over ground, optimal assignment, a probability that each exists.
/// Tracks that nobody sees coast on; behind something nearer they do so for long. After a step of more than 2 s only
/// what went on as it was, standing or known to move, is taken for the same; all else starts anew. When the camera's
/// motion is lost (also at a cut) all tracks end, because nothing says where they went. Threads: one at a time.
class TrackKeeper {
 public:
  /// @throws InputError when the camera or an option is out of range
  explicit TrackKeeper(const StereoCamera& camera, const TrackOptions& options = {});

  /// @param ego      the motion since the call before; unknown at the first
  /// @param sightings vehicle frame of now; those with a number that is not finite are passed over
  /// @param road     on which things stand now
  /// @returns the tracks to report, nearest first
  std::vector<Track> step(const EgoMotion& ego, std::span<const Sighting> sightings, const RoadPlane& road = {});

 private:
  GroundPosition measured(const Sighting& sighting) const;
  Track reported(const Track& track) const;
  /// @returns where each track is looked for: where it is predicted, and after a long step where it went on as before
  std::vector<GroundState> predict_all(const EgoMotion& ego);
  /// @returns the sighting of each track, -1 where it has none
  std::vector<int> assign(std::span<const GroundState> expected, std::span<const Sighting> sightings) const;
  bool is_known_to_move(const Track& track) const;
  /// @param dt_s of this step: no track coasts through a long one
  bool has_ended(const Track& track, double dt_s) const;
  /// Above the road, between its foot and its head.
  Point3 point_on(const Track& track, double share_of_height) const;
  bool is_in_view(const Track& track) const;
  /// Nothing where it reaches behind the camera.
  std::optional<ImageBox> predicted_box(const Track& track) const;
  std::optional<GroundVelocity> velocity_of(const Sighting& sighting, const EgoMotion& ego) const;
  void see(Track& track, const Sighting& sighting, const EgoMotion& ego) const;
  void miss(Track& track, std::span<const Sighting> sightings) const;
  Track start(const Sighting& sighting, const EgoMotion& ego);
  void judge_motion(Track& track) const;
  void join_doubles();

  StereoCamera camera_;
  Projection projection_;
  TrackOptions options_;
  RoadPlane road_;
  std::vector<Track> tracks_;
  std::uint64_t next_id_ = 1;
};

}  // namespace flies
