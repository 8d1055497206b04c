#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "flies/ego/ego_motion.hpp"

/// Not installed.
namespace flies::ego {

/// Intrinsics of the left camera.
struct Pinhole {
  double f_px = 1.0, fy_px = 1.0, cx_px = 0.0, cy_px = 0.0;
};

/// A corner with its place in the left camera's frame then (x right, y down, z forward) and its pixel now.
struct FollowedCorner {
  cv::Vec3d before_m;
  cv::Vec2d now_px;
};

/// current_from_previous in the left camera's frame.
struct CameraMotion {
  cv::Matx33d rotation = cv::Matx33d::eye();
  cv::Vec3d shift_m;
};

/// The same going on for `times` as long.
CameraMotion scaled(const CameraMotion& motion, double times);

struct PoseResult {
  CameraMotion motion;
  cv::Matx66d covariance;  ///< of a small turn after the rotation, then of the shift
  int agreeing = 0;
};

/// The motion most corners agree with.
/// @param start a guess
/// @returns nothing when fewer than three corners are given or no hypothesis could be solved
std::optional<PoseResult> solve_pose(std::span<const FollowedCorner> corners, const Pinhole& camera,
                                     const CameraMotion& start, const EgoOptions& options, std::uint32_t frame);

struct ShiftResult {
  double shift_px = 0.0;      ///< all disparities are too small by this; negative: too large
  double deviation_px = 0.0;  ///< standard deviation, by the scatter of the corners
  int agreeing = 0;
};

/// The shift of all disparities with which the most corners agree on one motion: a shift of the camera moves in the
/// image what is near, and in proportion to its true disparity, so that the corners say which disparity infinity has.
/// @param scale_px_m focal length times baseline, by which the corners have their depth
/// @param start the motion that `solve_pose` has found
std::optional<ShiftResult> solve_disparity_shift(std::span<const FollowedCorner> corners, const Pinhole& camera,
                                                 double scale_px_m, const CameraMotion& start,
                                                 const EgoOptions& options);

}  // namespace flies::ego
