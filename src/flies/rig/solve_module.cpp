#include "flies/rig/solve_module.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "flies/rig/focal_deviation_module.hpp"

namespace flies {
namespace {

using ObjectPoints = std::vector<std::vector<cv::Point3f>>;
using ImagePoints = std::vector<std::vector<cv::Point2f>>;

struct Points {
  ObjectPoints board;
  ImagePoints left, right;
};

struct Cameras {
  cv::Mat m1, d1, m2, d2, r, t;
};

struct Rectified {
  cv::Mat r1, r2, p1, p2, q;
};

Points points_of(const std::vector<BoardPair>& pairs, const Board& board) {
  Points points;
  for (const auto& pair : pairs) {
    auto& on_board = points.board.emplace_back();
    auto& left = points.left.emplace_back();
    auto& right = points.right.emplace_back();
    for (std::size_t i = 0; i < pair.left.corners.size(); ++i) {
      const auto at = corner_on_board_m(board, pair.left.corners[i].corner);
      on_board.emplace_back(static_cast<float>(at[0]), static_cast<float>(at[1]), 0.0F);
      left.emplace_back(static_cast<float>(pair.left.corners[i].u_px), static_cast<float>(pair.left.corners[i].v_px));
      right.emplace_back(static_cast<float>(pair.right.corners[i].u_px),
                         static_cast<float>(pair.right.corners[i].v_px));
    }
  }
  return points;
}

/// Whether the lens maps larger angles to larger radii over the whole image: a polynomial does so only where it was
/// fitted.
bool is_monotonic(const cv::Mat& m, const cv::Mat& d, const cv::Size& size) {
  const double fx = m.at<double>(0, 0), fy = m.at<double>(1, 1), cx = m.at<double>(0, 2), cy = m.at<double>(1, 2);
  const double corner = std::hypot(std::max(cx, size.width - cx) / fx, std::max(cy, size.height - cy) / fy);
  const double k1 = d.at<double>(0), k2 = d.at<double>(1), k3 = d.at<double>(4);
  constexpr double kStep = 0.01;
  for (double r = 0.0, bent = 0.0; bent < corner; r += kStep) {
    const double r2 = r * r;
    if (1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3)) <= 0.0) return false;
    bent = r * (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)));
  }
  return true;
}

struct CameraSolution {
  Cameras cameras;
  double rms_px = 0.0;        ///< of both together
  double alone_rms_px = 0.0;  ///< of each alone, the worse
};

CameraSolution solve_pinholes(const Points& points, const cv::Size& size, int flags) {
  CameraSolution solution;
  auto& c = solution.cameras;
  std::vector<cv::Mat> turns, shifts;
  cv::Mat e, f;
  solution.alone_rms_px =
      std::max(cv::calibrateCamera(points.board, points.left, size, c.m1, c.d1, turns, shifts, flags),
               cv::calibrateCamera(points.board, points.right, size, c.m2, c.d2, turns, shifts, flags));
  solution.rms_px = cv::stereoCalibrate(points.board, points.left, points.right, c.m1, c.d1, c.m2, c.d2, size, c.r, c.t,
                                        e, f, cv::CALIB_USE_INTRINSIC_GUESS | flags,
                                        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-7});
  return solution;
}

/// The third radial coefficient is let free where it explains something and does no harm beyond the corners.
CameraSolution solve_pinholes(const Points& points, const cv::Size& size) {
  constexpr double kWorthwhile = 0.95;
  const auto simple = solve_pinholes(points, size, cv::CALIB_FIX_K3), full = solve_pinholes(points, size, 0);
  const bool is_better = full.rms_px < kWorthwhile * simple.rms_px &&
                         is_monotonic(full.cameras.m1, full.cameras.d1, size) &&
                         is_monotonic(full.cameras.m2, full.cameras.d2, size);
  return is_better ? full : simple;
}

/// The fisheye functions want double precision, and as many corners in each view: boards that are seen in part repeat
/// theirs, so that every view weighs the same.
template <class Out, class In>
std::vector<std::vector<Out>> doubled(const std::vector<std::vector<In>>& points) {
  std::size_t most = 0;
  for (const auto& view : points) most = std::max(most, view.size());
  std::vector<std::vector<Out>> result;
  for (const auto& view : points) {
    auto& padded = result.emplace_back(view.begin(), view.end());
    for (std::size_t i = 0; padded.size() < most; ++i) padded.push_back(padded[i]);
  }
  return result;
}

