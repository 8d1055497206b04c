#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flies/io/formats/toy_rig.hpp"
#include "flies/rig/board.hpp"

#ifdef FLIES_HAS_MARKERS
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif

namespace flies::testing {

/// A board as it is printed, with where its first corner lies.
struct Print {
  cv::Mat picture;
  double px_per_m = 0.0;
  cv::Point2d first_corner_px;  ///< of corner 0, x right, y down, as `corner_on_board_m` counts
};

constexpr double kPrint_px_per_m = 2000.0;

inline Print print_chessboard(const Board& board) {
  const int square = static_cast<int>(std::lround(board.square_m * kPrint_px_per_m));
  Print print{cv::Mat((board.rows + 3) * square, (board.columns + 3) * square, CV_8U, cv::Scalar(255)),
              kPrint_px_per_m,
              {2.0 * square - 0.5, 2.0 * square - 0.5}};
  for (int j = 0; j <= board.rows; ++j)
    for (int i = 0; i <= board.columns; ++i)
      if ((i + j) % 2 == 0)
        print.picture(cv::Rect((i + 1) * square, (j + 1) * square, square, square)).setTo(cv::Scalar(0));
  return print;
}

#ifdef FLIES_HAS_MARKERS
inline Print print_charuco(const Board& board) {
  const auto charuco = cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                                       static_cast<float>(board.marker_m),
                                                       cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  const int square = static_cast<int>(std::lround(board.square_m * kPrint_px_per_m));
  cv::Mat inner;
  charuco->draw({board.columns * square, board.rows * square}, inner, 0, 1);
  Print print{{}, kPrint_px_per_m, {2.0 * square - 0.5, 0.0}};
  cv::copyMakeBorder(inner, print.picture, square, square, square, square, cv::BORDER_CONSTANT, cv::Scalar(255));
  // OpenCV 4.6 counts corners from the lower left, y up: see where the first one lies.
  print.first_corner_px.y = (1.0 + board.rows - 1.0) * square - 0.5;
  return print;
}

/// As OpenCV printed boards of an even count of rows before its release 4.6: the upper left square is white.
inline Print print_legacy_charuco(const Board& board) {
  const auto px = [](double metres) { return static_cast<int>(std::lround(metres * kPrint_px_per_m)); };
  const int square = px(board.square_m), side = px(board.marker_m), margin = (square - side) / 2;
  Print print{cv::Mat((board.rows + 2) * square, (board.columns + 2) * square, CV_8U, cv::Scalar(255)),
              kPrint_px_per_m,
              {2.0 * square - 0.5, 2.0 * square - 0.5}};
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
  for (int j = 0, id = 0; j < board.rows; ++j)
    for (int i = 0; i < board.columns; ++i) {
      const int u = (i + 1) * square, v = (j + 1) * square;
      if ((i + j) % 2 == 1) {
        print.picture(cv::Rect(u, v, square, square)).setTo(cv::Scalar(0));
        continue;
      }
      cv::Mat marker;
      cv::aruco::drawMarker(dictionary, id++, side, marker, 1);
      marker.copyTo(print.picture(cv::Rect(u + margin, v + margin, side, side)));
    }
  return print;
}

/// As Kalibr prints it: two cells of border, black squares where tags meet.
/// @param is_from_top as others number tags
inline Print print_aprilgrid(const Board& board, bool is_from_top = false) {
  const auto px = [](double metres) { return static_cast<int>(std::lround(metres * kPrint_px_per_m)); };
  const int tag = px(board.square_m), gap = px(board.marker_m), step = tag + gap;
  Print print{cv::Mat(board.rows * step + 3 * gap, board.columns * step + 3 * gap, CV_8U, cv::Scalar(255)),
              kPrint_px_per_m,
              {}};
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  for (int j = 0; j < board.rows; ++j)
    for (int i = 0; i < board.columns; ++i) {
      cv::Mat marker;
      cv::aruco::drawMarker(dictionary, j * board.columns + i, tag, marker, 2);
      marker.copyTo(print.picture(
          cv::Rect(2 * gap + i * step, 2 * gap + (is_from_top ? j : board.rows - 1 - j) * step, tag, tag)));
    }
  for (int j = 0; j <= board.rows; ++j)
    for (int i = 0; i <= board.columns; ++i)
      print.picture(cv::Rect(gap + i * step, gap + j * step, gap, gap)).setTo(cv::Scalar(0));
  // The frame's origin is the lower left corner of tag 0, from which y goes down.
  print.first_corner_px = {2.0 * gap - 0.5, 2.0 * gap + board.rows * step - gap - 0.5};
  return print;
}
#endif

/// Sees a print with one of the cameras of a rig.
class BoardRenderer {
 public:
  BoardRenderer(const ToyRig& rig, bool is_right, cv::Size size) : rig_(rig), is_right_(is_right), size_(size) {
    std::vector<cv::Point2d> pixels;
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u)
        for (int s = 0; s < kSamples; ++s) pixels.emplace_back(u + kOffset[s][0], v + kOffset[s][1]);
    if (rig.lens == Lens::equidistant)
      cv::fisheye::undistortPoints(pixels, rays_, is_right ? rig.m2 : rig.m1, is_right ? rig.d2 : rig.d1);
    else
      cv::undistortPoints(pixels, rays_, is_right ? rig.m2 : rig.m1, is_right ? rig.d2 : rig.d1, cv::noArray(),
                          cv::noArray(), {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 1e-8});
  }

