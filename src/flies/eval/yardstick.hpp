#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {

/// Dense matchers that the flies are held against: OpenCV's semi-global block matching.
enum class DenseMatcher {
  sgbm,       ///< five directions
  sgbm_3way,  ///< three directions, faster
};
template <>
struct EnumNames<DenseMatcher> {
  static constexpr std::array<std::string_view, 2> names = {"sgbm", "sgbm-3way"};
};

/// What dense matching found in a pair.
struct DenseDetection {
  std::vector<Obstacle> obstacles;  ///< nearest first
  std::size_t points = 0;           ///< matched points in the field of detection that were condensed
  double road_ms = 0.0;
  double match_ms = 0.0;
  double concentrate_ms = 0.0;
};

/// Matches the pair densely with the settings of a careful user: 5 x 5 blocks, penalties 8 and 32 per pixel of a block,
/// left-right check, 10 % uniqueness, speckles removed, all disparities of the field of detection. Every
/// `kDenseStep_px`-th matched pixel of every such row becomes a fly of fitness 1, and those in the field are condensed
/// as the method's own flies are: same road, same field, same concentrating, so that only the matching differs. One
/// exception: every view-angle gives at least `kDenseSamples` sample points, see there.
/// @param options the method's; its flies and its fitness are not used
/// @throws InputError when the images are empty, differ in size or do not fit the camera
DenseDetection detect_densely(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                              const DetectorOptions& options);

/// A quarter of the pixels each way: the 1242 x 375 pictures of KITTI give some 5000 points in the field, as many as
/// there are flies.
inline constexpr int kDenseStep_px = 4;

/// Points of equal weight tell the strong from the weak by their number alone, and a near thing outnumbers a far one
/// in its view-angle; with a single sample point the yardstick would miss one object in six for no fault of its own.
inline constexpr int kDenseSamples = 2;

}  // namespace flies
