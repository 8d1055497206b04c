// The module flies_rig: OpenCV behind `board_tools`.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "flies/core/mat_view.hpp"
#include "flies/core/quantile.hpp"
#include "flies/rig/board_tools.hpp"
#include "flies/rig/find_module.hpp"
#include "flies/rig/solve_module.hpp"

namespace {

using flies::Board;
using flies::BoardCorner;
using flies::BoardKind;
using flies::SeenBoard;

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
  return widths.empty() ? 0.0 : flies::upper_median(std::move(widths));
}

class OpenCvTools final : public flies::BoardTools {
 public:
  bool has_markers() const override { return flies::kHasMarkers; }

  SeenBoard find(const flies::GrayView& image, const Board& board) const override {
    const cv::Mat picture = flies::mat_of(image);
    SeenBoard seen;
    try {
      seen = board.kind == BoardKind::chessboard ? flies::find_chessboard(picture, board)
                                                 : flies::find_marked_board(picture, board);
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

void flies::refine_corners(const cv::Mat& image, std::vector<cv::Point2f>& points, int half_window_px) {
  constexpr int kSteps = 30;
  cv::cornerSubPix(image, points, {half_window_px, half_window_px}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kSteps, 0.01});
}

extern "C" __attribute__((visibility("default"))) const flies::BoardTools* flies_board_tools();
const flies::BoardTools* flies_board_tools() {
  static const OpenCvTools tools;
  return &tools;
}
