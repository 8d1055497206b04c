// Boards with markers, where OpenCV's aruco is.
#include "flies/rig/find_module.hpp"

#ifdef FLIES_HAS_MARKERS
#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

namespace flies {
namespace {

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  // The predefined dictionaries are numbered in the order of the names.
  const auto& names = flies::marker_dictionaries();
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  return cv::aruco::getPredefinedDictionary(static_cast<int>(at));
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
  refine_corners(image, points, std::clamp(static_cast<int>(0.4 * tag_px * board.marker_m / board.square_m), 2, 5));
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners[i].u_px = points[i].x;
    corners[i].v_px = points[i].y;
  }
  return corners;
}

}  // namespace

std::vector<BoardCorner> find_marked_board(const cv::Mat& image, const Board& board) {
  return board.kind == BoardKind::charuco ? find_charuco(image, board) : find_aprilgrid(image, board);
}

}  // namespace flies
#else
std::vector<flies::BoardCorner> flies::find_marked_board(const cv::Mat&, const Board&) { return {}; }
#endif
