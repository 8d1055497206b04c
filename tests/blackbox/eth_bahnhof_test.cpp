#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstddef>

#include "flies/eval/foot_truth.hpp"
#include "flies/io/calibration.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

constexpr const char* kFolder = "eth_bahnhof/rectified";
constexpr double kCameraHeight_m = 0.98;  // of the pushchair the data was recorded from
constexpr double kMinRange_m = 3.0;       // the nearest of the three people walks at 4.7 m
// What docs/people.md publishes.
constexpr int kPeople = 15;  // three a pair
// A sandwich board in all pairs; the others are people farther away whom the truth leaves out.
constexpr int kMaxUnlabelled = 13;

TEST(BlackBoxEthBahnhof, ReportsAllNearPeopleAsPedestrians) {
  const auto folder = find_data(kFolder);
  if (!folder) GTEST_SKIP() << absence(kFolder);
  CalibrationRequest request;
  request.camera_height_m = kCameraHeight_m;
  const auto camera = load_calibration((*folder / "extrinsics.yml").string(), request).camera;
  Detector detector(camera);
  MatchOptions options;
  options.min_range_m = kMinRange_m;

  std::vector<ScoredFrame> frames;
  for (auto& truth : read_foot_points(*folder / "truth.csv", camera)) {
    truth.name = fmt::format("{}", truth.frame);
    const auto image = [&](int side) { return *folder / fmt::format("image_{:08}_{}.png", truth.frame, side); };
    const auto left = image(0), right = image(1);
    frames.push_back(detect_and_score(detector, left, right, std::move(truth), options));
  }
  ASSERT_FALSE(frames.empty());
  print_table("ETH Bahnhof, obstacles", tabulate(frames));

  const PeopleCount people = count_people(frames);
  EXPECT_EQ(people.wanted, kPeople);
  EXPECT_EQ(people.found, kPeople);
  EXPECT_LE(people.false_alarms, kMaxUnlabelled);

  for (auto& frame : frames) frame.score = score_frame(frame.truth, as_obstacles(frame.detection.pedestrians), options);
  print_table("ETH Bahnhof, pedestrians", tabulate(frames));
}

}  // namespace
}  // namespace flies::blackbox
