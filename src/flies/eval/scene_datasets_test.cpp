// Drawn scenes and pairs with foot points, by themselves and as sequences.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "flies/eval/dataset.hpp"
#include "flies/eval/dataset_folder.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using testing::error_of;
using testing::Folder;
using ::testing::HasSubstr;
using testing::kCalibration;
using testing::kTruth;
using testing::picture;
using testing::wall_map;

TEST(OpenDataset, ReadsScenes) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {9, 10}) folder.add_scene(i);
  folder.add("label_2/9.txt", "");  // flies synth writes labels as well
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_EQ(dataset.kind, TruthKind::scenes);
  EXPECT_FALSE(dataset.is_sequence);
  ASSERT_EQ(dataset.pairs.size(), 2u);
  EXPECT_TRUE(dataset.notes.empty());
  const TruthFrame frame = dataset.load(1);
  EXPECT_EQ(frame.truth.name, "10");
  EXPECT_EQ(frame.truth.frame, 1);
  EXPECT_EQ(frame.camera.mount.height_m, 1.2);
  EXPECT_EQ(frame.images.left.width_px, 80);
  ASSERT_EQ(frame.truth.objects.size(), 1u);
  EXPECT_EQ(frame.truth.objects[0].type, "Car");
  EXPECT_TRUE(frame.truth.objects[0].visible);
}

TEST(OpenDataset, ReadsACalibrationASceneWhereScenesHaveThem) {
  const Folder folder;
  for (const int i : {1, 2}) folder.add_scene(i);
  folder.add("calib/1.yaml", kCalibration);
  folder.add("calib/2.yaml", "fx_px: 70\ncx_px: 40\ncy_px: 30\nbaseline_m: 0.5\nwidth_px: 80\nheight_px: 60\n");
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_EQ(dataset.load(0).camera.fx_px, 60);
  EXPECT_EQ(dataset.load(1).camera.fx_px, 70);
  EXPECT_EQ(dataset.load(1).camera.width_px, 80);
  DatasetRequest request;
  request.calib = folder.path("calib/1.yaml");
  EXPECT_EQ(open_dataset(folder.path(), request).load(1).camera.fx_px, 60);
  fs::remove(folder.path("calib/2.yaml"));
  EXPECT_THAT(error_of([&] { dataset.load(1); }), HasSubstr("2.yaml"));
}

std::string truth_at(double time_s, double x_m, double yaw_rad) {
  return fmt::format(R"({{"time_s": {}, "pose": {{"x_m": {}, "y_m": 0, "yaw_rad": {}}}, "objects": [{{"id": 7, )"
                     R"("class": "car", "x_m": 12, "y_m": 1, "length_m": 4, "width_m": 2, "height_m": 1.5}}]}})",
                     time_s, x_m, yaw_rad);
}

TEST(OpenDataset, ReadsTimesIdentitiesAndMotionOfADrawnSequence) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {1, 2}) folder.add_scene(i);
  folder.add("times.txt", "0\n0.5\n");
  folder.add("truth/1.json", truth_at(0.0, 0.0, 0.0));
  folder.add("truth/2.json", truth_at(0.5, 3.0, 0.1));
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_TRUE(dataset.is_sequence);
  EXPECT_EQ(dataset.times_s, (std::vector<double>{0.0, 0.5}));
  ASSERT_EQ(dataset.true_ego.size(), 2u);
  EXPECT_FALSE(dataset.true_ego[0].is_known);
  const EgoMotion& ego = dataset.true_ego[1];
  EXPECT_NEAR(ego.vx_mps, 6.0 * std::cos(0.1), 1e-9);
  EXPECT_NEAR(ego.vy_mps, -6.0 * std::sin(0.1), 1e-9);
  EXPECT_NEAR(ego.yaw_rate_rps, 0.2, 1e-9);
  // What stood 10 m ahead is 7 m ahead of where we are now, to the right of our new heading.
  const Point3 seen = ego.current_from_previous({10.0, 0.0, 0.0});
  EXPECT_NEAR(seen.x_m, 7.0 * std::cos(0.1), 1e-9);
  EXPECT_NEAR(seen.y_m, -7.0 * std::sin(0.1), 1e-9);
  EXPECT_EQ(dataset.load(1).truth.objects[0].track, 7);
}

TEST(OpenDataset, ReadsASmallTurnWhereTheHeadingPassesHalfATurn) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {1, 2, 3}) folder.add_scene(i);
  folder.add("times.txt", "0\n0.5\n1\n");
  folder.add("truth/1.json", truth_at(0.0, 0.0, 3.12));
  folder.add("truth/2.json", truth_at(0.5, 3.0, 3.12 + 0.1 - 2.0 * std::numbers::pi));
  folder.add("truth/3.json", truth_at(1.0, 6.0, 3.12));
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_NEAR(dataset.true_ego[1].yaw_rate_rps, 0.2, 1e-9);
  EXPECT_NEAR(dataset.true_ego[2].yaw_rate_rps, -0.2, 1e-9);
}

