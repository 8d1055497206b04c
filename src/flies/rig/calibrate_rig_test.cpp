#include "flies/rig/calibrate_rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "flies/io/images.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/rig/coverage.hpp"
#include "flies/rig/coverage_picture.hpp"
#include "flies/rig/rendered_board.hpp"

namespace flies {
namespace {

using flies::testing::BoardRenderer;
using flies::testing::error_of;
using flies::testing::Held;
using flies::testing::Print;
using flies::testing::ToyRig;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWidth_px = 640, kHeight_px = 480;

const Board kChess{
    .kind = BoardKind::chessboard, .columns = 9, .rows = 6, .square_m = 0.025, .marker_m = 0.0, .dictionary = ""};
#ifdef FLIES_HAS_MARKERS
const Board kCharuco{
    .kind = BoardKind::charuco, .columns = 6, .rows = 4, .square_m = 0.05, .marker_m = 0.038, .dictionary = "5x5_100"};
const Board kGrid{
    .kind = BoardKind::aprilgrid, .columns = 4, .rows = 3, .square_m = 0.06, .marker_m = 0.018, .dictionary = ""};
#endif

const BoardTools& tools() {
  ::setenv("FLIES_MODULES", FLIES_MODULES, 1);
  return board_tools();
}

std::vector<BoardPair> seen(const ToyRig& rig, const Board& board, const Print& print, const std::vector<Held>& views) {
  const BoardRenderer left(rig, false, {kWidth_px, kHeight_px}), right(rig, true, {kWidth_px, kHeight_px});
  std::vector<BoardPair> pairs;
  for (const auto& held : views) {
    const auto shift = shift_of(print, held);
    const auto left_image = left.render(print, held.turn, shift), right_image = right.render(print, held.turn, shift);
    pairs.push_back(matched_boards(board, "view" + std::to_string(pairs.size()), tools().find(left_image.view(), board),
                                   tools().find(right_image.view(), board)));
  }
  return pairs;
}

/// The chessboard's views are used by several tests.
const std::vector<BoardPair>& chess_views() {
  static const auto pairs = seen(ToyRig(), kChess, testing::print_chessboard(kChess), testing::good_views());
  return pairs;
}

/// Found were, of ten rendered views, 0.05 to 0.08 px of rows; tags of an aprilgrid that are 40 px wide are read worse.
struct Accuracy {
  double row_px = 0.1, rms_px = 0.2;
};

void expect_found(const RigReport& report, const ToyRig& rig, const Accuracy& accuracy = {}) {
  constexpr double kShare = 0.01;  // of what ten rendered views tell
  const auto& raw = report.solution.raw;
  EXPECT_NEAR(raw.left.matrix[0], rig.m1(0, 0), kShare * rig.m1(0, 0));
  EXPECT_NEAR(raw.right.matrix[4], rig.m2(1, 1), kShare * rig.m2(1, 1));
  EXPECT_NEAR(report.calibration.camera.baseline_m, cv::norm(rig.t), kShare * cv::norm(rig.t));
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(raw.rotation[i], rig.r.val[i], 0.005);
  EXPECT_LT(report.solution.row_px, accuracy.row_px);
  EXPECT_LT(report.solution.rms_px, accuracy.rms_px);
}

TEST(CalibrateRig, FindsTheRigFromAChessboard) {
  const auto report = calibrate_rig(tools(), kChess, chess_views(), kWidth_px, kHeight_px, Lens::brown);
  EXPECT_THAT(report.dropped, IsEmpty());
  expect_found(report, ToyRig());
  testing::expect_rectifies(report.calibration, ToyRig());
}

#ifdef FLIES_HAS_MARKERS
TEST(CalibrateRig, FindsTheRigFromCharuco) {
  const auto report = calibrate_rig(tools(), kCharuco,
                                    seen(ToyRig(), kCharuco, testing::print_charuco(kCharuco), testing::good_views()),
                                    kWidth_px, kHeight_px, Lens::brown);
  EXPECT_GE(report.used.size(), 8U);
  expect_found(report, ToyRig());
}

TEST(CalibrateRig, FindsTheRigFromAnAprilgrid) {
  const auto report =
      calibrate_rig(tools(), kGrid, seen(ToyRig(), kGrid, testing::print_aprilgrid(kGrid), testing::good_views()),
                    kWidth_px, kHeight_px, Lens::brown);
  EXPECT_GE(report.used.size(), 6U);
  expect_found(report, ToyRig(), {.row_px = 0.15, .rms_px = 0.3});
}

TEST(CalibrateRig, FindsARigOfFisheyesFromBoardsThatAreSeenInPart) {
  const auto rig = ToyRig::fisheye();
  for (const auto& [board, print] :
       {std::pair(kCharuco, testing::print_charuco(kCharuco)), std::pair(kGrid, testing::print_aprilgrid(kGrid))}) {
    auto pairs = seen(rig, board, print, testing::good_views());
    for (auto* side : {&pairs[1].left, &pairs[1].right})  // as if something hid the others
      std::erase_if(side->corners, [](const BoardCorner& corner) { return corner.corner % 3 == 0; });
    const auto report = calibrate_rig(tools(), board, std::move(pairs), kWidth_px, kHeight_px, Lens::equidistant);
    EXPECT_GE(report.used.size(), 6U);
    EXPECT_LT(report.solution.row_px, 0.2);
    EXPECT_NEAR(report.calibration.camera.baseline_m, cv::norm(rig.t), 0.01 * cv::norm(rig.t));
    EXPECT_NEAR(report.solution.raw.left.matrix[0], rig.m1(0, 0), 0.02 * rig.m1(0, 0));
  }
}
#else
TEST(CalibrateRig, FindsTheRigFromBoardsWithMarkers) {
  EXPECT_FALSE(tools().has_markers());
  GTEST_SKIP() << "built without OpenCV's aruco (scripts/install-deps --checks)";
}
#endif

TEST(CalibrateRig, FindsARigOfFisheyes) {
  const auto rig = ToyRig::fisheye();
  const auto report =
      calibrate_rig(tools(), kChess, seen(rig, kChess, testing::print_chessboard(kChess), testing::good_views()),
                    kWidth_px, kHeight_px, Lens::equidistant);
  EXPECT_LT(report.solution.row_px, 0.1);
  EXPECT_NEAR(report.calibration.camera.baseline_m, cv::norm(rig.t), 0.01 * cv::norm(rig.t));
}

TEST(CalibrateRig, NamesViewsThatAreBlurredOrOfAnotherMoment) {
  auto pairs = chess_views();
  for (auto& corner : pairs[3].right.corners) corner.v_px += 4.0;  // the board moved in between
  pairs[5].left.blur_px = 12.0;
  const auto report = calibrate_rig(tools(), kChess, pairs, kWidth_px, kHeight_px, Lens::brown);
  ASSERT_EQ(report.dropped.size(), 2U);
  EXPECT_EQ(report.dropped[0].name, "view5");
  EXPECT_THAT(report.dropped[0].reason, HasSubstr("blurred"));
  EXPECT_EQ(report.dropped[1].name, "view3");
  EXPECT_THAT(report.dropped[1].reason, HasSubstr("does not fit"));
  expect_found(report, ToyRig());
}

TEST(BoardTools, MeasureTheWidthOfEdges) {
  const auto print = testing::print_chessboard(kChess);
  const ToyRig rig;
  const Held held = testing::good_views().front();
  auto image = BoardRenderer(rig, false, {kWidth_px, kHeight_px}).render(print, held.turn, shift_of(print, held));
  const double sharp_px = tools().find(image.view(), kChess).blur_px;
  EXPECT_LT(sharp_px, 3.0);
  cv::Mat picture(kHeight_px, kWidth_px, CV_8U, image.pixels.data());
  cv::GaussianBlur(picture, picture, {}, 2.0);
  const auto blurred = tools().find(image.view(), kChess);
  ASSERT_EQ(blurred.corners.size(), 54U);
  EXPECT_GT(blurred.blur_px, 1.7 * sharp_px);
}

TEST(MissingViews, NamesPartsOfTheImagesTiltsAndDistances) {
  RigSolution solution;
  solution.raw.width_px = kWidth_px;
  solution.raw.height_px = kHeight_px;
  std::vector<BoardPair> pairs;
  for (int i = 0; i < 6; ++i) {
    BoardPair pair;
    for (int k = 0; k < 48; ++k) {  // the whole right image, of the left one all but its left third
      const double u_px = 40.0 + 80.0 * (k % 8), v_px = 40.0 + 80.0 * (k / 8);
      pair.left.corners.push_back({k, 230.0 + 0.6 * u_px, v_px});
      pair.right.corners.push_back({k, u_px, v_px});
    }
    solution.views.push_back({.corners = std::vector<CornerError>(48),
                              .rms_px = 0.1,
                              .row_px = 0.1,
                              .distance_m = 0.6 + 0.01 * i,
                              .tilt_across_deg = 2.0 * i,
                              .tilt_down_deg = -30.0});
    pairs.push_back(pair);
  }
  EXPECT_THAT(missing_views(pairs, solution),
              ElementsAre("hold the board in these parts of the left image: top left, left, bottom left",
                          "turn the board's left or right side away by 30 degrees; 10 is the most so far",
                          "hold the board nearer and farther away: all views are 0.60 to 0.65 m away"));
  for (auto& view : solution.views) view.tilt_across_deg = -20.0;
  solution.views[0].distance_m = 1.0;
  for (auto& pair : pairs) pair.left = pair.right;
  EXPECT_THAT(missing_views(pairs, solution), IsEmpty());
  const auto picture = draw_coverage(pairs, solution);
  EXPECT_EQ(picture.cols, 2 * kWidth_px + 6);
}

TEST(CalibrateRig, RefusesSetsThatCannotBeRight) {
  const auto error = [&](std::vector<BoardPair> pairs, const Board& board = kChess) {
    return error_of([&] { calibrate_rig(tools(), board, std::move(pairs), kWidth_px, kHeight_px, Lens::brown); });
  };
  auto few = chess_views();
  few.resize(4);
  EXPECT_THAT(error(few), HasSubstr("4 with a board in both images are left"));
  auto shuffled = chess_views();  // left and right do not belong together
  for (std::size_t i = 0; i < shuffled.size(); ++i) shuffled[i].right = chess_views()[(i + 3) % shuffled.size()].right;
  EXPECT_THAT(error(shuffled), HasSubstr("do not belong together"));
  auto swapped = chess_views();
  for (auto& pair : swapped) std::swap(pair.left, pair.right);
  EXPECT_THAT(error(swapped), HasSubstr("swapped"));
  Board metres = kChess;
  metres.square_m = 0.0005;  // half a millimetre: a baseline of 2 mm
  EXPECT_THAT(error(chess_views(), metres), HasSubstr("baseline"));
}

TEST(CalibrateRig, RefusesViewsThatDoNotTellTheFocalLength) {
  std::vector<Held> flat;
  for (int i = 0; i < 8; ++i) flat.push_back({{0, 0, 0.01 * i}, {0.04 + 0.01 * i, 0.01 * (i - 4)}, 0.6});
  auto pairs = seen(ToyRig(), kChess, testing::print_chessboard(kChess), flat);
  std::mt19937 random(1);
  std::normal_distribution<double> noise_px(0.0, 0.3);
  for (auto& pair : pairs)
    for (auto* board : {&pair.left, &pair.right})
      for (auto& corner : board->corners) corner.u_px += noise_px(random), corner.v_px += noise_px(random);
  EXPECT_THAT(error_of([&] { calibrate_rig(tools(), kChess, pairs, kWidth_px, kHeight_px, Lens::brown); }),
              HasSubstr("tilt the board"));
}

TEST(CalibrateRig, PairsOfOpenCvRectifyToAThirdOfAPixel) {
  const std::filesystem::path folder = "/usr/share/doc/opencv-doc/examples/data";
  if (!std::filesystem::exists(folder / "left01.jpg"))
    GTEST_SKIP() << "Debian's opencv-doc is not here (scripts/install-deps --checks)";
  std::vector<BoardPair> pairs;
  for (int i = 1; i <= 14; ++i) {
    const auto name = [&](const char* side) {
      return (folder / (std::string(side) + (i < 10 ? "0" : "") + std::to_string(i) + ".jpg")).string();
    };
    if (!std::filesystem::exists(name("left"))) continue;
    const auto images = load_pair(name("left"), name("right"));
    pairs.push_back(matched_boards(kChess, name("left"), tools().find(images.left.view(), kChess),
                                   tools().find(images.right.view(), kChess)));
  }
  const auto report = calibrate_rig(tools(), kChess, pairs, kWidth_px, kHeight_px, Lens::brown);
  EXPECT_GE(report.used.size(), 11U);
  EXPECT_LE(report.solution.row_px, 0.3);
  // Its own file of intrinsics says 535.9 px.
  EXPECT_NEAR(report.solution.raw.left.matrix[0], 536.0, 6.0);
}

}  // namespace
}  // namespace flies
