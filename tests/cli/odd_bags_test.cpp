// Bags that are not as they should be, or hold more than pairs: what is passed over, and what is told.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/record/ros_bytes.hpp"
#include "run_flies.hpp"
#include "street_bag.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

struct OddBags : ::testing::Test {
  RunResult track(const Topics& topics, std::vector<std::string> more = {}) const {
    write_bag(folder.path() / "drive.bag", topics);
    more.insert(more.begin(), {"track", "drive.bag", "--camera-height", "1.65", "--json", "-"});
    return run_flies(folder.path(), more);
  }
  static void sees_the_box(const RunResult& result) {
    ASSERT_EQ(result.status, 0) << result.err;
    ASSERT_EQ(lines(result.out).size(), static_cast<std::size_t>(kPairs));
    const json last = json::parse(lines(result.out).back());
    ASSERT_FALSE(last.at("obstacles").empty());
    EXPECT_NEAR(last["obstacles"][0]["x_m"].get<double>(), kBoxX_m, 1.0);
  }
  TestFolder folder;
};

/// Messages of the two camera_info, connections 2 and 3.
std::string camera_infos(std::uint64_t time_ns, double focal_factor) {
  const StereoCamera c = street_camera();
  const double focal_px = focal_factor * c.fx_px;
  return BagBytes::message(
             {2, time_ns, ros_camera_info(false, c.width_px, c.height_px, focal_px, 0.0, {}, c.cx_px, c.cy_px)}) +
         BagBytes::message({3, time_ns,
                            ros_camera_info(false, c.width_px, c.height_px, focal_px, -focal_px * c.baseline_m, {},
                                            c.cx_px, c.cy_px)});
}

TEST_F(OddBags, PicturesThatAreApartInTimeAreTold) {
  EXPECT_THAT(track({}).err, Not(HasSubstr("ms apart"))) << "1 ms does not matter";
  const RunResult apart = track({.right_delay_ns = 15'000'000U});
  EXPECT_EQ(apart.status, 0);
  EXPECT_THAT(apart.err, HasSubstr("drive.bag: left and right pictures are 15.0 ms apart (median of 3)"));
  const RunResult none = track({.right_delay_ns = 30'000'000U});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("are within 20 ms of each other; they are 30 ms apart (median)"));
}