CameraSolution solve_fisheyes(const Points& points, const cv::Size& size) {
  const auto board = doubled<cv::Point3d>(points.board);
  const auto left = doubled<cv::Point2d>(points.left), right = doubled<cv::Point2d>(points.right);
  const int flags = cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW;
  const cv::TermCriteria end{cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-8};
  CameraSolution solution;
  auto& c = solution.cameras;
  std::vector<cv::Vec3d> turns, shifts;
  solution.alone_rms_px = std::max(cv::fisheye::calibrate(board, left, size, c.m1, c.d1, turns, shifts, flags, end),
                                   cv::fisheye::calibrate(board, right, size, c.m2, c.d2, turns, shifts, flags, end));
  solution.rms_px = cv::fisheye::stereoCalibrate(board, left, right, c.m1, c.d1, c.m2, c.d2, size, c.r, c.t,
                                                 cv::fisheye::CALIB_FIX_INTRINSIC | cv::fisheye::CALIB_FIX_SKEW, end);
  return solution;
}

Rectified rectified(const Cameras& c, const cv::Size& size, bool is_fisheye) {
  Rectified to;
  if (is_fisheye)
    cv::fisheye::stereoRectify(c.m1, c.d1, c.m2, c.d2, size, c.r, c.t, to.r1, to.r2, to.p1, to.p2, to.q,
                               cv::CALIB_ZERO_DISPARITY);
  else
    cv::stereoRectify(c.m1, c.d1, c.m2, c.d2, size, c.r, c.t, to.r1, to.r2, to.p1, to.p2, to.q,
                      cv::CALIB_ZERO_DISPARITY, 0);
  return to;
}

std::vector<cv::Point2f> undistorted(const std::vector<cv::Point2f>& points, const cv::Mat& m, const cv::Mat& d,
                                     const cv::Mat& r, const cv::Mat& p, bool is_fisheye) {
  std::vector<cv::Point2f> result;
  if (is_fisheye)
    cv::fisheye::undistortPoints(points, result, m, d, r, p);
  else
    cv::undistortPoints(points, result, m, d, r, p);
  return result;
}

std::vector<cv::Point2f> projected(const std::vector<cv::Point3f>& points, const cv::Mat& turn, const cv::Mat& shift,
                                   const cv::Mat& m, const cv::Mat& d, bool is_fisheye) {
  std::vector<cv::Point2f> result;
  if (is_fisheye)
    cv::fisheye::projectPoints(points, result, turn, shift, m, d);
  else
    cv::projectPoints(points, turn, shift, m, d, result);
  return result;
}

constexpr double kDegrees = 180.0 / CV_PI;

/// Where a board stands before both cameras.
struct Pose {
  cv::Mat turn, shift, right_turn, right_shift, rotation;
};

/// That which the left image shows.
Pose pose_of(const Points& points, std::size_t view, const Cameras& c, bool is_fisheye) {
  const auto ideal =
      undistorted(points.left[view], c.m1, c.d1, cv::Mat::eye(3, 3, CV_64F), cv::Mat::eye(3, 4, CV_64F), is_fisheye);
  Pose pose;
  cv::solvePnP(points.board[view], ideal, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), pose.turn, pose.shift);
  cv::Rodrigues(pose.turn, pose.rotation);
  cv::Rodrigues(c.r * pose.rotation, pose.right_turn);
  pose.right_shift = c.r * pose.shift + c.t;
  return pose;
}

