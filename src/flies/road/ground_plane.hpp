#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "flies/core/stereo_camera.hpp"

namespace flies {

/// A place of the left image whose distance is known, as the camera sees it, free of any mount.
struct SeenPlace {
  double across = 0.0;       ///< of its line of sight at depth 1, to the right: (u - cx) / fx
  double down = 0.0;         ///< the same downwards: (v - cy) / fy
  double parallax_px = 0.0;  ///< disparity less that of infinity
};

/// Places of one pair, with what of the camera they depend on.
struct SeenPlaces {
  double fy_px = 0.0;
  double scale_px_m = 0.0;  ///< focal length times baseline: parallax times depth
  std::vector<SeenPlace> places;
};

/// A plane below the camera. Parallax grows linearly over the image of a plane: it is
/// across * place.across + down * place.down + ahead.
struct GroundPlane {
  double across_px = 0.0, down_px = 0.0, ahead_px = 0.0;

  double parallax_px(const SeenPlace& place) const {
    return across_px * place.across + down_px * place.down + ahead_px;
  }
};

/// How a camera is mounted above a plane.
/// @param scale_px_m as in SeenPlaces
CameraMount mount_above(const GroundPlane& plane, double scale_px_m);

/// The inverse of `mount_above`.
GroundPlane plane_below(const CameraMount& mount, double scale_px_m);

/// Mounts that are looked for.
struct MountLimits {
  double min_height_m = 0.15, max_height_m = 5.0;
  double min_pitch_rad = radians(-20.0), max_pitch_rad = radians(35.0);
  double min_roll_rad = radians(-15.0), max_roll_rad = radians(15.0);

  bool allow(const CameraMount& mount) const;
};

/// A plane and how well the places agree with it.
struct SupportedPlane {
  GroundPlane plane;
  double support = 0.0;
};

/// Places on the plane less those below it, and less the more the farther off: below the ground there is nothing, above
/// it there are obstacles.
double ground_support(const SeenPlaces& seen, const GroundPlane& plane);

/// The best supported plane within the limits: RANSAC (Fischler and Bolles 1981) over three places at a time, the good
/// ones refined by weighted least squares. Deterministic.
/// @param first tried before any others
/// @returns nothing when no plane within the limits has support
std::optional<SupportedPlane> fit_ground(const SeenPlaces& seen, const MountLimits& limits,
                                         std::span<const GroundPlane> first = {});

/// How many times as far away as the nearest places on a plane the farthest are, but for a tenth of either: 1 for a
/// wall that the plane only cuts, 1.5 and more for ground.
double depth_ratio_on(const SeenPlaces& seen, const GroundPlane& plane);

/// Standard deviations of a mount, as the scatter of the places on its plane leaves them.
struct MountDeviation {
  double height_share = 1.0;  ///< of the height
  double pitch_rad = 1.0, roll_rad = 1.0;
};
MountDeviation mount_deviation(const SeenPlaces& seen, const GroundPlane& plane);

}  // namespace flies
