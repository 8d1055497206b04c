#include "flies/road/find_mount.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"
#include "flies/road/textured_road.hpp"

namespace flies {
namespace {

/// How well the mount must be found on an ideally textured ground: what costs no obstacle.
constexpr double kHeightShare = 0.03;
constexpr double kTilt_rad = radians(0.5);

StereoCamera camera(const CameraMount& mount, double baseline_m) {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 320,
          .cx_right_px = 320,
          .cy_px = 180,
          .baseline_m = baseline_m,
          .width_px = 640,
          .height_px = 400,
          .mount = mount};
}

struct Case {
  CameraMount mount;
  double baseline_m;
};

class FindMount : public testing::TestWithParam<Case> {};

TEST_P(FindMount, SeesTheGroundThatWasToldWrong) {
  const auto& [truth, baseline_m] = GetParam();
  const OwnPair pair = render_ground(camera(truth, baseline_m));
  const RectifiedPair view = pair.view();
  const MountFinding finding = find_mount({&view, 1}, camera({}, baseline_m));
  EXPECT_TRUE(finding.is_replaced);
  EXPECT_FALSE(finding.is_upside_down);
  EXPECT_NEAR(finding.mount.height_m / truth.height_m, 1.0, kHeightShare);
  EXPECT_NEAR(finding.mount.pitch_rad, truth.pitch_rad, kTilt_rad);
  EXPECT_NEAR(finding.mount.roll_rad, truth.roll_rad, kTilt_rad);
  EXPECT_TRUE(mount_note(finding));
}

TEST_P(FindMount, LeavesWhatWasToldRight) {
  const auto& [truth, baseline_m] = GetParam();
  const StereoCamera told = camera(truth, baseline_m);
  const OwnPair pair = render_ground(told);
  const RectifiedPair view = pair.view();
  const MountFinding finding = find_mount({&view, 1}, told);
  EXPECT_TRUE(finding.is_confirmed);
  EXPECT_FALSE(finding.is_replaced);
  EXPECT_EQ(finding.mount.height_m, truth.height_m);
  EXPECT_FALSE(mount_note(finding));
}

INSTANTIATE_TEST_SUITE_P(Mounts, FindMount,
                         testing::Values(Case{{0.3, radians(5), 0.0}, 0.12}, Case{{0.2, 0.0, 0.0}, 0.3},
                                         Case{{0.4, radians(10), 0.0}, 0.12}, Case{{3.0, radians(25), 0.0}, 0.5},
                                         Case{{1.0, radians(-15), 0.0}, 0.5}, Case{{1.65, 0.0, radians(10)}, 0.5},
                                         Case{{1.0, radians(15), radians(-10)}, 0.12}));

/// Places a wall before the upper rows, as far away in all of them.
void draw_wall(OwnPair& pair, int rows, int disparity_px) {
  const auto width = static_cast<std::size_t>(pair.width_px);
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < pair.width_px; ++u) {
      const auto at = [&](int column) { return static_cast<std::uint8_t>(60 + 120 * road_texture(column, v, 5.0)); };
      const auto place = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      pair.left[place] = at(u);
      pair.right[place] = at(u + disparity_px);
    }
}

void add_noise(std::vector<std::uint8_t>& pixels, std::uint32_t purpose, double noise_gray) {
  FlyRandom random(9, purpose, 0, 0);
  for (auto& pixel : pixels)
    pixel = static_cast<std::uint8_t>(std::clamp(pixel + noise_gray * random.normal(), 0.0, 255.0));
}

TEST(FindMount, SeesSoftGroundThatIsLostInTheNoiseOfLargeImages) {
  constexpr CameraMount kTruth{0.4, radians(15), 0.0};
  StereoCamera large{.fx_px = 800,
                     .fy_px = 800,
                     .cx_px = 640,
                     .cx_right_px = 640,
                     .cy_px = 300,
                     .baseline_m = 0.12,
                     .width_px = 1280,
                     .height_px = 600,
                     .mount = kTruth};
  OwnPair pair = render_ground(large);
  for (auto* pixels : {&pair.left, &pair.right})
    for (auto& pixel : *pixels) pixel = static_cast<std::uint8_t>(96 + pixel / 4);
  draw_wall(pair, 140, 16);
  add_noise(pair.left, 0, 6.0);
  add_noise(pair.right, 1, 6.0);
  large.mount = {};
  const RectifiedPair view = pair.view();
  const MountFinding finding = find_mount({&view, 1}, large);
  EXPECT_TRUE(finding.is_replaced);
  EXPECT_NEAR(finding.mount.height_m / kTruth.height_m, 1.0, kHeightShare);
  EXPECT_NEAR(finding.mount.pitch_rad, kTruth.pitch_rad, kTilt_rad);
}

