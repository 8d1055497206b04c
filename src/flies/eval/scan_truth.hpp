#pragma once

#include <vector>

#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/bearings.hpp"
#include "flies/eval/score.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

/// Which sectors of a scan are judged and what their truth is made of. What stands on the road, and when ranges agree,
/// `MatchOptions` say.
struct SectorOptions {
  double increment_deg = 0.5;
  double min_range_m = 4.0;
  double max_range_m = 30.0;
  double near_range_m = 15.0;
  double open_range_m = 40.0;
  double margin_px = 8.0;
  int lidar_points = 2;
  double lidar_gap_m = 0.5;
  int map_points = 8;
  double map_gap_m = 0.3;
  double gap_per_range = 0.02;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("increment_deg", self.increment_deg, Range{0.05, 10}, "width of a sector of the scan, degrees");
    field("min_range_m", self.min_range_m, Range{0, 1000}, "nearest things whose sectors are judged, metres");
    field("max_range_m", self.max_range_m, Range{0, 1000},
          "farthest things whose sectors are judged, metres; in open sectors, reports nearer than this are ghosts");
    field("near_range_m", self.near_range_m, Range{0, 1000},
          "blind sectors nearer than this are also counted separately, metres");
    field("open_range_m", self.open_range_m, Range{0, 1000},
          "a sector is open when nothing stands nearer than this, metres");
    field("margin_px", self.margin_px, Range{0, 1000},
          "a place counts when both images show it this far inside their borders, pixels");
    field("lidar_points", self.lidar_points, Range{1, 1000}, "lidar returns in a sector that are needed for a thing");
    field("lidar_gap_m", self.lidar_gap_m, Range{0, 10},
          "their ranges differ by at most this, metres, plus gap_per_range times the range");
    field("map_points", self.map_points, Range{1, 10000},
          "points of a disparity map in a sector that are needed for a thing");
    field("map_gap_m", self.map_gap_m, Range{0, 10},
          "their ranges differ by at most this, metres, plus gap_per_range times the range");
    field("gap_per_range", self.gap_per_range, Range{0, 1},
          "this share of the range is added to lidar_gap_m and map_gap_m");
  }
};

/// What a sector is good for.
enum class TrueSector {
  ignored,  ///< the truth does not cover it, or what stands there is too near, too far or seen by one camera alone
  counted,  ///< something stands there, to be found
  open,     ///< nothing stands nearer than `open_range_m`
};

/// What a perfect scan of a pair would say.
struct ScanTruth {
  Bearings bearings;
  std::vector<double> ranges_m;   ///< infinity where nothing stands, NaN where the truth does not cover the sector
  std::vector<TrueSector> kinds;  ///< one a sector
};

/// The nearest range in every sector that enough points on the road's obstacles share: points of the disparity map
/// where there is one, else lidar returns. A sector with less than twice as many points, of any height, is not
/// covered. Empty where there is neither map nor lidar.
ScanTruth scan_truth(const FrameTruth& truth, const StereoCamera& camera, const MatchOptions& match = {},
                     const SectorOptions& options = {});

}  // namespace flies
