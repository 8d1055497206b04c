#pragma once

#include <opencv2/core.hpp>

#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/draw/top_view.hpp"

/// The scan in the pictures that show it: free ground in green, unknown sectors hatched at their foot; not installed.
namespace flies::paint {

/// Tints the road of `image`, the left image in BGR, pixel by pixel: what stands on the free ground's far side keeps
/// its colours. An empty scan tints nothing.
void put_scan_on_road(cv::Mat& image, const Scan& scan, const StereoCamera& camera, const RoadPlane& road);

/// Fills the free ground of a bird's-eye view, and draws where it ends at an obstacle as a dark line.
void put_scan_on_ground(cv::Mat& canvas, const GroundPlot& plot, const Scan& scan);

/// The samples of the legends: free ground and unknown, each as large as `place`, on what is there already.
void put_free_sample(cv::Mat& canvas, const cv::Rect& place);
void put_unknown_sample(cv::Mat& canvas, const cv::Rect& place);

}  // namespace flies::paint