TEST(OpenDataset, RefusesADrawnSequenceWhoseTimesStand) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {1, 2}) folder.add_scene(i);
  folder.add("times.txt", "0\n0.5\n");
  folder.add("truth/1.json", truth_at(0.5, 0.0, 0.0));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("2.json: time_s: found none"));
  folder.add("truth/2.json", R"({"time_s": 0.5, "objects": []})");
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("2.json: pose: found none"));
  folder.add("truth/2.json", truth_at(0.5, 3.0, 0.0));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("2.json: time_s: is not after"));
}

/// The truth of a pair of a sequence with two cars, each with this key and value.
std::string truth_of_two(const std::string& first, const std::string& second) {
  const std::string car = R"("class": "car", "x_m": 12, "y_m": 1, "length_m": 4, "width_m": 2, "height_m": 1.5)";
  return R"({"time_s": 0.5, "pose": {"x_m": 1, "y_m": 0, "yaw_rad": 0}, "objects": [{)" + first + car + "}, {" +
         second + car + "}]}";
}

TEST(OpenDataset, AsksForANumberOfItsOwnForEachObjectOfASequence) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  folder.add_scene(1);
  folder.add("truth/1.json", truth_of_two("", R"("id": 0, )"));
  EXPECT_EQ(open_dataset(folder.path()).load(0).truth.objects.size(), 2u) << "pairs by themselves need none";
  folder.add("times.txt", "0.5\n");
  const auto complaint = [&](const std::string& first, const std::string& second) {
    folder.add("truth/1.json", truth_of_two(first, second));
    return error_of([&] { open_dataset(folder.path()); });
  };
  EXPECT_THAT(complaint(R"("id": 4, )", ""), HasSubstr("1.json: objects[1].id: found none, expected"));
  EXPECT_THAT(complaint(R"("id": 4, )", R"("id": 4, )"),
              HasSubstr("objects[1].id: found 4, which is that of objects[0]"));
  EXPECT_THAT(complaint(R"("id": 4.5, )", R"("id": 4, )"),
              HasSubstr("objects[0].id: found 4.5, expected a whole number"));
  EXPECT_THAT(complaint(R"("id": 4, )", R"("id": -1, )"),
              HasSubstr("objects[1].id: found -1, expected a whole number"));
  EXPECT_THAT(complaint(R"("id": 3000000000, )", R"("id": 1, )"), HasSubstr("objects[0].id: found 3000000000"));
  folder.add("truth/1.json", truth_of_two(R"("id": 4, )", R"("id": 0, )"));
  EXPECT_EQ(open_dataset(folder.path()).load(0).truth.objects[0].track, 4);
}

TEST(OpenDataset, AsksForATruthAPair) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {1, 2}) folder.add_scene(i);
  fs::remove(folder.path("truth/2.json"));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("truth: found 1 JSON files, expected 2"));
  folder.add("truth/3.json", kTruth);
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()).load(1); }), HasSubstr("2.json: cannot be read"));
}

TEST(OpenDataset, AsksForTheCalibrationOfScenes) {
  const Folder folder;
  folder.add_scene(1);
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("calib.yaml: not found"));
  DatasetRequest request;
  request.calib = folder.folder.write("mine.yaml", kCalibration);
  request.camera_height_m = 0.9;
  EXPECT_EQ(open_dataset(folder.path(), request).load(0).camera.mount.height_m, 0.9);
}

TEST(OpenDataset, ReadsFootPointsAndTellsTheAssumedHeight) {
  const Folder folder;
  folder.add("calib.yaml", "fx_px: 60\ncx_px: 40\ncy_px: 30\nbaseline_m: 0.5\nwidth_px: 80\nheight_px: 60\n");
  folder.add("truth.csv", "1,7,30,10,5,20,1,0.5,1.65,8\n");
  for (const int i : {0, 1}) {
    folder.add("image_" + std::to_string(i) + "_0.pgm", picture(1));
    folder.add("image_" + std::to_string(i) + "_1.pgm", picture(2));
  }
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_EQ(dataset.kind, TruthKind::foot_points);
  EXPECT_TRUE(dataset.is_sequence);
  ASSERT_EQ(dataset.notes.size(), 1u);
  EXPECT_THAT(dataset.notes[0], HasSubstr("no camera height"));
  ASSERT_EQ(dataset.pairs.size(), 2u);
  EXPECT_THAT(dataset.pairs[1].right, HasSubstr("image_1_1.pgm"));
  EXPECT_EQ(dataset.load(0).truth.objects.size(), 1u);
  EXPECT_TRUE(dataset.load(1).truth.objects.empty());
  folder.add("truth.csv", "3,7,30,10,5,20,1,0.5,1.65,8\n");
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("frame: found 3, but there are 2 pairs"));
}

TEST(OpenDataset, ReadsTheDisparitiesOfScenesWhereTheyAre) {
  const Folder folder;
  folder.add("calib.yaml", kCalibration);
  for (const int i : {1, 2}) folder.add_scene(i);
  fs::create_directories(folder.path("disparity"));
  write_png(folder.path("disparity/2.png"), wall_map());
  const Dataset dataset = open_dataset(folder.path());
  EXPECT_TRUE(dataset.load(0).truth.map.empty());
  const TruthFrame frame = dataset.load(1);
  EXPECT_EQ(frame.truth.map.size(), 4800u);
  EXPECT_TRUE(frame.truth.lidar.empty());  // obstacles are held against labels
}

}  // namespace
}  // namespace flies
