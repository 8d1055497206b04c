#pragma once

#include <optional>
#include <span>
#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// What the ground in some pairs says about how the camera is mounted.
struct MountFinding {
  CameraMount told;             ///< what the camera said
  CameraMount mount;            ///< what to use: as told, unless the ground clearly lies elsewhere
  bool is_replaced = false;     ///< the ground lies elsewhere, and `mount` is where it is seen
  bool is_confirmed = false;    ///< the ground was seen where it was told to be
  bool is_upside_down = false;  ///< the ground lies above the camera: both images stand on their heads
  double baseline_m = 0.0;      ///< of the camera, as told
  double scale_px_m = 0.0;      ///< focal length times baseline: disparity times depth
  /// Where the ground was seen as told: by how much it rises ahead, the median of the pairs. A camera that looks down
  /// by as much sees the same.
  double slope = 0.0;
  /// Disparity less that of infinity, of which hardly any place that was matched has less (one in fifty); 0 where not
  /// looked for.
  double farthest_px = 0.0;
  /// Where no ground was seen at the heights that are looked for: that of one which lies deeper, as where the baseline
  /// is too large; 0 for none.
  double deep_ground_m = 0.0;
  double ground_share = 0.0;  ///< of the places that could be matched, those that lie on the ground, net of those below

  /// By how much more disparity the ground has than it is told to have, all over the images: where the camera looks
  /// farther down, and where a principal point is wrong.
  double rise_px() const;
};

/// Of a rise that is less, a principal point is not doubted: half a degree to a degree and more of many cameras.
inline constexpr double kDoubtfulRise_px = 3.0;

/// Finds height, pitch and roll of the camera above the ground that the pairs show. Where the road is seen as the
/// mount says, that is all, and takes about a millisecond a pair (and some 0.1 s more where it rises so that a
/// principal point may be wrong); otherwise all of the images is matched (at half of their size where that shows the
/// ground more clearly) and the plane that has most places on it and fewest below is looked for (some 0.1 s a pair):
/// heights of 0.15 to 3.6 m, pitches of -20 to 35 degrees, rolls of up to 15. Meant for the first pairs of a run, not
/// for each.
/// @param pairs of one camera, of the size it is calibrated for; five are plenty, one can do
/// @throws InputError when an image is empty or those of a pair differ in size
MountFinding find_mount(std::span<const RectifiedPair> pairs, const StereoCamera& camera);

/// How a camera is tilted: "3.1 degrees down, 0.5 to the left".
std::string tilt_words(const CameraMount& mount);

/// What to tell the user: nothing when the mount is as told.
std::optional<std::string> mount_note(const MountFinding& finding);

}  // namespace flies