/// What one view says of the solution.
ViewError error_of(const Points& points, std::size_t view, const Pose& pose, const Cameras& c, const Rectified& to,
                   bool is_fisheye) {
  const auto& board = points.board[view];
  const auto &left = points.left[view], &right = points.right[view];
  const auto& rotation = pose.rotation;
  const auto left_seen = projected(board, pose.turn, pose.shift, c.m1, c.d1, is_fisheye);
  const auto right_seen = projected(board, pose.right_turn, pose.right_shift, c.m2, c.d2, is_fisheye);
  const auto left_rows = undistorted(left, c.m1, c.d1, to.r1, to.p1, is_fisheye);
  const auto right_rows = undistorted(right, c.m2, c.d2, to.r2, to.p2, is_fisheye);
  ViewError error;
  double squares = 0.0;
  for (std::size_t i = 0; i < board.size(); ++i) {
    const CornerError corner{cv::norm(left_seen[i] - left[i]), cv::norm(right_seen[i] - right[i]),
                             std::abs(static_cast<double>(left_rows[i].y) - static_cast<double>(right_rows[i].y))};
    squares += corner.left_px * corner.left_px + corner.right_px * corner.right_px;
    error.row_px += corner.row_px / static_cast<double>(board.size());
    error.corners.push_back(corner);
  }
  error.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(board.size())));
  error.distance_m = cv::norm(pose.shift);
  // The board's normal, turned towards where the camera looks: to which side it leans away.
  cv::Vec3d normal(rotation.at<double>(0, 2), rotation.at<double>(1, 2), rotation.at<double>(2, 2));
  if (normal[2] < 0.0) normal = -normal;
  error.tilt_across_deg = kDegrees * std::atan2(normal[0], normal[2]);
  error.tilt_down_deg = kDegrees * std::atan2(normal[1], normal[2]);
  return error;
}

std::vector<double> listed(const cv::Mat& m) {
  std::vector<double> values;
  for (int i = 0; i < static_cast<int>(m.total()); ++i) values.push_back(m.at<double>(i / m.cols, i % m.cols));
  return values;
}

RawCamera camera_of(const cv::Mat& m, const cv::Mat& d, Lens lens) {
  RawCamera camera{{}, listed(d), lens};
  std::ranges::copy(listed(m), camera.matrix.begin());
  return camera;
}

}  // namespace

RigSolution solve_rig(const std::vector<BoardPair>& pairs, const Board& board, int width_px, int height_px, Lens lens) {
  const bool is_fisheye = lens == Lens::equidistant;
  const cv::Size size(width_px, height_px);
  const Points points = points_of(pairs, board);
  const auto solved = is_fisheye ? solve_fisheyes(points, size) : solve_pinholes(points, size);
  const Cameras& c = solved.cameras;
  const Rectified to = rectified(c, size, is_fisheye);
  RigSolution solution;
  solution.alone_rms_px = solved.alone_rms_px;
  solution.raw = {width_px, height_px, camera_of(c.m1, c.d1, lens), camera_of(c.m2, c.d2, lens), {}, {}};
  std::ranges::copy(listed(c.r), solution.raw.rotation.begin());
  std::ranges::copy(listed(c.t), solution.raw.translation_m.begin());
  FocalEvidence left{c.m1, c.d1, is_fisheye, points.board, {}, {}, 0.0};
  FocalEvidence right{c.m2, c.d2, is_fisheye, points.board, {}, {}, 0.0};
  double squares = 0.0, rows = 0.0, corners = 0.0;
  for (std::size_t view = 0; view < pairs.size(); ++view) {
    const Pose pose = pose_of(points, view, c, is_fisheye);
    left.turns.push_back(pose.turn), left.shifts.push_back(pose.shift);
    right.turns.push_back(pose.right_turn), right.shifts.push_back(pose.right_shift);
    const auto& error = solution.views.emplace_back(error_of(points, view, pose, c, to, is_fisheye));
    const auto count = static_cast<double>(error.corners.size());
    squares += error.rms_px * error.rms_px * count;
    rows += error.row_px * count;
    corners += count;
  }
  solution.rms_px = std::sqrt(squares / corners);
  solution.row_px = rows / corners;
  // However well corners fit, lens and board are not quite what the model says.
  constexpr double kLeast_px = 0.1;
  left.corner_deviation_px = right.corner_deviation_px = std::max(solution.rms_px, kLeast_px) / std::sqrt(2.0);
  solution.focal_deviation = std::max(relative_focal_deviation(left), relative_focal_deviation(right));
  return solution;
}

}  // namespace flies
