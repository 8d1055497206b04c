#include "flies/rig/focal_deviation_module.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace flies {
namespace {

constexpr int kPose = 6, kCamera = 4;  // turn and shift; focal lengths and principal point
constexpr int kFisheyeLens = 4, kPinholeLens = 4;

/// How the corners of a view move with the camera and with the board's pose.
struct Slopes {
  cv::Mat camera, pose;
};

Slopes slopes_of(const FocalEvidence& evidence, std::size_t view) {
  std::vector<cv::Point2f> seen;
  cv::Mat all;
  const auto& board_m = evidence.board_m[view];
  if (evidence.is_fisheye) {
    cv::fisheye::projectPoints(board_m, seen, evidence.turns[view], evidence.shifts[view], evidence.matrix,
                               evidence.lens, 0.0, all);
    const int of_camera = kCamera + kFisheyeLens;
    return {all.colRange(0, of_camera).clone(), all.colRange(of_camera, of_camera + kPose).clone()};
  }
  cv::projectPoints(board_m, evidence.turns[view], evidence.shifts[view], evidence.matrix, evidence.lens, seen, all);
  // A third radial coefficient that was held at zero is none that had to be told.
  const bool has_third = evidence.lens.total() > kPinholeLens && evidence.lens.at<double>(kPinholeLens) != 0.0;
  const int of_camera = kCamera + kPinholeLens + (has_third ? 1 : 0);
  return {all.colRange(kPose, kPose + of_camera).clone(), all.colRange(0, kPose).clone()};
}

/// The part of the slopes that no movement of the board explains.
cv::Mat unexplained(const Slopes& slopes) {
  const cv::SVD of_pose(slopes.pose);
  return slopes.camera - of_pose.u * (of_pose.u.t() * slopes.camera);
}

}  // namespace

double relative_focal_deviation(const FocalEvidence& evidence) {
  cv::Mat information;
  for (std::size_t view = 0; view < evidence.board_m.size(); ++view) {
    const cv::Mat own = unexplained(slopes_of(evidence, view));
    const cv::Mat of_view = own.t() * own;
    information = information.empty() ? of_view : information + of_view;
  }
  cv::Mat scale, values, vectors;
  cv::sqrt(information.diag(), scale);
  constexpr double kNothing = 1e-12;  // in place of a division by zero: as good as not known
  scale = cv::max(scale, kNothing);
  cv::eigen(information / (scale * scale.t()), values, vectors);
  double worst = 0.0;
  for (int focal = 0; focal < 2; ++focal) {
    double variance = 0.0;
    for (int i = 0; i < values.rows; ++i) {
      const double part = vectors.at<double>(i, focal);
      variance += part * part / std::max(values.at<double>(i), kNothing);
    }
    const double deviation_px = evidence.corner_deviation_px * std::sqrt(variance) / scale.at<double>(focal);
    worst = std::max(worst, deviation_px / evidence.matrix.at<double>(focal, focal));
  }
  return worst;
}

}  // namespace flies
