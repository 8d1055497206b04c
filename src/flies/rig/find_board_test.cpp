#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "flies/rig/board_tools.hpp"
#include "flies/rig/rendered_board.hpp"

namespace flies {
namespace {

using flies::testing::BoardRenderer;
using flies::testing::Print;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const BoardTools& tools() {
  ::setenv("FLIES_MODULES", FLIES_MODULES, 1);
  return board_tools();
}

GrayImage image_of(const Print& print) {
  const ToyRig rig;
  const auto held = flies::testing::good_views().front();
  return BoardRenderer(rig, false, {640, 480}).render(print, held.turn, shift_of(print, held));
}

TEST(FindBoard, CountsTheCornersOfAnotherChessboard) {
  Board board{
      .kind = BoardKind::chessboard, .columns = 9, .rows = 6, .square_m = 0.025, .marker_m = 0.0, .dictionary = ""};
  const auto image = image_of(flies::testing::print_chessboard(board));
  EXPECT_THAT(tools().find(image.view(), board).misfit, IsEmpty());
  for (const auto& [columns, rows] : {std::pair(8, 6), std::pair(10, 6), std::pair(9, 5), std::pair(9, 7)}) {
    board.columns = columns;
    board.rows = rows;
    const auto seen = tools().find(image.view(), board);
    EXPECT_THAT(seen.corners, IsEmpty());
    EXPECT_THAT(seen.misfit, HasSubstr("a chessboard of 9 x 6 inner corners, expected")) << columns << " x " << rows;
  }
}

#ifdef FLIES_HAS_MARKERS
const Board kCharuco{
    .kind = BoardKind::charuco, .columns = 6, .rows = 4, .square_m = 0.05, .marker_m = 0.038, .dictionary = "5x5_100"};

TEST(FindBoard, ReadsCharucoOfBothLayouts) {
  const auto now = tools().find(image_of(flies::testing::print_charuco(kCharuco)).view(), kCharuco);
  const auto before = tools().find(image_of(flies::testing::print_legacy_charuco(kCharuco)).view(), kCharuco);
  ASSERT_EQ(now.corners.size(), 15U);
  ASSERT_EQ(before.corners.size(), 15U);
  constexpr double kSamePlace_px = 0.3;  // black and white are exchanged, and the print lies half a pixel elsewhere
  const auto step_px = [](const SeenBoard& seen) { return seen.corners[6].u_px - seen.corners[0].u_px; };
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(before.corners[i].corner, static_cast<int>(i));
  EXPECT_NEAR(step_px(now), step_px(before), kSamePlace_px);
}

TEST(FindBoard, TellsThatMarkersAreThoseOfAnotherBoard) {
  const auto image = image_of(flies::testing::print_charuco(kCharuco));
  const auto misfit = [&](int columns, int rows, double marker_m) {
    Board board = kCharuco;
    board.columns = columns;
    board.rows = rows;
    board.marker_m = marker_m;
    return tools().find(image.view(), board).misfit;
  };
  EXPECT_THAT(misfit(4, 6, 0.038), AllOf(HasSubstr("6 columns"), HasSubstr("exchanged")));
  EXPECT_THAT(misfit(7, 4, 0.038), HasSubstr("6 columns, expected 7"));
  EXPECT_THAT(misfit(6, 4, 0.02), HasSubstr("of a square's side, expected 0.40"));
}

TEST(FindBoard, TellsThatTagsAreNumberedOtherwise) {
  Board board{
      .kind = BoardKind::aprilgrid, .columns = 4, .rows = 3, .square_m = 0.06, .marker_m = 0.018, .dictionary = ""};
  EXPECT_THAT(tools().find(image_of(flies::testing::print_aprilgrid(board)).view(), board).misfit, IsEmpty());
  EXPECT_THAT(tools().find(image_of(flies::testing::print_aprilgrid(board, true)).view(), board).misfit,
              HasSubstr("numbered from the top"));
}
#endif

}  // namespace
}  // namespace flies