TEST(FindMount, TellsImagesThatStandOnTheirHeads) {
  OwnPair pair = render_ground(camera({1.2, radians(5), 0.0}, 0.3));
  std::reverse(pair.left.begin(), pair.left.end());
  std::reverse(pair.right.begin(), pair.right.end());
  std::swap(pair.left, pair.right);  // as a rig that hangs upside down sees it
  StereoCamera turned = camera({}, 0.3);
  turned.cx_px = turned.cx_right_px = turned.width_px - 1 - turned.cx_px;
  turned.cy_px = turned.height_px - 1 - turned.cy_px;
  const RectifiedPair view = pair.view();
  const MountFinding finding = find_mount({&view, 1}, turned);
  EXPECT_TRUE(finding.is_upside_down);
  EXPECT_FALSE(finding.is_replaced);
  EXPECT_TRUE(mount_note(finding));
}

TEST(FindMount, TellsAPrincipalPointThatIsOffByLessThanTheRoadMakesUpFor) {
  const StereoCamera level = camera({1.65, 0.0, 0.0}, 0.5);
  OwnPair pair = render_ground(level);
  draw_wall(pair, 203, 7);  // to where the ground has as much
  const RectifiedPair view = pair.view();
  EXPECT_FALSE(mount_note(find_mount({&view, 1}, level)));
  StereoCamera off = level;
  off.cx_right_px += 5.0;
  const MountFinding finding = find_mount({&view, 1}, off);
  EXPECT_NEAR(finding.rise_px(), 5.0, 0.5);
  EXPECT_NEAR(finding.farthest_px, 12.0, 0.5);
  const auto note = mount_note(finding);
  ASSERT_TRUE(note);
  EXPECT_NE(note->find("cx of one camera is some 5 to 12 px off"), std::string::npos) << *note;
}

TEST(FindMount, SeesGroundDeepBelowWhereTheBaselineIsInAnotherUnit) {
  const OwnPair pair = render_ground(camera({1.2, radians(8.0), 0.0}, 0.12));
  const RectifiedPair view = pair.view();
  const MountFinding finding = find_mount({&view, 1}, camera({}, 1.2));
  EXPECT_FALSE(finding.is_confirmed || finding.is_replaced || finding.is_upside_down);
  EXPECT_NEAR(finding.deep_ground_m / 12.0, 1.0, kHeightShare);
  EXPECT_EQ(finding.mount.height_m, finding.told.height_m);
}

TEST(FindMount, SaysNothingWhereNoGroundIsSeen) {
  OwnPair pair{640, 400, std::vector<std::uint8_t>(640 * 400, 90), std::vector<std::uint8_t>(640 * 400, 90)};
  RectifiedPair view = pair.view();
  const CameraMount told{0.9, radians(3), 0.0};
  MountFinding finding = find_mount({&view, 1}, camera(told, 0.12));
  EXPECT_FALSE(finding.is_confirmed || finding.is_replaced || finding.is_upside_down);
  // A wall that fills both images, 3 m ahead: a plane, but no ground.
  draw_wall(pair, 400, 16);
  view = pair.view();
  finding = find_mount({&view, 1}, camera(told, 0.12));
  EXPECT_FALSE(finding.is_confirmed || finding.is_replaced || finding.is_upside_down);
  EXPECT_EQ(finding.mount.height_m, told.height_m);
  EXPECT_EQ(finding.deep_ground_m, 0.0);
}

TEST(FindMount, TakesNoPairsAndImagesOfOnePixel) {
  EXPECT_FALSE(find_mount({}, camera({}, 0.5)).is_replaced);
  const std::uint8_t pixel = 7;
  const RectifiedPair tiny{{&pixel, 1, 1, 1}, {&pixel, 1, 1, 1}};
  EXPECT_FALSE(find_mount({&tiny, 1}, camera({}, 0.5)).is_replaced);
}

TEST(FindMount, RefusesACameraThatIsNoNumber) {
  StereoCamera nowhere = camera({}, 0.5);
  nowhere.fx_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(find_mount({}, nowhere), InputError);
}

}  // namespace
}  // namespace flies
