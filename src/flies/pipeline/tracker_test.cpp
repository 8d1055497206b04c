#include "flies/pipeline/tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 480, kHeight_px = 200;

StereoCamera camera() {
  return {.fx_px = 400,
          .fy_px = 400,
          .cx_px = 240,
          .cx_right_px = 240,
          .cy_px = 80,
          .baseline_m = 0.5,
          .width_px = kWidth_px,
          .height_px = kHeight_px,
          .mount = {.height_m = 1.5}};
}

/// A backdrop of noise in the upper half, at three depths so that no turn of the camera looks like a step aside, and a
/// board 10 m ahead (20 px) shifted to the left by `shift_px`.
struct Scene {
  std::vector<std::uint8_t> left, right;

  explicit Scene(int shift_px, std::uint64_t seed = 8)
      : left(kWidth_px * kHeight_px, 120), right(kWidth_px * kHeight_px, 120) {
    const auto put = [&](int u, int v, int disparity_px, std::uint32_t layer, int texture_u) {
      const auto gray = static_cast<std::uint8_t>(
          FlyRandom(seed, layer, static_cast<std::uint32_t>(v / 4), static_cast<std::uint32_t>(texture_u / 4))
              .below(256));
      left[static_cast<std::size_t>(v * kWidth_px + u)] = gray;
      if (u >= disparity_px) right[static_cast<std::size_t>(v * kWidth_px + u - disparity_px)] = gray;
    };
    for (int v = 0; v < 76; ++v)
      for (int u = 0; u < kWidth_px; ++u) put(u, v, u < 150 ? 14 : u < 330 ? 6 : 10, 0, u);
    for (int v = 76; v < 140; ++v)
      for (int u = 220; u < 260; ++u) put(u - shift_px, v, 20, 1, u);
  }
  RectifiedPair pair() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

TEST(Tracker, GivesAMovingBoardItsVelocityBeforeAStandingBackdrop) {
  Tracker tracker(camera(), {}, {}, nullptr);  // none: noise may look like a person
  Tracking now;
  std::uint64_t id = 0;
  for (int i = 0; i < 12; ++i) {
    now = tracker.process(Scene(8 * i).pair(), 0.1 * i);  // 8 px at 10 m: 0.2 m in 0.1 s
    EXPECT_EQ(now.ego.is_known, i > 0);
    ASSERT_FALSE(now.tracks.empty()) << i;
    if (i == 0) id = now.tracks[0].id;
    EXPECT_EQ(now.tracks[0].id, id) << i;
  }
  EXPECT_LT(std::hypot(now.ego.vx_mps, now.ego.vy_mps), 0.2) << "the camera stands";
  EXPECT_NEAR(now.tracks[0].velocity.vy_mps, 2.0, 0.4);
  EXPECT_NEAR(now.tracks[0].velocity.vx_mps, 0.0, 0.6);
}

TEST(Tracker, ReportsNothingOfTheOldSceneAfterACut) {
  Tracker tracker(camera());
  for (int i = 0; i < 5; ++i) tracker.process(Scene(0).pair(), 0.1 * i);
  const std::vector<std::uint8_t> gray(kWidth_px * kHeight_px, 90);
  const GrayView view{gray.data(), kWidth_px, kHeight_px, kWidth_px};
  const auto after = tracker.process({view, view}, 0.5);
  EXPECT_FALSE(after.ego.is_known);
  EXPECT_TRUE(after.tracks.empty());
}

TEST(Tracker, TakesAMotionThatAnotherSensorKnows) {
  Tracker tracker(camera());
  tracker.process(Scene(0).pair(), 0.0);
  const auto now = tracker.process(Scene(0).pair(), 0.1, given_ego_motion(0.1, 3.0, 0.0, 0.0));
  EXPECT_EQ(now.ego.vx_mps, 3.0);
}

TEST(Tracker, RefusesTimeThatStandsStill) {
  Tracker tracker(camera());
  tracker.process(Scene(0).pair(), 1.0);
  EXPECT_THAT([&] { tracker.process(Scene(0).pair(), 1.0); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
}

}  // namespace
}  // namespace flies
