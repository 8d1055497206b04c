#pragma once

#include <functional>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// What a few hundred textured patches of the left image say about the pair, each searched along its row of the right
/// image on both sides of infinity.
struct PairEvidence {
  int patches = 0;  ///< with enough texture to be searched and without rivals that fit as well
  int nearer = 0;   ///< found, at more disparity than infinity: in front of the cameras
  int beyond = 0;   ///< found, at less disparity than infinity: impossible unless left and right are swapped
  int distant = 0;  ///< found at infinity, within the noise
  /// How near the nearer places are (80th percentile of the disparity, infinity being 0) in the upper and in the lower
  /// third of the left image; 0 where fewer than ten were found.
  double upper_px = 0.0, lower_px = 0.0;

  /// Of the patches, those found on their row at or before infinity; 0.32 and more in good pairs of streets.
  double matched_share() const;
};

/// Takes a few milliseconds whatever the size of the images (they are reduced to about 600 columns).
/// @param pair both images of one size, at least 64 x 48 px
PairEvidence gather_pair_evidence(const RectifiedPair& pair, const StereoCamera& camera);

/// Who rectified a pair: what to doubt where hardly anything is found on its row.
enum class RectifiedBy {
  others,       ///< the images came as they are
  calibration,  ///< they came raw and were rectified with the calibration that is checked with them
};

/// Checks that the images are two views of one scene, rectified, left and right in place. Scenes without texture pass.
/// @throws InputError naming both images: not a pair, or swapped
void check_true_pair(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                     const std::string& right_name, RectifiedBy by = RectifiedBy::others);

/// How two images go together.
enum class PairOrder {
  good,       ///< or nothing can be said against it
  swapped,    ///< left and right
  unrelated,  ///< other scenes or moments, or not rectified
};

/// What `check_true_pair` would say, for every pair of a run: looks at one row of patches after the other and ends as
/// soon as these speak for the pair, after 0.2 ms in streets.
PairOrder order_of_pair(const RectifiedPair& pair, const StereoCamera& camera);

/// Which parts of the left image, side by side and equally wide, show something at more disparity than this: what is
/// nearer than who looks to the disparity expects. Some twenty patches are searched as far as half of the image
/// (a fraction of a millisecond), the others only where something so near was found with these.
/// @param pair both images of one size, at least 64 x 48 px
/// @param disparity_px column in the left less that in the right image, for a row: on the ground what is near is no
/// news
/// @returns one entry a part, from left to right; true where two places at least are that near
std::vector<bool> parts_nearer_than(const RectifiedPair& pair, const std::function<double(double v_px)>& disparity_px);

/// The disparity in a row of the left image from which on things stand on the road or hang above it, whatever their
/// column: a fifth more than the road's.
double nearer_than_road_px(const Projection& projection, const RoadPlane& road, int width_px, double v_px);

/// Only the second half of `check_true_pair`. @throws InputError when left and right seem to be swapped
void check_not_swapped(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                       const std::string& right_name);

}  // namespace flies
