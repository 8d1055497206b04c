#include "flies/ego/ego_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/random.hpp"
#include "flies/ego/solve_pose.hpp"

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

StereoCamera camera() {
  return {.fx_px = 720,
          .fy_px = 720,
          .cx_px = 620,
          .cx_right_px = 620,
          .cy_px = 180,
          .baseline_m = 0.54,
          .width_px = 1242,
          .height_px = 375,
          .mount = {.height_m = 1.65, .pitch_rad = 0.02, .roll_rad = 0.01}};
}

/// Corners of a street seen before and after a motion, with noise, a part of them on things that move themselves.
std::vector<ego::FollowedCorner> corners_of(const ego::CameraMotion& motion, int count, double noise_px,
                                            double moving_share, std::uint32_t trial) {
  const StereoCamera c = camera();
  std::vector<ego::FollowedCorner> corners;
  for (int i = 0; i < count; ++i) {
    FlyRandom random(3, 0, trial, static_cast<std::uint32_t>(i));
    const double z = 1.0 / random.uniform(1.0 / 40.0, 1.0 / 5.0);
    const cv::Vec3d before((random.uniform(0, 1242) - 620) / 720 * z, (random.uniform(0, 375) - 180) / 720 * z, z);
    cv::Vec3d now = motion.rotation * before + motion.shift_m;
    if (random.uniform() < moving_share) now += cv::Vec3d(0.6, 0.0, -0.4);  // one thing, all its corners alike
    corners.push_back({before,
                       {c.cx_px + c.fx_px * now[0] / now[2] + noise_px * random.normal(),
                        c.cy_px + c.fy_px * now[1] / now[2] + noise_px * random.normal()}});
  }
  return corners;
}

ego::CameraMotion drive_ahead() {
  const double yaw = 0.03;
  return {cv::Matx33d(std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw)), {0.02, 0.01, -0.8}};
}

constexpr ego::Pinhole kPinhole{720, 720, 620, 180};

TEST(SolvePose, FindsTheMotionWhenAThirdOfTheCornersMoves) {
  const auto truth = drive_ahead();
  const auto found = ego::solve_pose(corners_of(truth, 300, 0.2, 0.33, 1), kPinhole, {}, {}, 0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->motion.shift_m[2], -0.8, 0.02);
  EXPECT_NEAR(found->motion.shift_m[0], 0.02, 0.02);
  EXPECT_NEAR(found->motion.rotation(0, 2), truth.rotation(0, 2), 0.0005);
}

// The normalised squared error of six parameters is 6 on average when the covariance is right.
TEST(SolvePose, ItsCovarianceHasTheSizeOfItsErrors) {
  const auto truth = drive_ahead();
  constexpr int kTrials = 200;
  double sum = 0.0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    const auto found = ego::solve_pose(corners_of(truth, 200, 0.2, 0.0, trial), kPinhole, truth, {}, trial);
    ASSERT_TRUE(found);
    const cv::Matx33d turn = found->motion.rotation * truth.rotation.t();
    const cv::Vec3d shift = found->motion.shift_m - truth.shift_m;
    const cv::Matx61d error(turn(2, 1), turn(0, 2), turn(1, 0), shift[0], shift[1], shift[2]);
    sum += (error.t() * found->covariance.inv() * error)(0, 0);
  }
  EXPECT_GT(sum / kTrials, 4.5);
  EXPECT_LT(sum / kTrials, 8.0);
}

TEST(SolvePose, SaysNothingOfTwoCorners) {
  EXPECT_FALSE(ego::solve_pose(corners_of({}, 2, 0.0, 0.0, 1), kPinhole, {}, {}, 0));
}

/// The same corners with the depth that they seem to have when all disparities are too small by a shift.
std::vector<ego::FollowedCorner> seen_with_shift(std::vector<ego::FollowedCorner> corners, double shift_px) {
  constexpr double kScale_px_m = 720 * 0.54;
  for (auto& corner : corners) {
    const double true_px = kScale_px_m / corner.before_m[2];
    corner.before_m *= true_px / (true_px - shift_px);
  }
  return corners;
}

