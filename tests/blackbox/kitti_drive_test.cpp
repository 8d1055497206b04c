#include <gtest/gtest.h>

#include <algorithm>

#include "flies/eval/kitti_truth.hpp"
#include "flies/io/calibration.hpp"
#include "tests/blackbox/blackbox.hpp"

namespace flies::blackbox {
namespace {

// The promise of the preset `default`, a little below the medians of five seeds that README.md and docs/people.md
// publish: recall 1.000, precision 0.992, all people, 0.05 false alarms a pair.
constexpr double kMinFound = 0.99;       // every road user of drive 0005 in nearly every frame
constexpr double kMinPrecision = 0.985;  // of all obstacles against lidar
constexpr int kPeople = 4;               // one, in frames 0 to 3
constexpr int kMaxFalsePeople = 4;       // in 60 pairs
constexpr const char* kDay = "kitti_raw/2011_09_26";
constexpr const char* kDrive = "2011_09_26_drive_0005_sync";
constexpr const char* kMustFind[] = {"Cyclist 1", "Pedestrian 2", "Van 0", "Van 3"};

TEST(BlackBoxKittiDrive, FindsEveryRoadUser) {
  const auto day = find_data(kDay);
  if (!day) GTEST_SKIP() << absence(kDay);
  const auto drive = *day / kDrive;
  CalibrationRequest request;
  request.cameras = {0, 1};
  StereoCamera camera = load_calibration((*day / "calib_cam_to_cam.txt").string(), request).camera;
  Detector detector(camera);

  std::vector<ScoredFrame> frames;
  for (auto& truth : read_kitti_drive(drive, camera, 0)) {
    const std::string file = truth.name + ".png";
    complete_boxes(camera, truth);
    frames.push_back(detect_and_score(detector, drive / "image_00" / "data" / file, drive / "image_01" / "data" / file,
                                      std::move(truth)));
  }
  const auto rows = tabulate(frames);
  print_table("KITTI drive 0005, grey pairs", rows);
  print_summary(frames);

  for (const std::string name : kMustFind) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const ObjectRow& r) { return r.name == name; });
    ASSERT_NE(row, rows.end()) << name << " is not in the labels";
    EXPECT_GE(row->found, kMinFound * row->in_view) << name;
  }
  Rate precision;
  for (const auto& frame : frames) {
    for (const auto& verdict : frame.score.obstacles) {
      precision.hits += verdict.right;
      ++precision.total;
    }
  }
  ASSERT_GT(precision.total, 0);
  EXPECT_GE(*precision.value(), kMinPrecision);
  const PeopleCount people = count_people(frames);
  EXPECT_EQ(people.wanted, kPeople);
  EXPECT_EQ(people.found, kPeople);
  EXPECT_LE(people.false_alarms, kMaxFalsePeople);
}

}  // namespace
}  // namespace flies::blackbox
