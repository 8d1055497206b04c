#include "flies/draw/track_view.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace flies {
namespace {

Track track(std::uint64_t id, double x_m, double y_m, double vx_mps = 0.0) {
  Track t;
  t.id = id;
  t.state.x_m = x_m;
  t.state.y_m = y_m;
  t.velocity.vx_mps = vx_mps;
  t.width_m = 0.6;
  t.box = {300, 80, 40, 100};
  return t;
}

TrackedPicture picture(double time_s, std::vector<Track> tracks) {
  TrackedPicture p;
  p.left = cv::Mat(200, 640, CV_8UC1, cv::Scalar(90));
  p.time_s = time_s;
  p.ego = given_ego_motion(0.1, 10.0, 0.0, 0.0);
  p.tracks = std::move(tracks);
  return p;
}

TEST(TrackView, TrailsOfStandingThingsStayWhereTheThingsAre) {
  TrackView view;
  view.draw(picture(0.0, {track(1, 20, 2)}));
  view.draw(picture(0.1, {track(1, 19, 2)}));  // the camera came a metre nearer
  const auto& trail = view.trails().at(1);
  ASSERT_EQ(trail.size(), 2U);
  EXPECT_NEAR(trail[0].x_m, 19.0, 1e-9);
  EXPECT_NEAR(trail[1].x_m, 19.0, 1e-9);
}

TEST(TrackView, ForgetsOldStepsAndTracksThatEnded) {
  TrackView view(0.5);
  for (int i = 0; i < 20; ++i) view.draw(picture(0.1 * i, {track(1, 20, 2), track(2, 10, 0)}));
  EXPECT_EQ(view.trails().at(1).size(), 6U);
  view.draw(picture(2.0, {track(2, 10, 0)}));
  EXPECT_EQ(view.trails().size(), 1U);
}

TEST(TrackView, TrailsEndWhenTheCameraIsLost) {
  TrackView view;
  view.draw(picture(0.0, {track(1, 20, 2)}));
  auto lost = picture(0.1, {track(1, 20, 2)});
  lost.ego = {};
  view.draw(lost);
  EXPECT_EQ(view.trails().at(1).size(), 1U);
}

TEST(TrackView, AllPicturesHaveOneSizeAndMovingThingsStandOut) {
  TrackView view;
  const cv::Mat empty = view.draw(picture(0.0, {}));
  const cv::Mat full = view.draw(picture(0.1, {track(1, 20, 2, 5.0)}));
  EXPECT_EQ(empty.size(), full.size());
  EXPECT_EQ(full.at<cv::Vec3b>(100, 300), cv::Vec3b(0, 140, 255)) << "the left edge of its box";
  EXPECT_EQ(empty.at<cv::Vec3b>(100, 300), cv::Vec3b(90, 90, 90));
}

}  // namespace
}  // namespace flies
