#include "flies/scan/scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 640, kHeight_px = 240;

StereoCamera camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 320,
          .cx_right_px = 320,
          .cy_px = 80,
          .baseline_m = 0.5,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.5}};
}

/// A pair that is drawn pixel by pixel: what the left pixel shows lies at a disparity, which tells the right one.
struct Drawn {
  std::vector<std::uint8_t> left, right;

  Drawn() : left(kWidth_px * kHeight_px, 120), right(kWidth_px * kHeight_px, 120) {}

  static std::uint8_t texture(int u, int v) {
    return static_cast<std::uint8_t>(
        60 + FlyRandom(8, 0, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(u + 4000)).below(130));
  }
  /// Rows of the road, at the disparity of each row: the same texture in both images.
  void paint_road() {
    const Projection projection(camera());
    for (int v = 84; v < kHeight_px; ++v) {
      const int disparity_px = static_cast<int>(std::lround(projection.road_parallax_px(320, v, {})));
      for (int u = 0; u < kWidth_px; ++u) {
        left[at(u, v)] = texture(u, v);
        right[at(u, v)] = texture(u + disparity_px, v);
      }
    }
  }
  /// A board that stands on the road at this depth, so many metres high, between two columns of the left image.
  void paint_board(double depth_m, double height_m, int from_u, int to_u, bool is_plain_inside = false) {
    const int disparity_px = static_cast<int>(std::lround(400 * 0.5 / depth_m));
    const int foot = static_cast<int>(80 + 400 * 1.5 / depth_m),
              top = static_cast<int>(80 + 400 * (1.5 - height_m) / depth_m);
    for (int v = std::max(0, top); v < std::min(foot, kHeight_px); ++v)
      for (int u = from_u; u < to_u; ++u) {
        const bool is_plain = is_plain_inside && u >= from_u + 16 && u < to_u - 16;
        const std::uint8_t gray = is_plain ? 200 : texture(u + 2000, v);
        left[at(u, v)] = gray;
        if (u >= disparity_px) right[at(u - disparity_px, v)] = gray;
      }
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
  Scan scan(const ScanOptions& options = {}) const {
    return flies::scan(pair(), Projection(camera()), {}, {}, {}, options);
  }

 private:
  static std::size_t at(int u, int v) { return static_cast<std::size_t>(v * kWidth_px + u); }
};

/// The sectors that look between two columns of the left image.
std::vector<std::size_t> sectors_between(const Scan& scan, double from_u, double to_u) {
  std::vector<std::size_t> sectors;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double u = 320 - 400 * std::tan(scan.angle_rad(i));
    if (u >= from_u && u <= to_u) sectors.push_back(i);
  }
  return sectors;
}

TEST(Scan, FindsABoardOnTheRoadAndSeesTheRoadBesideIt) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(10.0, 1.6, 280, 380);
  const Scan scan = drawn.scan();
  const auto board = sectors_between(scan, 288, 372);
  ASSERT_GE(board.size(), 15U);
  for (const std::size_t i : board) {
    EXPECT_EQ(scan.states[i], SectorState::obstacle) << i;
    EXPECT_NEAR(scan.ranges_m[i], 10.0 / std::cos(scan.angle_rad(i)), 0.3) << i;
    EXPECT_GT(scan.confidence[i], 0.5) << i;
    EXPECT_GT(scan.free_m[i], 7.0) << i;
    EXPECT_LE(scan.free_m[i], scan.ranges_m[i]) << i;
  }
  // The drawn road ends 50 m away, which looks like the foot of something.
  const auto road = sectors_between(scan, 430, 600);
  ASSERT_GE(road.size(), 30U);
  for (const std::size_t i : road) {
    EXPECT_NE(scan.states[i], SectorState::unknown) << i;
    EXPECT_FALSE(scan.ranges_m[i] < 35.0) << i << ": " << scan.ranges_m[i] << " m";
    EXPECT_GT(scan.free_m[i], 12.0) << i;
  }
}

TEST(Scan, TakesAPlainSideBetweenTwoEdgesForASurface) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(8.0, 1.6, 300, 380, true);
  const Scan scan = drawn.scan();
  const auto side = sectors_between(scan, 308, 372);
  ASSERT_GE(side.size(), 15U);
  for (const std::size_t i : side) {
    EXPECT_EQ(scan.states[i], SectorState::obstacle) << i;
    EXPECT_NEAR(scan.ranges_m[i], 8.0 / std::cos(scan.angle_rad(i)), 0.6) << i;
  }
}

