#include "flies/rig/check_solution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <random>

#include "flies/io/temporary_folder.hpp"
#include "flies/rig/rendered_board.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::Held;
using flies::testing::ToyRig;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kWidth_px = 640, kHeight_px = 480;
const Board kChess{
    .kind = BoardKind::chessboard, .columns = 9, .rows = 6, .square_m = 0.025, .marker_m = 0.0, .dictionary = ""};

const BoardTools& tools() {
  ::setenv("FLIES_MODULES", FLIES_MODULES, 1);
  return board_tools();
}

SeenBoard seen(const std::vector<cv::Point3d>& board_m, const cv::Matx33d& turn, const cv::Vec3d& shift,
               const cv::Mat& matrix, const cv::Mat& lens) {
  std::vector<cv::Point2d> points;
  cv::projectPoints(board_m, turn, shift, matrix, lens, points);
  SeenBoard board;
  for (const auto& point : points) board.corners.push_back({static_cast<int>(board.corners.size()), point.x, point.y});
  return board;
}

/// What would be seen of a board: where corners fall, without pictures.
struct Scene {
  ToyRig rig;
  Board board = kChess;
  std::vector<Held> views = flies::testing::good_views();
  double moved_m = 0.0;    ///< standard deviation of the board's move between both shots
  double noise_px = 0.05;  ///< of corners

  std::vector<BoardPair> pairs() const {
    std::vector<cv::Point3d> board_m;
    for (int i = 0; i < corner_count(board); ++i) {
      const auto at = corner_on_board_m(board, i);
      board_m.emplace_back(at[0], at[1], 0.0);
    }
    std::mt19937 random(1);
    std::normal_distribution<double> unit(0.0, 1.0);
    std::vector<BoardPair> result;
    for (const auto& held : views) {
      cv::Matx33d turn;
      cv::Rodrigues(held.turn, turn);
      const cv::Vec3d at =
          cv::Vec3d(held.middle_m.x, held.middle_m.y, held.distance_m) - turn * cv::Vec3d(0.1, 0.0625, 0.0);
      const double across = unit(random), down = 0.3 * unit(random), ahead = unit(random);  // in this order everywhere
      const cv::Vec3d moved = at + moved_m * cv::Vec3d(across, down, ahead);
      auto left = seen(board_m, turn, at, cv::Mat(rig.m1), cv::Mat(rig.d1));
      auto right = seen(board_m, rig.r * turn, rig.r * moved + rig.t, cv::Mat(rig.m2), cv::Mat(rig.d2));
      for (auto* side : {&left, &right})
        for (auto& corner : side->corners)
          corner.u_px += noise_px * unit(random), corner.v_px += noise_px * unit(random);
      result.push_back(matched_boards(board, "view" + std::to_string(result.size()), left, right));
    }
    return result;
  }
};

std::vector<std::string> checked(const std::vector<BoardPair>& pairs, const Board& board = kChess) {
  const auto solution = tools().solve(pairs, board, kWidth_px, kHeight_px, Lens::brown);
  return check_solution(tools(), board, pairs, solution);
}

std::string refusal(const std::vector<BoardPair>& pairs, const Board& board = kChess) {
  return error_of([&] { checked(pairs, board); });
}

std::vector<BoardPair> with_right(std::vector<BoardPair> pairs, void (*change)(BoardCorner&)) {
  for (auto& pair : pairs)
    for (auto& corner : pair.right.corners) change(corner);
  return pairs;
}

TEST(CheckSolution, IsSilentOfGoodViewsSharpOrNot) {
  for (const double noise_px : {0.02, 0.08, 0.15}) {
    Scene scene;
    scene.noise_px = noise_px;
    EXPECT_THAT(checked(scene.pairs()), IsEmpty()) << noise_px;
  }
}

TEST(CheckSolution, NotesAndRefusesBoardsThatMoveBetweenLeftAndRight) {
  Scene scene;
  scene.moved_m = 0.0005;
  EXPECT_THAT(checked(scene.pairs()),
              ElementsAre(AllOf(HasSubstr("moved between left and right"), HasSubstr("at 10 m"))));
  scene.moved_m = 0.003;
  EXPECT_THAT(refusal(scene.pairs()), HasSubstr("moved between left and right images; ranges are wrong by"));
}

