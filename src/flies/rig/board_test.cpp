#include "flies/rig/board.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Board, CountsCornersAlongItsRows) {
  const Board chess{
      .kind = BoardKind::chessboard, .columns = 9, .rows = 6, .square_m = 0.03, .marker_m = 0.0, .dictionary = ""};
  EXPECT_EQ(corner_count(chess), 54);
  EXPECT_THAT(corner_on_board_m(chess, 10), ElementsAre(0.03, 0.03));
  const Board charuco{
      .kind = BoardKind::charuco, .columns = 5, .rows = 7, .square_m = 0.04, .marker_m = 0.02, .dictionary = "4x4_50"};
  EXPECT_EQ(corner_count(charuco), 24);
  EXPECT_THAT(corner_on_board_m(charuco, 5), ElementsAre(0.04, 0.04));
  const Board grid{
      .kind = BoardKind::aprilgrid, .columns = 6, .rows = 6, .square_m = 0.1, .marker_m = 0.02, .dictionary = ""};
  EXPECT_EQ(corner_count(grid), 144);
  EXPECT_THAT(corner_on_board_m(grid, 0), ElementsAre(0.0, -0.1));  // upper left of tag 0, whose lower left is 0
  const auto lower_right = corner_on_board_m(grid, 4 * 7 + 2);
  EXPECT_DOUBLE_EQ(lower_right[0], 0.12 + 0.1);
  EXPECT_DOUBLE_EQ(lower_right[1], -0.12);
}

TEST(Board, RefusesWhatIsNone) {
  Board board{
      .kind = BoardKind::charuco, .columns = 5, .rows = 7, .square_m = 0.04, .marker_m = 0.02, .dictionary = "4x4_50"};
  EXPECT_EQ(error_of([&] { check_board(board); }), "no error");
  board.dictionary = "4x4_60";
  EXPECT_THAT(error_of([&] { check_board(board); }), HasSubstr("did you mean '4x4_50'?"));
  board.marker_m = 0.05;
  EXPECT_THAT(error_of([&] { check_board(board); }), HasSubstr("less than the 0.04 m of a square"));
  board.square_m = 40;
  EXPECT_THAT(error_of([&] { check_board(board); }), HasSubstr("not millimetres"));
  board.columns = 2;
  EXPECT_THAT(error_of([&] { check_board(board); }), HasSubstr("2 x 7"));
}

TEST(MatchedBoards, KeepsWhatBothImagesShow) {
  const Board board{
      .kind = BoardKind::charuco, .columns = 5, .rows = 7, .square_m = 0.04, .marker_m = 0.02, .dictionary = "4x4_50"};
  const auto pair = matched_boards(board, "a", {{{1, 10, 0}, {2, 20, 0}, {5, 50, 0}}, 1.0},
                                   {{{2, 18, 0}, {5, 48, 0}, {6, 60, 0}}, 1.0});
  ASSERT_EQ(pair.left.corners.size(), 2U);
  ASSERT_EQ(pair.right.corners.size(), 2U);
  EXPECT_EQ(pair.left.corners[1].corner, 5);
  EXPECT_EQ(pair.right.corners[1].u_px, 48);
}

TEST(MatchedBoards, TurnsAChessboardThatWasReadFromItsOtherEnd) {
  const Board board{
      .kind = BoardKind::chessboard, .columns = 3, .rows = 3, .square_m = 0.04, .marker_m = 0.0, .dictionary = ""};
  SeenBoard left, right;
  for (int i = 0; i < 9; ++i) {
    left.corners.push_back({i, 10.0 * (i % 3), 10.0 * (i / 3)});
    right.corners.push_back({i, 20.0 - 10.0 * (i % 3), 20.0 - 10.0 * (i / 3)});
  }
  const auto pair = matched_boards(board, "a", left, right);
  EXPECT_EQ(pair.right.corners[0].corner, 0);
  EXPECT_EQ(pair.right.corners[0].u_px, 0.0);
  EXPECT_EQ(pair.right.corners[5].v_px, 10.0);
}

}  // namespace
}  // namespace flies