TEST(SolveDisparityShift, FindsWhatIsAddedToAllDisparities) {
  constexpr double kScale_px_m = 720 * 0.54;  // corners at 10 to 78 px
  for (const double shift_px : {-12.0, -5.0, 0.0, 5.0, 8.0}) {
    const auto corners = seen_with_shift(corners_of(drive_ahead(), 300, 0.2, 0.2, 1), shift_px);
    const auto motion = ego::solve_pose(corners, kPinhole, {}, {}, 0);
    ASSERT_TRUE(motion);
    const auto found = ego::solve_disparity_shift(corners, kPinhole, kScale_px_m, motion->motion, {});
    ASSERT_TRUE(found) << shift_px;
    EXPECT_NEAR(found->shift_px, shift_px, 0.5) << "+-" << found->deviation_px;
    EXPECT_LT(found->deviation_px, 0.5);
    EXPECT_GT(found->agreeing, 200);
  }
}

TEST(SolveDisparityShift, ItsDeviationHasTheSizeOfItsErrors) {
  constexpr int kTrials = 100;
  double sum = 0.0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    const auto corners = seen_with_shift(corners_of(drive_ahead(), 200, 0.2, 0.0, trial), 4.0);
    const auto motion = ego::solve_pose(corners, kPinhole, drive_ahead(), {}, trial);
    ASSERT_TRUE(motion);
    const auto found = ego::solve_disparity_shift(corners, kPinhole, 720 * 0.54, motion->motion, {});
    ASSERT_TRUE(found);
    sum += std::pow((found->shift_px - 4.0) / found->deviation_px, 2);
  }
  EXPECT_GT(sum / kTrials, 0.6);
  EXPECT_LT(sum / kTrials, 1.6);
}

TEST(SolveDisparityShift, IsNotToldByACameraThatStandsOrTurns) {
  const double yaw = 0.03;
  const ego::CameraMotion turn{cv::Matx33d(std::cos(yaw), 0, std::sin(yaw), 0, 1, 0, -std::sin(yaw), 0, std::cos(yaw)),
                               {}};
  for (const auto& motion : {ego::CameraMotion{}, turn}) {
    const auto corners = corners_of(motion, 300, 0.2, 0.0, 1);
    const auto found = ego::solve_disparity_shift(corners, kPinhole, 720 * 0.54, motion, {});
    EXPECT_TRUE(!found || !(found->deviation_px < 0.5)) << found->shift_px << " +- " << found->deviation_px;
  }
}

TEST(GivenEgoMotion, TurnsThePointsThatStandStill) {
  const double quarter = std::acos(-1.0) / 2;
  const auto ego = given_ego_motion(1.0, 0.0, 0.0, quarter);  // turns to the left on the spot
  const Point3 now = ego.current_from_previous({10, 0, 1});
  EXPECT_NEAR(now.x_m, 0.0, 1e-9);
  EXPECT_NEAR(now.y_m, -10.0, 1e-9);
  EXPECT_NEAR(now.z_m, 1.0, 1e-9);
  const auto back = ego.current_from_previous.inverse()(now);
  EXPECT_NEAR(back.x_m, 10.0, 1e-9);
  EXPECT_TRUE(given_ego_motion(0.5, 8.0, 0.0, 0.0).is_known);
  EXPECT_NEAR(given_ego_motion(0.5, 8.0, 0.0, 0.0).current_from_previous({10, 2, 0}).x_m, 6.0, 1e-9);
  EXPECT_FALSE(given_ego_motion(0.0, 8.0, 0.0, 0.0).is_known);
}