TEST_F(OddBags, DepthBesidePicturesIsPassedOver) {
  std::string depth;
  std::uint32_t id = 4;
  for (const char* topic : {"/rig/left/image_raw/compressedDepth", "/rig/right/image_raw/compressedDepth"}) {
    depth += BagBytes::connection(id, topic, "sensor_msgs/CompressedImage");
    const auto message = RosBytes(false).header(1'700'000'000U, 0).text("16UC1; compressedDepth png").list("x").bytes();
    depth += BagBytes::message({id++, kStart_ns, message});
  }
  sees_the_box(track({.before = depth}));
  const RunResult named = track({.before = depth}, {"--topics",
                                                    "/rig/left/image_raw/compressedDepth,"
                                                    "/rig/right/image_raw/compressedDepth"});
  EXPECT_EQ(named.status, 2);
  EXPECT_THAT(named.err,
              HasSubstr("of types that flies does not read: /rig/left/image_raw/compressedDepth (compressedDepth)"));
}

TEST_F(OddBags, CalibrationThatChangesIsTold) {
  const std::string changed = camera_infos(kStart_ns + 900'000'000U, 0.7);
  const RunResult result = track({.after = BagBytes::chunk("none", changed, changed.size())});
  sees_the_box(result);
  EXPECT_THAT(result.err, HasSubstr("/rig/left/camera_info changes during the recording: fx in K ("));
  const auto c = street_camera();
  const std::string other_baseline = BagBytes::message(
      {3, kStart_ns + 900'000'000U,
       ros_camera_info(false, c.width_px, c.height_px, c.fx_px, -0.5 * c.fx_px * c.baseline_m, {}, c.cx_px, c.cy_px)});
  EXPECT_THAT(track({.after = BagBytes::chunk("none", other_baseline, other_baseline.size())}).err,
              HasSubstr(fmt::format("/rig/right/camera_info changes during the recording: Tx in P ({:g}, then {:g}); ",
                                    -c.fx_px * c.baseline_m, -0.5 * c.fx_px * c.baseline_m)));
  EXPECT_THAT(track({}).err, Not(HasSubstr("changes")));
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(track({.distortion = {none, 0, 0, 0, 0}}).err, Not(HasSubstr("changes")));
}

/// Messages of pictures, connections 0 and 1.
std::string pictures(std::uint64_t time_ns, bool has_right = true) {
  const auto& [left, right] = street_pair();
  const auto message = [&](std::uint32_t connection, const cv::Mat& picture) {
    return BagBytes::message(
        {connection, time_ns,
         ros_image(false, time_ns, picture.cols, picture.rows, "mono8", picture.cols, pixels_of(picture))});
  };
  return message(0, left) + (has_right ? message(1, right) : "");
}

TEST_F(OddBags, TimesAtARateJumpWherePairsAreMissing) {
  const auto times_of = [&](const std::string& more) {
    const RunResult result =
        track({.right_delay_ns = 0, .after = BagBytes::chunk("none", more, more.size())}, {"--rate", "5"});
    EXPECT_THAT(result.err, HasSubstr("drive.bag: pairs 2 and 3 are farther apart than others: pairs are missing"));
    std::vector<double> times_s;
    for (const auto& line : lines(result.out)) times_s.push_back(json::parse(line).at("time_s"));
    return times_s;
  };
  const auto jump = ::testing::Pointwise(::testing::DoubleNear(1e-9), {0.0, 0.2, 0.4, 0.8});
  EXPECT_THAT(times_of(pictures(kStart_ns + 400'000'000U)), jump) << "of both cameras, as the stamps say";
  EXPECT_THAT(times_of(pictures(kStart_ns + 330'000'000U, false) + pictures(kStart_ns + 450'000'000U)), jump)
      << "of one camera, where stamps are uneven";
  EXPECT_THAT(track({}, {"--rate", "5"}).err, Not(HasSubstr("missing")));
}

TEST_F(OddBags, CamerasThatAreNotCalibratedYetArePassedOver) {
  const RunResult result = track({.before = camera_infos(kStart_ns, 0.0)});
  sees_the_box(result);
  EXPECT_THAT(result.err, Not(HasSubstr("changes")));
}

TEST_F(OddBags, MosaicsOfColoursBecomeGrey) {
  const RunResult result = track({.encoding = "bayer_grbg8"});
  sees_the_box(result);
  EXPECT_THAT(result.err,
              HasSubstr("pictures of /rig/left/image_raw are Bayer mosaics (bayer_grbg8) and are converted to grey"));
}

TEST_F(OddBags, TimesOfAFileAreThoseOfThePicturesThatHaveAPartner) {
  const cv::Mat& left = street_pair().left;
  const std::uint64_t early_ns = kStart_ns - 100'000'000U;
  const Topics topics = {
      .before = BagBytes::message(
          {0, early_ns, ros_image(false, early_ns, left.cols, left.rows, "mono8", left.cols, pixels_of(left))})};
  const auto times_of = [&](const std::string& times) {
    write_text(folder.path() / "times.txt", times);
    const RunResult result = track(topics, {"--times", "times.txt"});
    std::vector<double> times_s;
    for (const auto& line : lines(result.out)) times_s.push_back(json::parse(line).at("time_s"));
    return std::pair(result, times_s);
  };
  const auto [by_number, times_s] = times_of("0\n1\n1.5\n1.75\n");
  EXPECT_THAT(times_s, ::testing::ElementsAre(0.0, 0.5, 0.75)) << by_number.err;
  EXPECT_THAT(by_number.err,
              HasSubstr("holds 4 times for 3 pairs: times are chosen by the numbers of the left pictures"));
  EXPECT_THAT(times_of("0\n1\n1.5\n").second, ::testing::ElementsAre(0.0, 1.0, 1.5));
  const RunResult others = times_of("0\n1\n2\n3\n4\n").first;
  EXPECT_EQ(others.status, 2);
  EXPECT_THAT(others.err, HasSubstr("times.txt: holds 5 times, expected 3, one per pair, or 4, one per left picture"));
}

}  // namespace
}  // namespace flies::testing
