#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "flies/eval/foot_truth.hpp"
#include "flies/eval/people.hpp"
#include "flies/io/calibration.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

constexpr const char* kFolder = "eth_bahnhof/rectified";
constexpr double kCameraHeight_m = 0.98;  // of the pushchair the data was recorded from
constexpr double kMinRange_m = 3.0;       // the nearest of the three people walks at 4.7 m
// What docs/people.md publishes.
constexpr int kPeople = 15;  // three a pair
constexpr int kThings = 7;   // a sandwich board in every pair, and in two a tree trunk or two

/// Whom the truth leaves out, and what is taken for a person: middles of boxes in the left image, which the pushchair
/// moves little.
struct Known {
  double u_px, v_px;
};
constexpr Known kPeopleLeftOut[] = {
    {616, 224}, {229, 226}, {288, 228}};  // by the trees, behind the nearer man, far off
constexpr Known kThingsTakenForPeople[] = {{187, 239}, {393, 236}, {431, 240}};  // the board, trunks

template <std::size_t size>
bool is_one_of(const Known (&known)[size], const ImageBox& box) {
  constexpr double kReach_px = 15.0;
  return std::any_of(std::begin(known), std::end(known), [&](const Known& place) {
    return std::hypot(box.u_px + box.width_px / 2.0 - place.u_px, box.v_px + box.height_px / 2.0 - place.v_px) <
           kReach_px;
  });
}

/// Reports of nobody who is labelled.
struct FalseReports {
  int things = 0;
  std::vector<std::string> unknown;  ///< neither those nor the people who were left out
};

FalseReports false_reports(const std::vector<ScoredFrame>& frames) {
  FalseReports reports;
  for (const auto& frame : frames)
    for (const auto& verdict : score_people(frame.truth, frame.detection.pedestrians).verdicts) {
      const ImageBox& box = verdict.person.box;
      if (verdict.kind != PersonVerdict::Kind::false_alarm || is_one_of(kPeopleLeftOut, box)) continue;
      if (is_one_of(kThingsTakenForPeople, box))
        ++reports.things;
      else
        reports.unknown.push_back(fmt::format("{}: {:.0f}, {:.0f}", frame.truth.name, box.u_px + box.width_px / 2.0,
                                              box.v_px + box.height_px / 2.0));
    }
  return reports;
}

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
  const FalseReports reports = false_reports(frames);
  EXPECT_LE(reports.things, kThings);
  EXPECT_THAT(reports.unknown, ::testing::IsEmpty());

  for (auto& frame : frames) frame.score = score_frame(frame.truth, as_obstacles(frame.detection.pedestrians), options);
  print_table("ETH Bahnhof, pedestrians", tabulate(frames));
}

}  // namespace
}  // namespace flies::blackbox