TEST(GivenEgoMotion, RefusesWhatNoCameraDoes) {
  const auto complaint = [](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kEndless = std::numeric_limits<double>::infinity();
  for (const double dt_s : {kNan, kEndless, 1e-300, 1e6})
    EXPECT_THAT(complaint([&] { given_ego_motion(dt_s, 0, 0, 0); }), HasSubstr("given motion: dt_s: found")) << dt_s;
  for (const double wrong : {kNan, kEndless, -kEndless, 500.0, -1e300}) {
    EXPECT_THAT(complaint([&] { given_ego_motion(0.1, wrong, 0, 0); }), HasSubstr("vx_mps: found")) << wrong;
    EXPECT_THAT(complaint([&] { given_ego_motion(0.1, 0, wrong, 0); }), HasSubstr("vy_mps: found")) << wrong;
    EXPECT_THAT(complaint([&] { given_ego_motion(0.1, 0, 0, wrong); }), HasSubstr("yaw_rate_rps: found")) << wrong;
    EXPECT_THAT(complaint([&] {
                  given_ego_motion(0.1, 0, 0, 0, {0, wrong, 0});
                }),
                HasSubstr("standard_deviations[1]: found"))
        << wrong;
  }
  EXPECT_EQ(complaint([&] { given_ego_motion(0.1, 400.0, -400.0, -100.0, {1, 1, 1}); }), "none");
  EXPECT_FALSE(given_ego_motion(-0.1, 8.0, 0.0, 0.0).is_known);
}

TEST(CheckEgoMotion, KnowsWhatIsNoTurnAndNoWay) {
  EgoMotion turned = given_ego_motion(0.1, 3.0, 0.0, 0.1);
  EXPECT_NO_THROW(detail::check_ego_motion(turned, "sensor"));
  turned.current_from_previous.rotation[0][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { detail::check_ego_motion(turned, "sensor"); },
              ThrowsMessage<InputError>(HasSubstr("sensor: current_from_previous.rotation")));
  turned.current_from_previous.rotation[0][0] = 0.5;
  EXPECT_THAT([&] { detail::check_ego_motion(turned, "sensor"); },
              ThrowsMessage<InputError>(HasSubstr("sensor: current_from_previous.rotation")));
  EgoMotion moved = given_ego_motion(0.1, 3.0, 0.0, 0.1);
  moved.current_from_previous.shift.z_m = 300.0;
  EXPECT_THAT([&] { detail::check_ego_motion(moved, "sensor"); },
              ThrowsMessage<InputError>(HasSubstr("sensor: current_from_previous.shift: found 300 m in 0.1 s")));
  EgoMotion unsure = given_ego_motion(0.1, 3.0, 0.0, 0.1);
  unsure.covariance[0][1] = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { detail::check_ego_motion(unsure, "sensor"); },
              ThrowsMessage<InputError>(HasSubstr("sensor: covariance[0][1]")));
}

/// Planes of noise at three depths, shifted to where a camera sees them that has moved `shift_px` per pixel of
/// disparity.
struct NoisePair {
  std::vector<std::uint8_t> left, right;

  NoisePair(double moved_m, std::uint32_t seed) : left(1242 * 375), right(1242 * 375) {
    const StereoCamera c = camera();
    for (int v = 0; v < 375; ++v) {
      const double depth_m = v < 125 ? 20.0 : v < 250 ? 12.0 : 8.0;
      for (int u = 0; u < 1242; ++u) {
        const double x_m = (u - 620) / c.fx_px * depth_m + moved_m;
        const double baseline_m = c.baseline_m;
        const auto at = static_cast<std::size_t>(v * 1242 + u);
        left[at] = gray(x_m, v, depth_m, seed);
        right[at] = gray(x_m + baseline_m, v, depth_m, seed);
      }
    }
  }
  /// Smooth noise of 4 px cells.
  static std::uint8_t gray(double x_m, int v, double depth_m, std::uint32_t seed) {
    const double cell = x_m / depth_m * 720 / 4 + 1000, left_cell = std::floor(cell);
    const auto value = [&](double column) {
      return FlyRandom(seed, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(v / 4), 0).uniform(20, 235);
    };
    const double share = cell - left_cell;
    return static_cast<std::uint8_t>(value(left_cell) * (1 - share) + value(left_cell + 1) * share);
  }
  RectifiedPair pair() const { return {{left.data(), 1242, 375, 1242}, {right.data(), 1242, 375, 1242}}; }
};

TEST(EgoEstimator, MeasuresAStepToTheRight) {
  EgoEstimator estimator(camera());
  EXPECT_FALSE(estimator.follow(NoisePair(0.0, 5).pair(), 10.0).is_known) << "one pair shows no motion";
  const EgoMotion ego = estimator.follow(NoisePair(0.2, 5).pair(), 10.1);
  ASSERT_TRUE(ego.is_known);
  EXPECT_NEAR(ego.dt_s, 0.1, 1e-9);
  // The planes carry their texture along in v only, so that the step is all there is.
  EXPECT_NEAR(std::hypot(ego.vx_mps, ego.vy_mps), 2.0, 0.1);
  EXPECT_LT(ego.vy_mps, -1.9);
  EXPECT_NEAR(ego.yaw_rate_rps, 0.0, 0.02);
  EXPECT_GT(ego.covariance[0][0], 0.0);
}

