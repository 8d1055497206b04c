#pragma once

#include <opencv2/core/mat.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/draw/track_view.hpp"
#include "track/track_outputs.hpp"

/// The picture of a film after one more pair: the left image with boxes, beside it the view from above with trails.
inline cv::Mat track_picture(flies::TrackView& view, const flies::GrayView& left, const TrackedFrame& frame) {
  const auto& [time_s, ego, tracks, detection, ego_ms, track_ms] = frame.tracking;
  return view.draw({flies::mat_of(left), time_s, ego, tracks, {detection.scan, frame.camera, detection.road.plane}});
}
