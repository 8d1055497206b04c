#include "flies/ego/follow_corners.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>

#include "flies/core/mat_view.hpp"

namespace flies::ego {
namespace {

constexpr int kLevels = 3;                            // above the lowest
constexpr int kBorder_px = 10;                        // corners keep this far from the edge of the image
constexpr int kFastThreshold = 12;                    // grey levels
constexpr int kMaxDisparity_px = 192;                 // of the full image: 2 m with KITTI's cameras
constexpr int kHalfWidth_px = 8, kHalfHeight_px = 3;  // of the patch that finds the disparity: 16 bytes wide
constexpr double kUniqueness = 1.15;                  // the second best match must be this much worse
constexpr float kMaxRowError_px = 1.0F;               // matches left to right that leave their row are wrong
const cv::Size kWindow(13, 13);
const cv::TermCriteria kUntil(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.02);
constexpr double kMinEigenvalue = 1e-3;

/// Calls `run(first, last)` for parts of so many corners, beside each other where the arena has idle threads. Whoever
/// waits for the last part takes up no other work: that might wait for the motion which is being found here.
template <class Run>
void in_parts(std::size_t corners, const Run& run) {
  constexpr std::size_t kCornersPerTask = 64;
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, corners, kCornersPerTask),
                      [&](const auto& part) { run(part.begin(), part.end()); });
  });
}

/// Lucas and Kanade's method, of OpenCV, from the guesses in `to`. @returns which corners were found
std::vector<std::uint8_t> follow(const std::vector<cv::Mat>& from_pyramid, const std::vector<cv::Mat>& to_pyramid,
                                 std::vector<cv::Point2f>& from, std::vector<cv::Point2f>& to, int levels) {
  std::vector<std::uint8_t> is_found(from.size());
  in_parts(from.size(), [&](std::size_t first, std::size_t last) {
    const auto rows = static_cast<int>(last - first);
    const cv::Mat part_from(rows, 1, CV_32FC2, &from[first]);
    cv::Mat part_to(rows, 1, CV_32FC2, &to[first]), part_found(rows, 1, CV_8UC1, &is_found[first]);
    cv::calcOpticalFlowPyrLK(from_pyramid, to_pyramid, part_from, part_to, part_found, cv::noArray(), kWindow, levels,
                             kUntil, cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  });
  return is_found;
}

cv::Mat scaled(const GrayView& view, int scale) {
  if (scale == 1) return mat_of(view);
  // Without the odd row and column each small pixel is the mean of whole ones: exact, and ten times as fast.
  const cv::Size size(view.width_px / scale, view.height_px / scale);
  cv::Mat small;
  cv::resize(mat_of(view)(cv::Rect({}, size * scale)), small, size, 0, 0, cv::INTER_AREA);
  return small;
}

/// Between pixels of the full image and of the scaled one; pixels count from their centres.
cv::Point2f to_scaled(const cv::Point2f& p, int scale) {
  const float half = 0.5F * static_cast<float>(scale - 1);
  return {(p.x - half) / static_cast<float>(scale), (p.y - half) / static_cast<float>(scale)};
}
cv::Point2f to_full(const cv::Point2f& p, int scale) {
  const float half = 0.5F * static_cast<float>(scale - 1);
  return {p.x * static_cast<float>(scale) + half, p.y * static_cast<float>(scale) + half};
}

/// The strongest corners of each cell of a grid, so that the whole image has its say.
std::vector<cv::Point2f> spread_corners(const cv::Mat& image, int wanted) {
  std::vector<cv::KeyPoint> found;
  cv::FAST(image, found, kFastThreshold, true);
  constexpr int kInCell = 3;
  const double cell = std::sqrt(static_cast<double>(image.cols) * image.rows * kInCell / wanted);
  const int columns = static_cast<int>(image.cols / cell) + 1, rows = static_cast<int>(image.rows / cell) + 1;
  std::stable_sort(found.begin(), found.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  std::vector<int> taken(static_cast<std::size_t>(columns * rows), 0);
  std::vector<cv::Point2f> corners;
  for (const auto& key : found) {
    const cv::Point2f p = key.pt;
    if (p.x < kBorder_px || p.y < kBorder_px || p.x >= static_cast<float>(image.cols - kBorder_px) ||
        p.y >= static_cast<float>(image.rows - kBorder_px))
      continue;
    int& count = taken[static_cast<std::size_t>(static_cast<int>(p.y / cell) * columns + static_cast<int>(p.x / cell))];
    if (count >= kInCell) continue;
    ++count;
    corners.push_back(p);
  }
  return corners;
}

int patch_difference(const cv::Mat& left, const cv::Mat& right, int u_left, int u_right, int v) {
  int sum = 0;
  for (int j = -kHalfHeight_px; j <= kHalfHeight_px; ++j) {
    const std::uint8_t* a = left.ptr<std::uint8_t>(v + j) + u_left - kHalfWidth_px;
    const std::uint8_t* b = right.ptr<std::uint8_t>(v + j) + u_right - kHalfWidth_px;
    for (int i = 0; i < 2 * kHalfWidth_px; ++i) sum += std::abs(a[i] - b[i]);
  }
  return sum;
}

/// Whole-pixel disparity of one corner; nothing when there is no clear one.
std::optional<int> search_disparity(const cv::Mat& left, const cv::Mat& right, int u, int v, int min_px, int max_px) {
  const int last = std::min({max_px, u - kHalfWidth_px}), first = std::max(min_px, u + kHalfWidth_px - right.cols);
  std::array<int, kMaxDisparity_px + 1> costs{};
  if (last < first) return std::nullopt;
  int best = first;
  for (int d = first; d <= last; ++d) {
    const auto at = static_cast<std::size_t>(d - first);
    costs[at] = patch_difference(left, right, u, u - d, v);
    if (costs[at] < costs[static_cast<std::size_t>(best - first)]) best = d;
  }
  const double limit = kUniqueness * costs[static_cast<std::size_t>(best - first)] + 1.0;
  for (int d = first; d <= last; ++d)
    if (std::abs(d - best) > 1 && costs[static_cast<std::size_t>(d - first)] < limit) return std::nullopt;
  return best;
}

}  // namespace

PreparedPair prepare(const RectifiedPair& pair, double min_disparity_px, const EgoOptions& options) {
  PreparedPair prepared;
  prepared.scale = options.half_resolution ? 2 : 1;
  const int scale = prepared.scale;
  if (std::min(pair.left.width_px, pair.left.height_px) <= 3 * kBorder_px * scale) return prepared;
  const cv::Mat left = scaled(pair.left, scale), right = scaled(pair.right, scale);
  cv::buildOpticalFlowPyramid(left, prepared.left_pyramid, kWindow, kLevels, true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, false);
  cv::buildOpticalFlowPyramid(right, prepared.right_pyramid, kWindow, 0, false, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, false);

  const int min_px = static_cast<int>(std::floor(min_disparity_px / scale));
  const auto corners = spread_corners(left, options.corners);
  std::vector<std::optional<int>> whole_px(corners.size());
  in_parts(corners.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      whole_px[i] = search_disparity(left, right, cvRound(corners[i].x), cvRound(corners[i].y), min_px,
                                     min_px + kMaxDisparity_px / scale);
  });
  std::vector<cv::Point2f> left_px;
  std::vector<float> guess_px;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!whole_px[i]) continue;
    left_px.push_back(to_full(corners[i], scale));
    guess_px.push_back(static_cast<float>(*whole_px[i] * scale));
  }
  const auto disparities_px = disparities_near(prepared, left_px, guess_px);
  for (std::size_t i = 0; i < left_px.size(); ++i)
    if (!std::isnan(disparities_px[i])) prepared.corners.push_back({left_px[i], disparities_px[i]});
  return prepared;
}

