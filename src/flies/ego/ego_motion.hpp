#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A turn and then a shift: what takes points from one frame to another.
struct RigidMotion {
  std::array<std::array<double, 3>, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Point3 shift;

  Point3 operator()(const Point3& point) const;
  RigidMotion inverse() const;
};

struct EgoOptions {
  int corners = 400;
  bool half_resolution = true;
  int hypotheses = 60;
  double max_residual_px = 1.5;
  int min_agreeing = 20;
  double min_agreeing_share = 0.4;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("corners", self.corners, Range{30, 5000}, "corners followed from pair to pair");
    field("half_resolution", self.half_resolution,
          "follow the corners in images of half the size: quicker, less exact");
    field("hypotheses", self.hypotheses, Range{1, 1000}, "motions tried, each from three corners");
    field("max_residual_px", self.max_residual_px, Range{0.1, 20},
          "a corner agrees with a motion if it is this near the predicted place");
    field("min_agreeing", self.min_agreeing, Range{6, 1000},
          "the motion counts as lost if fewer corners than this agree");
    field("min_agreeing_share", self.min_agreeing_share, Range{0, 1},
          "the motion counts as lost if a smaller share of the corners agrees");
  }
};

/// How a corner of the left image moved over ground since the pair before.
struct CornerMotion {
  double u_px = 0.0, v_px = 0.0;      ///< in the left image now
  double x_m = 0.0, y_m = 0.0;        ///< now, vehicle frame
  double z_m = 0.0;                   ///< likewise
  double vx_mps = 0.0, vy_mps = 0.0;  ///< zero but for noise where it stands still
};

/// A shift of all disparities, as of cameras that are turned against each other a little or whose principal points are
/// not where the calibration has them.
struct DisparityShift {
  double px = 0.0;            ///< disparities are too small by this; negative: too large
  double deviation_px = 0.0;  ///< standard deviation
};

/// How the camera moved from the pair before to this one. Velocities are over ground, averaged over that time, in the
/// axes of the vehicle frame at this pair.
struct EgoMotion {
  bool is_known = false;              ///< false: the first pair, or lost; velocities are zero then
  double dt_s = 0.0;                  ///< time since the pair before
  RigidMotion current_from_previous;  ///< of points that stand still, vehicle frame
  double vx_mps = 0.0;                ///< forward
  double vy_mps = 0.0;                ///< to the left
  double yaw_rate_rps = 0.0;          ///< positive to the left
  /// Of (vx, vy, yaw rate), from the scatter of the corners about the motion.
  std::array<std::array<double, 3>, 3> covariance{};
  int followed = 0;  ///< corners found again in this pair
  int agreeing = 0;  ///< of those, on things that stand still by this motion
  /// By which the corners agree on their motion best; nothing where they do not tell it to half a pixel, as when the
  /// camera stands. One pair may be wrong by 2 px (most corners on things that move); see `DisparityShiftWatch`.
  std::optional<DisparityShift> disparity_shift;
  std::vector<CornerMotion> corners;  ///< those whose depth is known before and now; empty when given
};

/// Steps from pair to pair that motions are known for: no camera has a finer clock, and after more than a day, as when
/// a clock is set, nothing says how the camera moved.
inline constexpr double kLeastStep_s = 1e-9, kLongestStep_s = 86400.0;
/// What moves faster, an aircraft's camera or one that is shaken, has a wrong unit.
inline constexpr double kMostSpeed_mps = 400.0, kMostYawRate_rps = 100.0;

/// A known motion in the plane of the road (a wheel and yaw-rate sensor, or GPS/IMU) as an `EgoMotion`.
/// @param dt_s            `kLeastStep_s` to `kLongestStep_s`; 0 or less: the motion is not known
/// @param vx_mps, vy_mps  over ground at the vehicle origin, constant over the time in the turning frame; either within
///                        +-`kMostSpeed_mps`
/// @param yaw_rate_rps    within +-`kMostYawRate_rps`
/// @param standard_deviations of the three, 0 or more
/// @throws InputError naming what is no number or out of its range
EgoMotion given_ego_motion(double dt_s, double vx_mps, double vy_mps, double yaw_rate_rps,
                           const std::array<double, 3>& standard_deviations = {});

namespace detail {
/// @throws InputError naming `source` and what of a known motion is no number, out of the ranges above or no rotation
void check_ego_motion(const EgoMotion& ego, const std::string& source);
}  // namespace detail

/// Estimates the motion of the camera from pair to pair: corners get their depth from the pair, are followed into the
/// next left image (Lucas-Kanade), and the motion is the one under which most of them stand still (consensus of random
/// triples, then robust least squares of the reprojection). A function of the pairs so far. Threads: one at a time. One
/// that was moved from may be assigned to and destroyed; all else throws std::logic_error.
class EgoEstimator {
 public:
  /// @throws InputError when the camera or an option is out of range
  explicit EgoEstimator(const StereoCamera& camera, const EgoOptions& options = {});
  ~EgoEstimator();
  EgoEstimator(EgoEstimator&&) noexcept;
  EgoEstimator& operator=(EgoEstimator&&) noexcept;

  /// @param time_s of the pair, a nanosecond or more after the one before; the motion of a day or more is not known
  /// @throws InputError when the images are empty, differ in size or do not fit the camera, or time does not advance
  EgoMotion follow(const RectifiedPair& pair, double time_s);

  /// Passes over a pair whose motion another sensor knows: the pair after it has nothing to be compared with, so that
  /// its motion is unknown, and not that since the last pair that was followed.
  /// @throws InputError as `follow`
  void skip(const RectifiedPair& pair, double time_s);

  /// The same whatever the pair is.
  /// @throws InputError when time does not advance
  void skip(double time_s);

  /// Throws what `follow` would throw, and does no more.
  void check(const RectifiedPair& pair, double time_s) const;

  /// Throws what `skip(time_s)` would throw, and does no more.
  void check_time(double time_s) const;

  /// Of the last pair that was followed or skipped.
  std::optional<double> last_time_s() const;

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace flies