TEST(Scan, KnowsNothingWhereNothingCanBeSeen) {
  for (const int level : {0, 90, 255}) {
    const auto gray = static_cast<std::uint8_t>(level);
    Drawn drawn;
    std::fill(drawn.left.begin(), drawn.left.end(), gray);
    std::fill(drawn.right.begin(), drawn.right.end(), gray);
    const Scan scan = drawn.scan();
    ASSERT_FALSE(scan.empty());
    for (std::size_t i = 0; i < scan.size(); ++i) {
      EXPECT_EQ(scan.states[i], SectorState::unknown);
      EXPECT_TRUE(std::isnan(scan.ranges_m[i]));
      EXPECT_EQ(scan.free_m[i], 0.0);
      EXPECT_EQ(scan.confidence[i], 0.0);
    }
  }
}

/// Dark pixels of a covered camera.
std::uint8_t noise(std::uint32_t camera, int pixel) {
  return static_cast<std::uint8_t>(FlyRandom(9, camera, static_cast<std::uint32_t>(pixel), 0).below(5));
}

TEST(Scan, KnowsNothingWhereImagesShowNoise) {
  Drawn drawn;
  for (int i = 0; i < kWidth_px * kHeight_px; ++i) {
    drawn.left[static_cast<std::size_t>(i)] = noise(1, i);
    drawn.right[static_cast<std::size_t>(i)] = noise(2, i);
  }
  const Scan scan = drawn.scan();
  ASSERT_FALSE(scan.empty());
  EXPECT_EQ(std::count(scan.states.begin(), scan.states.end(), SectorState::unknown),
            static_cast<std::ptrdiff_t>(scan.size()));
}

TEST(Scan, KnowsNothingWhereHalfOfTheRightImageIsDark) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(10.0, 1.6, 100, 200);
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = kWidth_px / 2; u < kWidth_px; ++u)
      drawn.right[static_cast<std::size_t>(v * kWidth_px + u)] = noise(2, v * kWidth_px + u);
  const Scan scan = drawn.scan();
  const double nearest_px = 400 * 0.5 / ScanOptions().x_min_m;  // partners of farther columns may lie in the light half
  const auto dark = sectors_between(scan, kWidth_px / 2 + nearest_px + 48, kWidth_px),
             board = sectors_between(scan, 120, 180);
  ASSERT_GE(dark.size(), 20U);
  ASSERT_GE(board.size(), 10U);
  for (const std::size_t i : dark) EXPECT_EQ(scan.states[i], SectorState::unknown) << i;
  for (const std::size_t i : board) EXPECT_EQ(scan.states[i], SectorState::obstacle) << i;
}

TEST(Scan, HasSectorsFromRightToLeftWithinTheViewOfBothCameras) {
  const Scan scan = Drawn().scan();
  EXPECT_NEAR(scan.angle_increment_rad, radians(0.5), 1e-12);
  EXPECT_NEAR(scan.angle_min_rad, -std::atan(320.0 / 400.0), radians(1.0));
  EXPECT_NEAR(scan.angle_rad(scan.size() - 1), std::atan((320.0 - 200.0 / 45.0) / 400.0), radians(1.0));
  EXPECT_EQ(scan.ranges_m.size(), scan.size());
  EXPECT_EQ(scan.free_m.size(), scan.size());
  EXPECT_EQ(scan.confidence.size(), scan.size());
}

TEST(Scan, SwitchedOffIsEmpty) { EXPECT_TRUE(Drawn().scan({.enable = false}).empty()); }

TEST(Scan, TakesImagesOfAnySize) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(8, 3), std::pair(64, 48), std::pair(9, 300)}) {
    const std::vector<std::uint8_t> gray(static_cast<std::size_t>(width * height), 50);
    const GrayView view{gray.data(), width, height, width};
    StereoCamera small = camera();
    small.width_px = width;
    small.height_px = height;
    const Scan scan = flies::scan({view, view}, Projection(small), {}, {}, {}, {});
    EXPECT_EQ(scan.empty(), width == 1) << width;
    for (const auto state : scan.states) EXPECT_EQ(state, SectorState::unknown);
  }
}

TEST(Scan, GivesTheSameAfterOtherPairs) {
  Drawn drawn, other;
  drawn.paint_road();
  drawn.paint_board(10.0, 1.6, 280, 380);
  other.paint_board(6.0, 1.0, 100, 500);
  Scanner scanner;
  const Projection projection(camera());
  const auto first = scanner.scan(drawn.pair(), projection, {}, {}, {}, {});
  scanner.scan(other.pair(), projection, {}, {}, {}, {});
  const auto again = scanner.scan(drawn.pair(), projection, {}, {}, {}, {});
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first.states, again.states);
  EXPECT_EQ(first.free_m, again.free_m);
  EXPECT_EQ(first.confidence, again.confidence);
}

Scan next_scan(Scanner& scanner, const Drawn& drawn, std::optional<PlanarMotion> motion = {}) {
  return scanner.scan(drawn.pair(), Projection(camera()), {}, {}, {}, {}, motion);
}

