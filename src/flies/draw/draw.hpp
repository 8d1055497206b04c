#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/concentrate/concentrate.hpp"
#include "flies/core/fly.hpp"
#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/propose/propose.hpp"

/// Pictures of what was found and of every step on the way. Each function returns a new image, CV_8UC3 in BGR order.
/// `left` is the left image, CV_8UC1 or CV_8UC3; it is drawn at the top left of the result, which may be larger to
/// make room for a legend. Positions that are not finite and empty inputs draw nothing.
namespace flies {

/// The part of the ground that a bird's-eye view shows.
struct TopView {
  double max_x_m = 40.0;       ///< forward, 5..200
  double half_width_m = 12.0;  ///< to each side, 2..100
  double pixels_per_m = 18.0;  ///< 2..100
};

/// Colours shared by all pictures, BGR. Near is red and far, from 40 m on, is blue. Flies have the colours of
/// `fitness_color` (io), which the point clouds have too.
cv::Scalar range_color(double range_m);
inline const cv::Scalar kPedestrianColor{255, 0, 255};

/// A scan and what it takes to find its ground in the left image. An empty scan draws nothing.
struct RoadScan {
  Scan scan;
  StereoCamera camera;
  RoadPlane road;
};

/// Boxes of the obstacles, coloured by range and labelled with it, and of the pedestrians. The road that was seen free
/// (`free_space`) is tinted green; where the scan cannot tell, it is hatched in grey up to 10 m away.
cv::Mat draw_overlay(const cv::Mat& left, const std::vector<Obstacle>& obstacles,
                     const std::vector<Pedestrian>& pedestrians, const RoadScan& scanned = {});

/// Bird's-eye view: x up, y to the left, a grid every 5 m. Obstacles are bars of their width across the line of
/// sight, pedestrians discs, flies faint dots coloured by fitness. Of the scan: free ground green, a dark line where an
/// obstacle ends a sector, unknown sectors hatched up to 10 m away.
/// @param camera its `width_px` gives the field of view; 0 leaves the wedge out
cv::Mat draw_top_view(const StereoCamera& camera, const Population& flies, const std::vector<Obstacle>& obstacles,
                      const std::vector<Pedestrian>& pedestrians, const TopView& view = {}, const Scan& scan = {});

/// The flies on the left image, coloured by fitness (paper, figure 2a), with a colour bar.
cv::Mat draw_flies(const cv::Mat& left, const Population& flies, const StereoCamera& camera,
                   const std::string& title = "");

/// Flies with the name of the fitness function that scored them.
struct TitledFlies {
  std::string title;
  Population flies;
};

/// For each fitness function a column: the flies on the left image above their bird's-eye view (paper, figure 2b).
cv::Mat draw_fitness_comparison(const cv::Mat& left, const StereoCamera& camera, std::span<const TitledFlies> columns,
                                const TopView& view = {});

/// One view-angle's histogram over x and what to mark on it.
struct HistogramPlot {
  std::string title;
  ViewAngle view_angle;
  HistogramAxis axis;
  std::optional<double> marked_x_m;  ///< x of a known object in this view-angle
  std::string mark_label;            ///< its name in the legend, e.g. "pedestrian"
};

/// Votes over x in metres with the sample points (paper, figure 3c); several plots side by side.
cv::Mat draw_histograms(std::span<const HistogramPlot> plots);
cv::Mat draw_histogram(const HistogramPlot& plot);

/// The concentrating step on the left image: what became a part of an obstacle as a green disc, what was discarded as a
/// red cross, sample points as small yellow dots, and per obstacle one of the boxes that were shown to the classifier,
/// which are questions and not answers (paper, figure 4).
cv::Mat draw_concentrating(const cv::Mat& left, const ConcentrateResult& result, const std::vector<Roi>& rois = {});

}  // namespace flies
