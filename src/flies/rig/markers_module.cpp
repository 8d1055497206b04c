// Boards with markers, where OpenCV's aruco is.
#include "flies/rig/find_module.hpp"
#include "flies/rig/marker_layout_module.hpp"

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

Markers find_markers(const cv::Mat& image, const cv::Ptr<cv::aruco::Dictionary>& dictionary, int border_bits) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = border_bits;
  Markers markers;
  cv::aruco::detectMarkers(image, dictionary, markers.corners, markers.ids, parameters);
  return markers;
}

/// Corners by the layout of this OpenCV, whose first square is black. A board whose first square is white is the lower
/// part of one that has a row more.
std::vector<BoardCorner> charuco_corners(const cv::Mat& image, const Board& board, Markers markers, bool is_legacy) {
  const int added = is_legacy ? 1 : 0;
  const auto charuco =
      cv::aruco::CharucoBoard::create(board.columns, board.rows + added, static_cast<float>(board.square_m),
                                      static_cast<float>(board.marker_m), dictionary_of(board.dictionary));
  for (auto& id : markers.ids) id += markers_above(board, added, false);
  std::vector<cv::Point2f> points;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, image, charuco, points, ids);
  std::vector<BoardCorner> corners;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (const int corner = ids[i] - added * (board.columns - 1); corner >= 0)
      corners.push_back({corner, points[i].x, points[i].y});
  return corners;
}

SeenBoard find_charuco(const cv::Mat& image, const Board& board) {
  const auto markers = find_markers(image, dictionary_of(board.dictionary), 1);
  SeenBoard seen;
  if (markers.ids.empty()) return seen;
  const auto layout = layout_of(markers, board);
  seen.misfit = layout.misfit;
  if (seen.misfit.empty()) seen.corners = charuco_corners(image, board, markers, layout.is_legacy);
  return seen;
}

SeenBoard find_aprilgrid(const cv::Mat& image, const Board& board) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  // Kalibr prints tags with a border of two cells, other programs with one.
  Markers markers = find_markers(image, dictionary, 2);
  if (markers.ids.empty()) markers = find_markers(image, dictionary, 1);
  SeenBoard seen;
  if (markers.ids.empty()) return seen;
  seen.misfit = layout_of(markers, board).misfit;
  if (!seen.misfit.empty()) return seen;
  std::vector<cv::Point2f> points;
  auto& corners = seen.corners;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    if (markers.ids[i] >= board.columns * board.rows) continue;
    for (int k = 0; k < 4; ++k) {
      corners.push_back({4 * markers.ids[i] + k, 0.0, 0.0});
      points.push_back(markers.corners[i][static_cast<std::size_t>(k)]);
    }
  }
  if (points.empty()) return seen;
  // Where the squares between tags touch a tag, its corner is a saddle: refined as that of a chessboard, within what
  // the gap between tags leaves.
  const double tag_px = std::sqrt(cv::contourArea(markers.corners.front()));
  refine_corners(image, points, std::clamp(static_cast<int>(0.4 * tag_px * board.marker_m / board.square_m), 2, 5));
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners[i].u_px = points[i].x;
    corners[i].v_px = points[i].y;
  }
  return seen;
}

}  // namespace

SeenBoard find_marked_board(const cv::Mat& image, const Board& board) {
  return board.kind == BoardKind::charuco ? find_charuco(image, board) : find_aprilgrid(image, board);
}

}  // namespace flies
#else
flies::SeenBoard flies::find_marked_board(const cv::Mat&, const Board&) { return {}; }
#endif