TEST(Scanner, RemembersWhatStoodWhereNothingCanBeSeen) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(10.0, 1.6, 280, 380);
  for (const PlanarMotion motion : {PlanarMotion{1.0, 0.0, 0.0}, PlanarMotion{0.0, 0.0, 0.1}}) {
    Scanner scanner;
    next_scan(scanner, drawn);
    const Scan scan = next_scan(scanner, Drawn(), motion);  // fog
    const Point3 middle = motion.now({10.0, -10.0 * (330.0 - 320.0) / 400.0, 0.0});
    const double u_px = 320.0 - 400.0 * middle.y_m / middle.x_m;
    const auto board = sectors_between(scan, u_px - 30, u_px + 30);
    ASSERT_GE(board.size(), 10U);
    for (const std::size_t i : board) {
      EXPECT_EQ(scan.states[i], SectorState::obstacle) << i;
      EXPECT_NEAR(scan.ranges_m[i], std::hypot(middle.x_m, middle.y_m), 0.4) << i;
    }
  }
}

TEST(Scanner, ForgetsWhenTheMotionIsNotKnown) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(10.0, 1.6, 280, 380);
  Scanner scanner;
  next_scan(scanner, drawn);
  const Scan lost = next_scan(scanner, Drawn()), after = next_scan(scanner, Drawn(), PlanarMotion());
  ASSERT_FALSE(lost.empty() || after.empty());
  for (const SectorState state : lost.states) EXPECT_EQ(state, SectorState::unknown);
  for (const SectorState state : after.states) EXPECT_EQ(state, SectorState::unknown);
}

TEST(Scanner, LetsGoOfWhatLeftWithinThreePairs) {
  Drawn with, without;
  with.paint_road();
  without.paint_road();
  for (Drawn* drawn : {&with, &without}) drawn->paint_board(30.0, 2.0, 100, 600);  // a wall behind
  with.paint_board(10.0, 1.6, 280, 380);
  Scanner scanner;
  const PlanarMotion still;
  for (int i = 0; i < 5; ++i) next_scan(scanner, with, still);
  Scan scan;
  for (int i = 0; i < 3; ++i) scan = next_scan(scanner, without, still);
  const auto wall = sectors_between(scan, 250, 400);
  ASSERT_GE(wall.size(), 25U);
  for (const std::size_t i : wall) EXPECT_NEAR(scan.ranges_m[i], 30.0, 3.0) << i;
}

TEST(Scan, AFlyAloneIsEvidence) {
  // Without texture the cells say nothing; fit flies do.
  Population flies;
  for (int i = 0; i < 400; ++i) flies.push_back({9.0, 0.3 * (i % 5 - 2), 0.4 + 0.01 * (i % 100)}, 2.0F);
  ScanOptions options;
  options.evidence.fly = 0.1;
  const Drawn uniform;
  const Scan scan = flies::scan(uniform.pair(), Projection(camera()), {}, flies, {}, options);
  const auto ahead = sectors_between(scan, 310, 330);
  ASSERT_FALSE(ahead.empty());
  for (const std::size_t i : ahead) {
    EXPECT_EQ(scan.states[i], SectorState::obstacle);
    EXPECT_NEAR(scan.ranges_m[i], 9.0, 0.5);
  }
}

TEST(CheckScanOptions, RefusesEmptyIntervals) {
  EXPECT_THAT([] { check_scan_options({.x_min_m = 9.0, .x_max_m = 8.0}, "options"); },
              ThrowsMessage<InputError>(HasSubstr("scan.x_min_m")));
  EXPECT_THAT([] { check_scan_options({.z_min_m = 3.0}, "options"); },
              ThrowsMessage<InputError>(HasSubstr("scan.z_min_m")));
}

TEST(Scan, KnowsNothingOfDirectionsInWhichSomethingIsTooNear) {
  Drawn drawn;
  drawn.paint_road();
  drawn.paint_board(12.5, 2.0, 60, 200);
  drawn.paint_board(1.6, 2.0, 330, 560);  // 125 px; the near end, 3.5 m, is at 57
  const Scan scan = drawn.scan();
  for (const auto sector : sectors_between(scan, 340, 540)) EXPECT_EQ(scan.states[sector], SectorState::unknown);
  for (const auto sector : sectors_between(scan, 80, 180))
    EXPECT_NEAR(scan.ranges_m[sector], 12.5 / std::cos(scan.angle_rad(sector)), 0.3);
  Drawn plain;
  plain.paint_road();
  plain.paint_board(4.0, 2.0, 330, 560);
  const Scan at_the_end = plain.scan();
  for (const auto sector : sectors_between(at_the_end, 340, 540))
    EXPECT_NEAR(at_the_end.ranges_m[sector], 4.0 / std::cos(at_the_end.angle_rad(sector)), 0.3);
}

}  // namespace
}  // namespace flies