TEST(EgoEstimator, IsLostAcrossACutAndFindsItsWayAgain) {
  EgoEstimator estimator(camera());
  estimator.follow(NoisePair(0.0, 5).pair(), 0.0);
  const EgoMotion cut = estimator.follow(NoisePair(0.0, 6).pair(), 0.1);
  EXPECT_FALSE(cut.is_known);
  EXPECT_EQ(cut.vx_mps, 0.0);
  EXPECT_TRUE(estimator.follow(NoisePair(0.1, 6).pair(), 0.2).is_known);
}

TEST(EgoEstimator, IsLostWithoutTexture) {
  const std::vector<std::uint8_t> gray(1242 * 375, 90);
  const GrayView view{gray.data(), 1242, 375, 1242};
  EgoEstimator estimator(camera());
  estimator.follow({view, view}, 0.0);
  EXPECT_FALSE(estimator.follow({view, view}, 0.1).is_known);
}

TEST(EgoEstimator, RefusesTimeThatStandsStill) {
  const NoisePair pair(0.0, 5);
  EgoEstimator estimator(camera());
  estimator.follow(pair.pair(), 1.0);
  EXPECT_THAT([&] { estimator.follow(pair.pair(), 1.0); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
  EXPECT_THAT([&] { estimator.skip(0.5); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
  EXPECT_THAT([&] { estimator.follow({}, 2.0); }, ThrowsMessage<InputError>(HasSubstr("left image")));
}

TEST(EgoEstimator, GivesNumbersOrNoMotionHoweverLongTheStep) {
  const NoisePair pair(0.0, 5);
  EgoEstimator estimator(camera());
  estimator.follow(pair.pair(), 0.0);
  EXPECT_THAT([&] { estimator.follow(pair.pair(), 1e-300); }, ThrowsMessage<InputError>(HasSubstr("time_s")));
  const EgoMotion soon = estimator.follow(pair.pair(), 1e-8);
  EXPECT_TRUE(soon.is_known);
  EXPECT_TRUE(std::isfinite(soon.vx_mps) && std::isfinite(soon.covariance[0][0]));
  EXPECT_TRUE(estimator.follow(pair.pair(), 3600.0).is_known);
  EXPECT_FALSE(estimator.follow(pair.pair(), 1.7e9).is_known) << "a clock was set";
  EXPECT_TRUE(estimator.follow(pair.pair(), 1.7e9 + 0.1).is_known);
}

TEST(EgoEstimator, SaysThatItWasMovedFrom) {
  const NoisePair pair(0.0, 5);
  EgoEstimator estimator(camera());
  estimator.follow(pair.pair(), 0.0);
  EgoEstimator other = std::move(estimator);
  EXPECT_TRUE(other.follow(pair.pair(), 0.1).is_known);
  EXPECT_THROW(estimator.follow(pair.pair(), 0.1), std::logic_error);  // NOLINT(bugprone-use-after-move)
  EXPECT_THROW(estimator.skip(0.1), std::logic_error);
  EXPECT_THROW(estimator.last_time_s(), std::logic_error);
  estimator = EgoEstimator(camera());
  EXPECT_FALSE(estimator.follow(pair.pair(), 0.0).is_known);
}

TEST(EgoEstimator, TakesAnImageOfOnePixel) {
  StereoCamera tiny = camera();
  tiny.width_px = tiny.height_px = 1;
  tiny.fx_px = tiny.fy_px = 1;
  tiny.cx_px = tiny.cx_right_px = tiny.cy_px = 0;
  const std::uint8_t pixel = 7;
  const GrayView view{&pixel, 1, 1, 1};
  EgoEstimator estimator(tiny);
  estimator.follow({view, view}, 0.0);
  EXPECT_FALSE(estimator.follow({view, view}, 0.1).is_known);
}

}  // namespace
}  // namespace flies