std::vector<float> disparities_near(const PreparedPair& pair, const std::vector<cv::Point2f>& left_px,
                                    const std::vector<float>& guess_px) {
  std::vector<float> disparities_px(left_px.size(), std::numeric_limits<float>::quiet_NaN());
  if (left_px.empty()) return disparities_px;
  std::vector<cv::Point2f> in_left, in_right;
  for (std::size_t i = 0; i < left_px.size(); ++i) {
    in_left.push_back(to_scaled(left_px[i], pair.scale));
    in_right.push_back(to_scaled({left_px[i].x - guess_px[i], left_px[i].y}, pair.scale));
  }
  const auto is_found = follow(pair.left_pyramid, pair.right_pyramid, in_left, in_right, 0);
  for (std::size_t i = 0; i < in_left.size(); ++i)
    if (is_found[i] && std::abs(in_left[i].y - in_right[i].y) <= kMaxRowError_px)
      disparities_px[i] = static_cast<float>(pair.scale) * (in_left[i].x - in_right[i].x);
  return disparities_px;
}

std::vector<cv::Point2f> follow_corners(const PreparedPair& before, const PreparedPair& now,
                                        const std::vector<cv::Point2f>& guess_px) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<cv::Point2f> from, to;
  for (const auto& corner : before.corners) from.push_back(to_scaled(corner.left_px, before.scale));
  for (const auto& guess : guess_px) to.push_back(to_scaled(guess, now.scale));
  if (from.empty()) return {};
  const auto is_found = follow(before.left_pyramid, now.left_pyramid, from, to, kLevels);
  const auto width = static_cast<float>(now.left_pyramid[0].cols),
             height = static_cast<float>(now.left_pyramid[0].rows);
  for (std::size_t i = 0; i < to.size(); ++i) {
    const bool inside = to[i].x >= 0.0F && to[i].y >= 0.0F && to[i].x < width && to[i].y < height;
    to[i] = is_found[i] && inside ? to_full(to[i], now.scale) : cv::Point2f(kNone, kNone);
  }
  return to;
}

}  // namespace flies::ego
