#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "flies/core/quantile.hpp"
#include "flies/eval/kitti_motion.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/track_measures.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/pipeline/tracker.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

// What docs/dynamic.md publishes, for each of three seeds: 159 of 159 objects with a track, no switch, no fragment,
// errors of moving things 0.31 to 0.32 and 0.51 to 0.52 m/s, none of 43 standing things said to move, of tracks on no
// label up to 1.5 %. One object more may be missed, errors may be a tenth larger, and 2 % are what is aimed at.
constexpr int kObjects = 159;
constexpr int kMaxMissed = 1;
constexpr double kMaxMedianError_mps = 0.35, kMaxError90_mps = 0.57;
constexpr int kStanding = 43;
constexpr double kMaxUnlabelledMotion = 0.02;
constexpr const char* kDay = "kitti_raw/2011_09_26";
constexpr const char* kDrive = "2011_09_26_drive_0005_sync";

TEST(BlackBoxKittiTrack, FollowsTheRoadUsers) {
  const auto day = find_data(kDay);
  if (!day) GTEST_SKIP() << absence(kDay);
  const auto drive = *day / kDrive;
  CalibrationRequest request;
  request.cameras = {0, 1};
  const StereoCamera camera = load_calibration((*day / "calib_cam_to_cam.txt").string(), request).camera;
  Tracker tracker(camera);
  const auto motion = read_kitti_motion(drive);
  auto truth = read_kitti_drive(drive, camera, 0);
  ASSERT_GE(motion.size(), truth.size());
  ASSERT_GE(truth.size(), 2U);
  // Even times: see kitti_ego_test.cpp.
  const double interval_s = motion[truth.size() - 1].time_s / static_cast<double>(truth.size() - 1);

  std::vector<TrackedTruth> frames;
  std::size_t reported = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::string file = truth[i].name + ".png";
    const GrayPair images =
        load_pair((drive / "image_00/data" / file).string(), (drive / "image_01/data" / file).string());
    TrackedTruth frame;
    frame.truth = std::move(truth[i]);
    frame.tracks = tracker.process(images.view(), static_cast<double>(i) * interval_s).tracks;
    if (i > 0) {
      const auto &a = motion[i - 1], &b = motion[i];
      frame.true_ego = given_ego_motion(interval_s, (a.vx_mps + b.vx_mps) / 2, (a.vy_mps + b.vy_mps) / 2,
                                        (a.yaw_rate_rps + b.yaw_rate_rps) / 2);
    }
    reported += frame.tracks.size();
    frames.push_back(std::move(frame));
  }
  const TrackMeasures m = measure_tracks(frames);
  std::printf("drive 0005, tracks: %.1f a pair, recall %d/%d, identity switches %d, fragments %d\n",
              static_cast<double>(reported) / static_cast<double>(frames.size()), m.found, m.objects,
              m.identity_switches, m.fragments);
  ASSERT_FALSE(m.moving_errors_mps.empty() || m.standing_errors_mps.empty());
  const double median_mps = quantile(m.moving_errors_mps, 0.5), error90_mps = quantile(m.moving_errors_mps, 0.9);
  std::printf("velocity error m/s, median and 90 %%: moving %.2f %.2f (%zu), standing %.2f %.2f (%zu)\n", median_mps,
              error90_mps, m.moving_errors_mps.size(), quantile(m.standing_errors_mps, 0.5),
              quantile(m.standing_errors_mps, 0.9), m.standing_errors_mps.size());
  std::printf("faster than 1 m/s: %d of %d labelled standing, %d of %d unlabelled\n", m.false_motion, m.standing,
              m.unlabelled_moving, m.unlabelled);
  EXPECT_EQ(m.objects, kObjects);
  EXPECT_GE(m.found, kObjects - kMaxMissed);
  EXPECT_EQ(m.identity_switches, 0);
  EXPECT_EQ(m.fragments, 0);
  EXPECT_LE(median_mps, kMaxMedianError_mps);
  EXPECT_LE(error90_mps, kMaxError90_mps);
  EXPECT_GE(m.standing, kStanding - kMaxMissed);
  EXPECT_EQ(m.false_motion, 0) << "one would be more than the 2 % aimed at";
  ASSERT_GT(m.unlabelled, 0);
  EXPECT_LE(m.unlabelled_moving, kMaxUnlabelledMotion * m.unlabelled);
}

}  // namespace
}  // namespace flies::blackbox