TEST(CheckSolution, RefusesBoardsThatNeverLeanHoweverSharp) {
  Scene scene;
  scene.noise_px = 0.01;
  const auto lean = [&](double share) {
    scene.views = flies::testing::good_views();
    for (auto& held : scene.views) held.turn = {share * held.turn[0], share * held.turn[1], held.turn[2]};
  };
  lean(0.03);
  EXPECT_THAT(refusal(scene.pairs()), AllOf(HasSubstr("focal length: is known to"), HasSubstr("tilted by 1 degrees")));
  lean(0.25);
  EXPECT_THAT(checked(scene.pairs()), ElementsAre(HasSubstr("all ranges may be as wrong")));
}

TEST(CheckSolution, NotesImagesThatWereStretched) {
  const Scene scene;
  auto pairs = scene.pairs();
  for (auto& pair : pairs)
    for (auto* board : {&pair.left, &pair.right})
      for (auto& corner : board->corners) corner.v_px *= 0.8;
  const auto of_camera = [](const char* name) {
    return AllOf(HasSubstr(name), HasSubstr("1.25 times the vertical one"), HasSubstr("stretched"));
  };
  EXPECT_THAT(checked(pairs), ElementsAre(of_camera("left camera: "), of_camera("right camera: ")));
}

TEST(CheckSolution, FocalDeviationIsThatOfTheFocalLength) {
  Scene scene;
  scene.noise_px = 0.3;
  const auto solution = tools().solve(scene.pairs(), kChess, kWidth_px, kHeight_px, Lens::brown);
  const double off = std::abs(solution.raw.left.matrix[0] / scene.rig.m1(0, 0) - 1.0);
  EXPECT_GT(solution.focal_deviation, off / 3.0);  // standard deviations
  EXPECT_LT(solution.focal_deviation, 0.02);
}

TEST(CheckSolution, NamesWhichImagesAreTurnedOrMirrored) {
  const Scene scene;
  const auto turn = +[](BoardCorner& corner) {
    corner.u_px = kWidth_px - 1 - corner.u_px;
    corner.v_px = kHeight_px - 1 - corner.v_px;
  };
  auto turned = with_right(scene.pairs(), turn);
  auto right_and_left = turned;
  for (auto& pair : right_and_left) std::swap(pair.left, pair.right);
  // As markers have it, which tell where the board's upper side is.
  Board marked{.kind = BoardKind::charuco,
               .columns = 10,
               .rows = 7,
               .square_m = 0.025,
               .marker_m = 0.02,
               .dictionary = "4x4_50"};
  EXPECT_THAT(refusal(turned, marked), HasSubstr("of the right camera are upside down"));
  for (auto& pair : turned) pair = matched_boards(kChess, pair.name, pair.left, pair.right);
  EXPECT_THAT(refusal(turned), HasSubstr("of the right camera are upside down"));
  auto mirrored = scene.pairs();
  for (auto& pair : mirrored) {
    for (auto& corner : pair.right.corners) {
      corner.u_px = kWidth_px - 1 - corner.u_px;
      corner.corner += 8 - 2 * (corner.corner % 9);  // the finder counts in one sense only
    }
    std::ranges::sort(pair.right.corners, {}, &BoardCorner::corner);
    pair = matched_boards(kChess, pair.name, pair.left, pair.right);
  }
  EXPECT_THAT(refusal(mirrored), HasSubstr("of the right camera are mirrored left to right"));
}

TEST(CheckSolution, NamesCamerasThatDoNotStandSideBySide) {
  Scene scene;
  auto swapped = scene.pairs();
  for (auto& pair : swapped) std::swap(pair.left, pair.right);
  EXPECT_THAT(refusal(swapped), HasSubstr("left and right are swapped"));
  scene.rig.t = {0.002, -0.06, 0.0};
  EXPECT_THAT(refusal(scene.pairs()), AllOf(HasSubstr("below the left one"), Not(HasSubstr("swapped"))));
}

TEST(CheckSolution, TellsPairsThatDoNotBelongTogetherFromBoardsThatAreOthers) {
  const Scene scene;
  auto shuffled = scene.pairs();
  std::rotate(shuffled.begin(), shuffled.begin() + 3, shuffled.end());
  for (std::size_t i = 0; i < shuffled.size(); ++i) shuffled[i].left = scene.pairs()[i].left;
  EXPECT_THAT(refusal(shuffled), HasSubstr("do not belong together"));
  Board other = kChess;
  std::swap(other.columns, other.rows);
  EXPECT_THAT(refusal(scene.pairs(), other), HasSubstr("another layout or other counts"));
}

}  // namespace
}  // namespace flies
