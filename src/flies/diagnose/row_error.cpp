#include "flies/diagnose/row_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/core/quantile.hpp"

namespace flies {
namespace {

constexpr int kCorners = 600;
constexpr int kPyramidLevels = 5;
constexpr double kThereAndBack_px = 0.5;
constexpr int kMinAgreeing = 40;
constexpr double kMinAgreeingShare = 0.5;
constexpr double kAgrees_px = 1.0;     ///< from the line, at least
constexpr double kAgreesScatters = 4;  ///< else so many times the scatter, up to
constexpr double kAgreesMost_px = 3.0;
constexpr int kRounds = 10;
/// Corners are followed no farther up or down than this share of the height: a pair that is worse is no pair.
constexpr double kMaxRows = 0.1;

}  // namespace

double RowError::largest_px() const { return std::max(std::abs(at(0.0)), std::abs(at(2.0 * middle_u_px))); }

double RowError::typical_px() const { return std::hypot(offset_px, slope * 2.0 * middle_u_px / std::sqrt(12.0)); }

std::vector<CornerMatch> match_corners(const RectifiedPair& pair) {
  const cv::Mat left = mat_of(pair.left), right = mat_of(pair.right);
  std::vector<cv::Point2f> corners, found, back;
  cv::goodFeaturesToTrack(left, corners, kCorners, 0.01, std::max(4.0, pair.left.width_px / 100.0));
  if (corners.empty()) return {};
  std::vector<std::uint8_t> was_found, was_back;
  std::vector<float> errors;
  const cv::Size window(15, 15);
  cv::calcOpticalFlowPyrLK(left, right, corners, found, was_found, errors, window, kPyramidLevels);
  back = corners;
  cv::calcOpticalFlowPyrLK(right, left, found, back, was_back, errors, window, kPyramidLevels);
  std::vector<CornerMatch> matches;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (was_found[i] == 0 || was_back[i] == 0) continue;
    if (std::hypot(back[i].x - corners[i].x, back[i].y - corners[i].y) > kThereAndBack_px) continue;
    if (std::abs(found[i].y - corners[i].y) > kMaxRows * pair.left.height_px) continue;
    matches.push_back({corners[i].x, corners[i].y, found[i].x, found[i].y});
  }
  return matches;
}

std::optional<RowError> fit_row_error(std::span<const CornerMatch> corners, int width_px) {
  if (corners.size() < kMinAgreeing) return std::nullopt;
  RowError error;
  error.middle_u_px = 0.5 * (width_px - 1);
  const auto rows = [](const CornerMatch& corner) { return corner.right_v_px - corner.v_px; };
  std::vector<double> differences;
  for (const auto& corner : corners) differences.push_back(rows(corner));
  error.offset_px = upper_median(differences);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> residuals;
    for (const auto& corner : corners) residuals.push_back(std::abs(rows(corner) - error.at(corner.u_px)));
    const double scatter_px = upper_median(residuals);
    const double limit_px = std::clamp(kAgreesScatters * scatter_px, kAgrees_px, kAgreesMost_px);
    double n = 0, su = 0, suu = 0, sd = 0, sud = 0;
    std::vector<double> agreeing;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (residuals[i] > limit_px) continue;
      const double u = corners[i].u_px - error.middle_u_px, d = rows(corners[i]);
      // Weights fall beyond a pixel (Cauchy), so that wrong matches pull little.
      const double weight = 1.0 / (1.0 + residuals[i] * residuals[i]);
      n += weight, su += weight * u, suu += weight * u * u, sd += weight * d, sud += weight * u * d;
      agreeing.push_back(residuals[i]);
    }
    const double determinant = n * suu - su * su;
    if (agreeing.size() < kMinAgreeing || !(determinant > 0.0)) return std::nullopt;
    error.slope = (n * sud - su * sd) / determinant;
    error.offset_px = (sd - error.slope * su) / n;
    error.corners = static_cast<int>(agreeing.size());
    error.scatter_px = upper_median(std::move(agreeing));
  }
  if (error.corners < kMinAgreeingShare * static_cast<double>(corners.size())) return std::nullopt;
  return error;
}

std::optional<RowError> median_row_error(std::span<const RowError> errors) {
  if (errors.empty()) return std::nullopt;
  const auto middle = [&](auto member) {
    std::vector<double> values;
    for (const auto& error : errors) values.push_back(error.*member);
    return upper_median(std::move(values));
  };
  RowError result = errors.front();
  result.offset_px = middle(&RowError::offset_px);
  result.slope = middle(&RowError::slope);
  result.scatter_px = middle(&RowError::scatter_px);
  return result;
}

void correct_rows(const RowError& error, GrayPair& pair) {
  GrayImage& right = pair.right;
  if (right.pixels.empty()) return;
  const cv::Mat from(right.height_px, right.width_px, CV_8UC1, right.pixels.data());
  cv::Mat to;
  const cv::Matx23d moved(1.0, 0.0, 0.0, error.slope, 1.0, error.at(0.0));
  cv::warpAffine(from, to, moved, from.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  std::copy(to.begin<std::uint8_t>(), to.end<std::uint8_t>(), right.pixels.begin());
}

}  // namespace flies
