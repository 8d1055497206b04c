#include <fmt/format.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/rig/find_module.hpp"

namespace flies {
namespace {

using Points = std::vector<cv::Point2f>;

/// OpenCV's older way, which finds some boards that the newer one does not. Where it fails it takes 12 to 24 s for an
/// image of 800 x 600 px, so it looks at a small one: corners are refined in the whole image afterwards.
bool find_in_small(const cv::Mat& image, const cv::Size& counts, Points& points) {
  constexpr double kLongest_px = 400.0;
  const double scale = std::min(1.0, kLongest_px / std::max(image.cols, image.rows));
  cv::Mat small = image;
  if (scale < 1.0) cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  if (!cv::findChessboardCorners(small, counts, points, flags)) return false;
  const cv::Point2f half(0.5F, 0.5F);
  for (auto& point : points) point = (point + half) / scale - half;
  return true;
}

/// How many inner corners the chessboard has that the image shows, all or part of it; 0 x 0 without one. Starting from
/// a few, it stops early now and then: the largest of some starts counts.
cv::Size counts_of_any(const cv::Mat& image) {
  constexpr int kFewest = 4;  // less is found where there is none
  cv::Size most;
  for (const int start : {3, 5}) {
    Points points;
    cv::Mat kinds;
    if (cv::findChessboardCornersSB(image, {start, start}, points, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER,
                                    kinds) &&
        std::min(kinds.cols, kinds.rows) >= kFewest && kinds.size().area() > most.area())
      most = kinds.size();
  }
  return most;
}

/// @param counts as the board is said to have
std::string misfit_of(cv::Size found, const cv::Size& counts) {
  const auto is_turned = [&] { return (found.width < found.height) != (counts.width < counts.height); };
  if (is_turned()) std::swap(found.width, found.height);
  return fmt::format("{}a chessboard of {} x {} inner corners, expected {} x {}{}", kMisfit, found.width, found.height,
                     counts.width, counts.height, found.area() < counts.area() ? kPartOfBoard : "");
}

}  // namespace

SeenBoard find_chessboard(const cv::Mat& image, const Board& board) {
  Points points;
  const cv::Size counts(board.columns, board.rows);
  SeenBoard seen;
  if (!cv::findChessboardCornersSB(image, counts, points, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    const cv::Size any = counts_of_any(image);
    const bool is_larger = any.area() > counts.area();
    if (is_larger || !find_in_small(image, counts, points)) {
      const bool is_alike = any == counts || any == cv::Size(counts.height, counts.width);
      if (any.area() > 0 && !is_alike) seen.misfit = misfit_of(any, counts);
      return seen;
    }
  }
  const double square_px = cv::norm(points[1] - points[0]);
  refine_corners(image, points, std::clamp(static_cast<int>(0.3 * square_px), 2, 8));
  for (const auto& point : points) seen.corners.push_back({static_cast<int>(seen.corners.size()), point.x, point.y});
  return seen;
}

}  // namespace flies
