#include "drawn_boards.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <vector>

namespace flies::testing {
namespace {

constexpr double kSquare_m = 0.05, kBaseline_m = 0.12, kFocalShare = 0.55;
constexpr int kAcross = 10, kDown = 7;  // squares
constexpr int kSquare_px = 60;          // of the print
constexpr int kGray = 120, kWhite = 235, kBlack = 20;

/// The board with a white margin of one square.
cv::Mat print() {
  cv::Mat board((kDown + 2) * kSquare_px, (kAcross + 2) * kSquare_px, CV_8U, cv::Scalar(kWhite));
  for (int row = 0; row < kDown; ++row)
    for (int column = 0; column < kAcross; ++column)
      if ((row + column) % 2 == 0)
        board(cv::Rect((column + 1) * kSquare_px, (row + 1) * kSquare_px, kSquare_px, kSquare_px)).setTo(kBlack);
  return board;
}

/// What a camera `shift_m` to the right of the left one sees of the board in this pose.
cv::Mat view(const cv::Mat& board, cv::Vec3d turn, cv::Vec3d middle_m, double shift_m, cv::Size size) {
  const double focal_px = kFocalShare * size.width;
  const cv::Matx33d camera(focal_px, 0, 0.5 * (size.width - 1), 0, focal_px, 0.5 * (size.height - 1), 0, 0, 1);
  std::vector<cv::Point3d> corners;
  std::vector<cv::Point2d> of_print, pixels;
  for (const int u : {0, board.cols})
    for (const int v : {0, board.rows}) {
      const double m_per_px = kSquare_m / kSquare_px;
      corners.emplace_back((u - 0.5 * board.cols) * m_per_px, (v - 0.5 * board.rows) * m_per_px, 0.0);
      of_print.emplace_back(u - 0.5, v - 0.5);
    }
  cv::projectPoints(corners, turn, middle_m - cv::Vec3d(shift_m, 0, 0), camera, cv::noArray(), pixels);
  cv::Mat seen;
  cv::warpPerspective(board, seen, cv::findHomography(of_print, pixels), size, cv::INTER_AREA, cv::BORDER_CONSTANT,
                      cv::Scalar(kGray));
  return seen;
}

}  // namespace

void write_film_of_boards(const std::filesystem::path& film, cv::Size size) {
  struct Held {
    cv::Vec3d turn, middle_m;
  };
  const Held held[] = {{{0, 0, 0}, {0.06, 0, 0.7}},           {{0.4, 0, 0}, {-0.2, -0.05, 0.75}},
                       {{-0.4, 0, 0.1}, {0.3, 0.05, 0.75}},   {{0, 0.45, 0}, {0.06, 0.1, 0.8}},
                       {{0, -0.45, 0}, {0.0, -0.1, 0.8}},     {{0.3, 0.3, 0}, {-0.25, 0.1, 0.9}},
                       {{-0.3, 0.3, -0.1}, {0.4, -0.1, 0.9}}, {{0.2, -0.3, 0.1}, {-0.3, 0.05, 1.1}},
                       {{-0.2, -0.3, 0}, {0.45, 0.1, 1.1}}};
  const cv::Mat board = print();
  cv::VideoWriter writer(film.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                         {2 * size.width, size.height});
  if (!writer.isOpened()) throw std::runtime_error("OpenCV cannot write " + film.string());
  for (const auto& [turn, middle_m] : held) {
    cv::Mat both, colour;
    cv::hconcat(view(board, turn, middle_m, 0.0, size), view(board, turn, middle_m, kBaseline_m, size), both);
    cv::cvtColor(both, colour, cv::COLOR_GRAY2BGR);
    for (int i = 0; i < 3; ++i) writer.write(colour);
  }
}

}  // namespace flies::testing
