// The module flies_rig: OpenCV's calib3d and aruco behind `board_tools`.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "flies/rig/board_tools.hpp"
#include "flies/rig/solve_module.hpp"

namespace {

using flies::Board;
using flies::BoardCorner;
using flies::BoardKind;
using flies::SeenBoard;

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  // The predefined dictionaries are numbered in the order of the names.
  const auto& names = flies::marker_dictionaries();
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  return cv::aruco::getPredefinedDictionary(static_cast<int>(at));
}

void refine(const cv::Mat& image, std::vector<cv::Point2f>& points, int half_window_px) {
  constexpr int kSteps = 30;
  cv::cornerSubPix(image, points, {half_window_px, half_window_px}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kSteps, 0.01});
}

std::vector<BoardCorner> find_chessboard(const cv::Mat& image, const Board& board) {
  std::vector<cv::Point2f> points;
  const cv::Size size(board.columns, board.rows);
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  if (!cv::findChessboardCornersSB(image, size, points, cv::CALIB_CB_NORMALIZE_IMAGE) &&
      !cv::findChessboardCorners(image, size, points, flags))
    return {};
  const double square_px = cv::norm(points[1] - points[0]);
  refine(image, points, std::clamp(static_cast<int>(0.3 * square_px), 2, 8));
  std::vector<BoardCorner> corners;
  for (const auto& point : points) corners.push_back({static_cast<int>(corners.size()), point.x, point.y});
  return corners;
}

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

Markers find_markers(const cv::Mat& image, const cv::Ptr<cv::aruco::Dictionary>& dictionary, int border_bits) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  Markers markers;
  cv::aruco::detectMarkers(image, dictionary, markers.corners, markers.ids, parameters);
  return markers;
}

std::vector<BoardCorner> find_charuco(const cv::Mat& image, const Board& board) {
  const auto dictionary = dictionary_of(board.dictionary);
  const auto charuco = cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                                       static_cast<float>(board.marker_m), dictionary);
  const auto markers = find_markers(image, dictionary, 1);
  std::vector<BoardCorner> corners;
  if (markers.ids.empty()) return corners;
  std::vector<cv::Point2f> points;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, image, charuco, points, ids);
  for (std::size_t i = 0; i < ids.size(); ++i) corners.push_back({ids[i], points[i].x, points[i].y});
  return corners;
}

std::vector<BoardCorner> find_aprilgrid(const cv::Mat& image, const Board& board) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  // Kalibr prints tags with a border of two cells, other programs with one.
  Markers markers = find_markers(image, dictionary, 2);
  if (markers.ids.empty()) markers = find_markers(image, dictionary, 1);
  std::vector<cv::Point2f> points;
  std::vector<BoardCorner> corners;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    if (markers.ids[i] >= board.columns * board.rows) continue;
    for (int k = 0; k < 4; ++k) {
      corners.push_back({4 * markers.ids[i] + k, 0.0, 0.0});
      points.push_back(markers.corners[i][static_cast<std::size_t>(k)]);
    }
  }
  if (points.empty()) return {};
  // Where the squares between tags touch a tag, its corner is a saddle: refined as that of a chessboard, within what
  // the gap between tags leaves.
  const double tag_px = std::sqrt(cv::contourArea(markers.corners.front()));
  refine(image, points, std::clamp(static_cast<int>(0.4 * tag_px * board.marker_m / board.square_m), 2, 5));
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners[i].u_px = points[i].x;
    corners[i].v_px = points[i].y;
  }
  return corners;
}

/// From the steepest slope beside each corner: (white - black) / slope.
double blur_of(const cv::Mat& image, const std::vector<BoardCorner>& corners) {
  constexpr int kHalf_px = 7;
  cv::Mat across, down, slope;
  cv::Scharr(image, across, CV_32F, 1, 0, 1.0 / 32.0);
  cv::Scharr(image, down, CV_32F, 0, 1, 1.0 / 32.0);
  cv::magnitude(across, down, slope);
  std::vector<double> widths;
  for (const auto& corner : corners) {
    const cv::Point at(cvRound(corner.u_px), cvRound(corner.v_px));
    const cv::Rect window = cv::Rect(at - cv::Point(kHalf_px, kHalf_px), cv::Size(2 * kHalf_px + 1, 2 * kHalf_px + 1)) &
                            cv::Rect({0, 0}, image.size());
    double low = 0.0, high = 0.0, steepest = 0.0;
    cv::minMaxLoc(image(window), &low, &high);
    cv::minMaxLoc(slope(window), nullptr, &steepest);
    if (steepest > 0.0) widths.push_back((high - low) / steepest);
  }
  if (widths.empty()) return 0.0;
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::nth_element(widths.begin(), middle, widths.end());
  return *middle;
}

class OpenCvTools final : public flies::BoardTools {
 public:
  SeenBoard find(const flies::GrayView& image, const Board& board) const override {
    const cv::Mat picture(image.height_px, image.width_px, CV_8U, const_cast<std::uint8_t*>(image.row(0)),
                          static_cast<std::size_t>(image.stride));
    SeenBoard seen;
    try {
      seen.corners = board.kind == BoardKind::chessboard ? find_chessboard(picture, board)
                     : board.kind == BoardKind::charuco  ? find_charuco(picture, board)
                                                         : find_aprilgrid(picture, board);
    } catch (const cv::Exception&) {  // of a picture that it finds no sense in
      return {};
    }
    std::sort(seen.corners.begin(), seen.corners.end(),
              [](const BoardCorner& a, const BoardCorner& b) { return a.corner < b.corner; });
    seen.blur_px = blur_of(picture, seen.corners);
    return seen;
  }

  flies::RigSolution solve(const std::vector<flies::BoardPair>& pairs, const Board& board, int width_px, int height_px,
                           flies::Lens lens) const override {
    try {
      return flies::solve_rig(pairs, board, width_px, height_px, lens);
    } catch (const cv::Exception& error) {
      flies::RigSolution none;
      none.failure = error.err;
      return none;
    }
  }
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const flies::BoardTools* flies_board_tools();
const flies::BoardTools* flies_board_tools() {
  static const OpenCvTools tools;
  return &tools;
}