  /// @param turn, shift the board's frame (at its first corner) in the left camera
  GrayImage render(const Print& print, const cv::Vec3d& turn, const cv::Vec3d& shift) const {
    cv::Matx33d rotation;
    cv::Rodrigues(turn, rotation);
    cv::Vec3d at = shift;
    if (is_right_) {
      rotation = rig_.r * rotation;
      at = rig_.r * shift + rig_.t;
    }
    const cv::Vec3d normal(rotation(0, 2), rotation(1, 2), rotation(2, 2));
    GrayImage image{size_.width, size_.height, std::vector<std::uint8_t>(static_cast<std::size_t>(size_.area()))};
    std::size_t ray = 0;
    for (auto& pixel : image.pixels) {
      double sum = 0.0;
      for (int s = 0; s < kSamples; ++s, ++ray) {
        const cv::Vec3d direction(rays_[ray].x, rays_[ray].y, 1.0);
        const double along = normal.dot(at) / normal.dot(direction);
        const cv::Vec3d on_board = rotation.t() * (along * direction - at);
        const double x = print.first_corner_px.x + on_board[0] * print.px_per_m;
        const double y = print.first_corner_px.y + on_board[1] * print.px_per_m;
        sum += along > 0.0 ? level(print.picture, x, y) : kBackground;
      }
      pixel = static_cast<std::uint8_t>(40.0 + 0.7 * sum / kSamples);
    }
    cv::Mat picture(size_, CV_8U, image.pixels.data());
    cv::GaussianBlur(picture, picture, {}, 0.7);  // as a lens does
    return image;
  }

 private:
  static constexpr int kSamples = 4;
  static constexpr double kOffset[kSamples][2] = {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};
  static constexpr double kBackground = 120.0;

  static double level(const cv::Mat& picture, double x, double y) {
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    if (i < 0 || j < 0 || i + 1 >= picture.cols || j + 1 >= picture.rows) return kBackground;
    const double s = x - i, t = y - j;
    const auto at = [&](int b, int a) { return static_cast<double>(picture.at<std::uint8_t>(b, a)); };
    return (1 - t) * ((1 - s) * at(j, i) + s * at(j, i + 1)) + t * ((1 - s) * at(j + 1, i) + s * at(j + 1, i + 1));
  }

  const ToyRig& rig_;
  bool is_right_;
  cv::Size size_;
  std::vector<cv::Point2d> rays_;
};

/// Where the board is held: turned about its middle, which is moved over the left image.
struct Held {
  cv::Vec3d turn;
  cv::Point2d middle_m;  ///< at the distance
  double distance_m = 0.6;
};

inline std::vector<Held> good_views() {
  return {{{0, 0, 0}, {0.06, 0}, 0.55},         {{0.5, 0, 0}, {-0.12, 0.08}, 0.6},
          {{-0.5, 0, 0.1}, {0.25, -0.1}, 0.65}, {{0, 0.5, 0}, {0.25, 0.12}, 0.6},
          {{0, -0.5, 0.1}, {-0.1, -0.1}, 0.6},  {{0.3, 0.3, -0.2}, {0.05, 0.12}, 0.5},
          {{-0.3, 0.4, 0}, {0.05, -0.13}, 0.5}, {{0.4, -0.3, 0.2}, {0.24, 0.0}, 0.7},
          {{-0.4, -0.4, 0}, {-0.1, 0.0}, 0.7},  {{0.2, 0.1, 0}, {0.2, 0.1}, 0.9}};
}

/// The board's frame in the left camera, of a board whose middle is held so.
inline cv::Vec3d shift_of(const Print& print, const Held& held) {
  const cv::Point2d middle =
      (cv::Point2d(print.picture.cols, print.picture.rows) * 0.5 - print.first_corner_px) * (1.0 / print.px_per_m);
  cv::Matx33d rotation;
  cv::Rodrigues(held.turn, rotation);
  return cv::Vec3d(held.middle_m.x, held.middle_m.y, held.distance_m) - rotation * cv::Vec3d(middle.x, middle.y, 0);
}

}  // namespace flies::testing
