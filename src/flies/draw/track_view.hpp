#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "flies/draw/draw.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/track/tracks.hpp"

namespace flies {

/// What is shown of one pair.
struct TrackedPicture {
  cv::Mat left;  ///< CV_8UC1 or CV_8UC3
  double time_s = 0.0;
  EgoMotion ego;
  std::vector<Track> tracks;
  RoadScan scanned;  ///< its camera gives the field of view
};

/// Pictures of a sequence, all of one size: the left image with the boxes of the tracks, what is said of them below,
/// and the bird's-eye view beside it, where every track draws behind it where it has been over ground. People are
/// magenta, other things that move orange, what stands has the colour of its range.
class TrackView {
 public:
  explicit TrackView(double trail_s = 3.0) : trail_s_(trail_s) {}

  /// @returns CV_8UC3, BGR. Call it once a pair, in order: trails are moved by the camera's motion; when that is lost,
  ///          they end.
  cv::Mat draw(const TrackedPicture& picture);

  /// Where each track has been lately, the newest last; vehicle frame of the last pair.
  struct Step {
    double time_s = 0.0, x_m = 0.0, y_m = 0.0;
  };
  const std::map<std::uint64_t, std::vector<Step>>& trails() const { return trails_; }

 private:
  void follow(const TrackedPicture& picture);

  double trail_s_;
  std::map<std::uint64_t, std::vector<Step>> trails_;
};

}  // namespace flies
