#include "flies/rig/view_picker.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

using Answer = ViewPicker::Answer;

/// Ten corners from this place on, seen by the right camera 20 px farther to the left.
BoardPair at(double u_px, double v_px, int first = 0) {
  BoardPair pair;
  for (int i = 0; i < 10; ++i) {
    pair.left.corners.push_back({first + i, u_px + 10.0 * i, v_px});
    pair.right.corners.push_back({first + i, u_px + 10.0 * i - 20.0, v_px});
  }
  return pair;
}

TEST(ViewPicker, TakesABoardThatIsHeldStillOnce) {
  ViewPicker picker(640);
  EXPECT_EQ(picker.look(at(100, 100), 0.0), Answer::moving);  // nothing to compare with
  EXPECT_EQ(picker.look(at(100.5, 100), 0.1), Answer::picked);
  EXPECT_EQ(picker.look(at(100.5, 100.5), 0.2), Answer::known);
  EXPECT_EQ(picker.look(at(130, 100), 0.3), Answer::moving);
  EXPECT_EQ(picker.look(at(130, 100), 0.4), Answer::known);  // 30 of 640 px are not elsewhere
  EXPECT_EQ(picker.look(at(180, 100), 0.5), Answer::moving);
  EXPECT_EQ(picker.look(at(180, 101), 0.6), Answer::picked);
  EXPECT_EQ(picker.views().size(), 2U);
}

TEST(ViewPicker, WantsTheBoardInBothImagesAndAMomentAgo) {
  ViewPicker picker(640);
  picker.look(at(100, 100), 0.0);
  EXPECT_EQ(picker.look({}, 0.1), Answer::no_board);
  EXPECT_EQ(picker.look(at(100, 100), 0.2), Answer::moving);
  EXPECT_EQ(picker.look(at(100, 100), 5.0), Answer::moving);
  auto right_moves = at(100, 100);
  for (auto& corner : right_moves.right.corners) corner.u_px += 5.0;
  EXPECT_EQ(picker.look(right_moves, 5.1), Answer::moving);
}

TEST(ViewPicker, ComparesCornersOfOneNumber) {
  ViewPicker picker(640);
  picker.look(at(100, 100, 0), 0.0);
  EXPECT_EQ(picker.look(at(150, 100, 5), 0.1), Answer::picked);  // the board did not move: other corners are seen
}

}  // namespace
}  // namespace flies
