#include "flies/eval/sequence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/core/random.hpp"
#include "flies/eval/measures.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth_px = 480, kHeight_px = 200, kPairs = 14;

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

/// A backdrop of noise at three depths and a board 10 m ahead (20 px), 1 m wide, shifted to the left.
GrayPair picture(int shift_px) {
  GrayPair pair;
  for (GrayImage* image : {&pair.left, &pair.right}) {
    image->width_px = kWidth_px;
    image->height_px = kHeight_px;
    image->pixels.assign(kWidth_px * kHeight_px, 120);
  }
  const auto put = [&](int u, int v, int disparity_px, std::uint32_t layer, int texture_u) {
    const auto gray = static_cast<std::uint8_t>(
        FlyRandom(8, layer, static_cast<std::uint32_t>(v / 4), static_cast<std::uint32_t>(texture_u / 4)).below(256));
    pair.left.pixels[static_cast<std::size_t>(v * kWidth_px + u)] = gray;
    if (u >= disparity_px) pair.right.pixels[static_cast<std::size_t>(v * kWidth_px + u - disparity_px)] = gray;
  };
  for (int v = 0; v < 76; ++v)
    for (int u = 0; u < kWidth_px; ++u) put(u, v, u < 150 ? 14 : u < 330 ? 6 : 10, 0, u);
  for (int v = 76; v < 140; ++v)
    for (int u = 220; u < 260; ++u) put(u - shift_px, v, 20, 1, u);
  return pair;
}

/// The board goes to the left by 8 px, 0.2 m, a pair, which is 0.1 s; the camera stands.
Dataset board() {
  Dataset dataset{.is_sequence = true};
  dataset.pairs.resize(kPairs);
  for (int i = 0; i < kPairs; ++i) {
    dataset.times_s.push_back(0.1 * i);
    dataset.true_ego.push_back(i == 0 ? EgoMotion{} : given_ego_motion(0.1, 0.0, 0.0, 0.0));
  }
  dataset.load = [](std::size_t i) {
    TruthFrame frame{picture(8 * static_cast<int>(i)), camera(), {}};
    LabelledObject object;
    object.type = "Car";
    object.track = 4;
    object.footprint = {10.05, 0.2 * static_cast<double>(i), 0.0, 0.1, 1.0};
    object.height_m = 1.5;
    frame.truth.objects = {object};
    return frame;
  };
  return dataset;
}

TEST(EvaluateSequence, FollowsAMovingBoardBeforeAStandingCamera) {
  std::size_t told = 0;
  const auto result =
      evaluate_sequence(board(), 0, kPairs, {}, {}, nullptr, {}, [&](std::size_t done) { told = done; });
  EXPECT_EQ(told, static_cast<std::size_t>(kPairs));
  EXPECT_EQ(result.pairs, static_cast<std::size_t>(kPairs));
  EXPECT_NEAR(result.duration_s, 1.3, 1e-9);
  EXPECT_EQ(result.tracks.objects, kPairs);
  EXPECT_EQ(result.tracks.found, kPairs);
  EXPECT_EQ(result.tracks.identity_switches, 0);
  ASSERT_EQ(result.tracks.first_report_s.size(), 1U);
  EXPECT_EQ(result.tracks.first_report_s[0], 0.0);
  ASSERT_FALSE(result.tracks.moving_errors_mps.empty());
  EXPECT_LT(*median(result.tracks.moving_errors_mps), 0.6);
  EXPECT_EQ(result.tracks.first_velocity_s.size(), 1U);
  EXPECT_EQ(result.ego.pairs, kPairs - 1);
  EXPECT_EQ(result.ego.lost, 0);
  EXPECT_TRUE(result.ego.speed_errors.empty()) << "it stands";
  EXPECT_LT(*median(result.ego.yaw_rate_errors_rps), 0.02);
  EXPECT_EQ(result.scan.size(), result.single_scan.size());
  EXPECT_EQ(result.times_ms.size(), result.pairs);
}

TEST(EvaluateSequence, TakesTheFirstPairAsTheBeginning) {
  const auto result = evaluate_sequence(board(), 4, 7, {}, {}, nullptr);
  EXPECT_EQ(result.pairs, 3U);
  EXPECT_EQ(result.ego.pairs, 2);
  EXPECT_NEAR(result.duration_s, 0.2, 1e-9);
}

TEST(EvaluateSequence, AsksForTimesAndMotions) {
  Dataset dataset = board();
  EXPECT_TRUE(is_followable(dataset));
  dataset.true_ego.clear();
  EXPECT_FALSE(is_followable(dataset));
  EXPECT_THAT([&] { evaluate_sequence(dataset, 0, 2, {}, {}, nullptr); }, ThrowsMessage<InputError>(HasSubstr("oxts")));
}

}  // namespace
}  // namespace flies
