#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "flies/core/fly.hpp"
#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/bearings.hpp"
#include "flies/eval/scan_truth.hpp"
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

/// How matched pixels become points to condense, and a scan.
struct DenseOptions {
  int step_px = 4;  ///< pictures of 1242 x 375 px then give some thousand points in the field, as there are flies
  int samples = 2;
  double min_score = 0.0035;
  double near_share = 0.75;
  int scan_points = 50;
  double scan_min_range_m = 3.5;
  double scan_gap_m = 0.1;
  double scan_gap_per_range = 0.04;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("step_px", self.step_px, Range{1, 64},
          "pixels this far apart, across and down, become points where they are matched");
    field("samples", self.samples, Range{1, 10},
          "minimum number of sample points per view-angle: points of equal weight hide far things behind near ones");
    field("min_score", self.min_score, Range{0, 1e12},
          "concentrate.assemble.min_score for dense points, which weigh 1, while fit flies weigh about 2");
    field("near_share", self.near_share, Range{0.1, 1},
          "disparities are searched to this part of field.x_min_m: what is nearer would match anything");
    field("scan_points", self.scan_points, Range{1, 10000},
          "matched pixels in a sector that are needed for an obstacle in its scan");
    field("scan_min_range_m", self.scan_min_range_m, Range{0, 100},
          "range of the nearest matched pixels that count, metres");
    field("scan_gap_m", self.scan_gap_m, Range{0, 10},
          "their ranges differ by at most this, metres, plus scan_gap_per_range times the range");
    field("scan_gap_per_range", self.scan_gap_per_range, Range{0, 1}, "this share of the range is added to scan_gap_m");
  }
};

/// Ranges of matched pixels by the sector that they lie in.
struct DenseRanges {
  Bearings bearings;
  std::vector<std::vector<double>> of_sector_m;  ///< in ascending order
};

/// The nearest range that `points` of a sector share, as a scan: where so many never do, the sector is free.
Scan dense_scan(const DenseRanges& ranges, int points, const DenseOptions& dense = {});

/// Matches the pair densely as `detect_densely` does.
/// @param near_m depth of the nearest thing that is looked for
/// @returns the disparity of every left pixel, row by row, NaN where there is none
/// @throws InputError when the images are empty, differ in size or do not fit the camera
std::vector<float> dense_disparity(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                                   double near_m);

/// What dense matching found in a pair.
struct DenseDetection {
  std::vector<Obstacle> obstacles;  ///< nearest first
  DenseRanges ranges;               ///< of all matched pixels that show what stands on the road
  std::size_t points = 0;           ///< matched points in the field of detection that were condensed
  double road_ms = 0.0;
  double match_ms = 0.0;
  double concentrate_ms = 0.0;
};

/// Matches the pair densely with the settings of a careful user: 5 x 5 blocks, penalties 8 and 32 per pixel of a block,
/// left-right check, 10 % uniqueness, speckles removed, all disparities of the field of detection. Every
/// `step_px`-th matched pixel of every such row becomes a fly of fitness 1, and those in the field are condensed
/// as the method's own flies are: same road, same field, same concentrating, so that only the matching differs. One
/// exception: every view-angle gives at least `samples` sample points. The images are continued to the left, so that
/// the first columns are matched too; pixels whose match lies in the continuation are dropped.
/// @param options the method's; its flies and its fitness are not used
/// @param dense   see there
/// @param standing what counts as standing on the road, for the ranges; `sector_deg` is the width of their sectors
/// @throws InputError when the images are empty, differ in size or do not fit the camera
DenseDetection detect_densely(const RectifiedPair& pair, const StereoCamera& camera, DenseMatcher matcher,
                              const DetectorOptions& options, const DenseOptions& dense = {},
                              const MatchOptions& standing = {}, double sector_deg = SectorOptions{}.increment_deg);

}  // namespace flies
