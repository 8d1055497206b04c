#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "flies/core/fly.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/draw/draw.hpp"

/// The pieces of a bird's-eye view, shared by the pictures that contain one; not installed.
namespace flies::paint {

/// Places the ground in a picture: x up, y to the left.
struct GroundPlot {
  TopView view;
  cv::Rect area;  ///< of the canvas; everything drawn on the ground is clipped to it
  cv::Point at(double x_m, double y_m) const;
};

/// A plot with its top-left corner at `corner`, and the room that its axis numbers and labels need.
GroundPlot ground_plot(const TopView& view, cv::Point corner);
inline constexpr int kLeftMargin_px = 58;
inline constexpr int kTopMargin_px = 34;
inline constexpr int kBottomMargin_px = 48;

void put_grid(cv::Mat& canvas, const GroundPlot& plot, const std::string& title);
void put_field_of_view(cv::Mat& canvas, const GroundPlot& plot, const StereoCamera& camera);
/// @param strength 0..1, how far the flies' colours stand out from the paper
void put_flies(cv::Mat& canvas, const GroundPlot& plot, const Population& flies, double strength);

}  // namespace flies::paint
