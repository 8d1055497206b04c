#include "flies/diagnose/row_error.hpp"

#include <algorithm>
#include <array>
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
/// Growth from row to row is believed when it is this large and so many times its standard error. Good pairs have up to
/// 0.0054 (KITTI's own calibration, with what is near below and far above).
constexpr double kLeastGrowth = 0.006, kSureGrowth = 6.0;
/// Corners in one row say nothing of the growth: it is held to 0 by as much as a corner 10 px off the middle would.
constexpr double kHeld_px2 = 100.0;
/// Levels of left and right differ by a ratio of more than that where one exposure is another's; a few good pairs do.
constexpr double kSameLevels = 0.92;
/// Corners are followed no farther up or down than this share of the height: a pair that is worse is no pair.
constexpr double kMaxRows = 0.1;

using LevelShares = std::array<double, 256>;

/// Of the pixels, those of each level and darker ones, half of the level's own.
LevelShares shares_up_to(const cv::Mat& image) {
  LevelShares counts{}, shares{};
  for (const auto level : cv::Mat_<std::uint8_t>(image)) ++counts[level];
  double darker = 0.0;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    shares[level] = (darker + 0.5 * counts[level]) / static_cast<double>(image.total());
    darker += counts[level];
  }
  return shares;
}

bool have_same_levels(const cv::Mat& a, const cv::Mat& b) {
  cv::Scalar mean_a, mean_b, deviation_a, deviation_b;
  cv::meanStdDev(a, mean_a, deviation_a);
  cv::meanStdDev(b, mean_b, deviation_b);
  const auto are_alike = [](double x, double y) { return std::min(x, y) >= kSameLevels * std::max(x, y); };
  return are_alike(mean_a[0], mean_b[0]) && are_alike(deviation_a[0], deviation_b[0]);
}

/// The image with each level made the one that the same share of the other image's pixels is darker than: both cameras
/// see much the same, so this undoes gain, offset and gamma. Levels that are alike stay as they are: the rest of their
/// difference is what one camera sees and the other does not.
cv::Mat with_levels_of(const cv::Mat& other, const cv::Mat& image) {
  if (have_same_levels(other, image)) return image;
  const LevelShares from = shares_up_to(image), to = shares_up_to(other);
  cv::Mat_<std::uint8_t> levels(1, 256);
  for (std::size_t level = 0; level < from.size(); ++level) {
    const auto above = std::ranges::lower_bound(to, from[level]) - to.begin();
    levels(static_cast<int>(level)) = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(above, 255));
  }
  cv::Mat result;
  cv::LUT(image, levels, result);
  return result;
}

double rows_apart(const CornerMatch& corner) { return corner.right_v_px - corner.v_px; }

struct RowFit {
  RowError error;
  double growth_sd = 0.0;  ///< standard error

  bool tells_growth() const {
    return std::abs(error.growth) >= kLeastGrowth && std::abs(error.growth) >= kSureGrowth * growth_sd;
  }
};

/// What the corners differ in from a fit, without sign.
std::vector<double> differences(std::span<const CornerMatch> corners, const cv::Point2d& middle,
                                const RowError& error) {
  std::vector<double> found;
  for (const auto& corner : corners)
    found.push_back(std::abs(rows_apart(corner) - error.at(corner.u_px) - error.growth * (corner.v_px - middle.y)));
  return found;
}

/// One round of least squares with the corners that agree with the fit so far. @returns whether they are enough
bool refine(std::span<const CornerMatch> corners, const cv::Point2d& middle, bool with_growth, RowFit& fit) {
  const auto apart = differences(corners, middle, fit.error);
  const double limit_px = std::clamp(kAgreesScatters * upper_median(apart), kAgrees_px, kAgreesMost_px);
  cv::Matx33d normal = cv::Matx33d::diag({0.0, 0.0, kHeld_px2});
  cv::Vec3d rows;
  std::vector<double> agreeing;
  double squares = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (apart[i] > limit_px) continue;
    // Weights fall beyond a pixel (Cauchy), so that wrong matches pull little.
    const double weight = 1.0 / (1.0 + apart[i] * apart[i]);
    const cv::Vec3d at(1.0, corners[i].u_px - middle.x, with_growth ? corners[i].v_px - middle.y : 0.0);
    normal += weight * at * at.t();
    rows += weight * rows_apart(corners[i]) * at;
    squares += weight * apart[i] * apart[i];
    agreeing.push_back(apart[i]);
  }
  bool is_solved = false;
  const cv::Matx33d inverse = normal.inv(cv::DECOMP_CHOLESKY, &is_solved);
  if (agreeing.size() < kMinAgreeing || !is_solved) return false;
  const cv::Vec3d solution = inverse * rows;
  fit.error.offset_px = solution[0];
  fit.error.slope = solution[1];
  fit.error.growth = solution[2];
  fit.error.corners = static_cast<int>(agreeing.size());
  fit.growth_sd = std::sqrt(squares / static_cast<double>(agreeing.size()) * inverse(2, 2));
  fit.error.scatter_px = upper_median(std::move(agreeing));
  return true;
}

/// @returns nothing when too few agree
std::optional<RowFit> fit_rows(std::span<const CornerMatch> corners, const cv::Point2d& middle, bool with_growth) {
  RowFit fit;
  fit.error.middle_u_px = middle.x;
  fit.error.middle_v_px = middle.y;
  std::vector<double> apart;
  for (const auto& corner : corners) apart.push_back(rows_apart(corner));
  fit.error.offset_px = upper_median(std::move(apart));
  for (int round = 0; round < kRounds; ++round)
    if (!refine(corners, middle, with_growth, fit)) return std::nullopt;
  if (fit.error.corners < kMinAgreeingShare * static_cast<double>(corners.size())) return std::nullopt;
  return fit;
}

}  // namespace

double RowError::largest_px() const { return std::max(std::abs(at(0.0)), std::abs(at(2.0 * middle_u_px))); }

double RowError::typical_px() const { return std::hypot(offset_px, slope * 2.0 * middle_u_px / std::sqrt(12.0)); }

double RowError::differs_px(const RowError& other) const {
  const double width_px = 2.0 * middle_u_px, height_px = 2.0 * middle_v_px;
  return std::hypot(offset_px - other.offset_px, (slope - other.slope) * width_px / std::sqrt(12.0),
                    (growth - other.growth) * height_px / std::sqrt(12.0));
}

std::vector<CornerMatch> match_corners(const RectifiedPair& pair) {
  const cv::Mat left = mat_of(pair.left), right = with_levels_of(left, mat_of(pair.right));
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

std::optional<RowError> fit_row_error(std::span<const CornerMatch> corners, int width_px, int height_px) {
  if (corners.size() < kMinAgreeing) return std::nullopt;
  const cv::Point2d middle(0.5 * (width_px - 1), 0.5 * (height_px - 1));
  const auto plane = fit_rows(corners, middle, true);
  if (plane && plane->tells_growth()) return plane->error;
  const auto line = fit_rows(corners, middle, false);
  return line ? std::optional(line->error) : std::nullopt;
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
  result.growth = middle(&RowError::growth);
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
