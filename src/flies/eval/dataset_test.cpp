#include "flies/eval/dataset.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/road/textured_road.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr const char* kCalibration =
    "fx_px: 60\ncx_px: 40\ncy_px: 30\nbaseline_m: 0.5\nwidth_px: 80\nheight_px: 60\nheight_m: 1.2\n"
    "pitch_deg: 0\n";
constexpr const char* kTruth =
    R"({"objects": [{"class": "car", "x_m": 12, "y_m": 1, "length_m": 4, "width_m": 2, "height_m": 1.5}]})";

/// A picture of 80 x 60 random grey levels.
std::string picture(std::uint32_t number) {
  std::string pgm = "P5\n80 60\n255\n";
  for (std::uint32_t i = 0; i < 4800; ++i) pgm.push_back(static_cast<char>(philox({i, number, 0, 0}, 1)[0] & 0x7f));
  return pgm;
}

struct Folder {
  void add(const std::string& name, const std::string& content) const {
    fs::create_directories(fs::path(folder.file(name)).parent_path());
    folder.write(name, content);
  }
  void add_scene(int number) const {
    const std::string name = std::to_string(number);
    add("left/" + name + ".pgm", picture(1));
    add("right/" + name + ".pgm", picture(2));
    add("truth/" + name + ".json", kTruth);
  }
  std::string path(const std::string& name = ".") const { return folder.file(name); }

  TemporaryFolder folder;
};

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

TEST(OpenDataset, TakesTheMountFromTheRoadOnRequest) {
  const StereoCamera camera{.fx_px = 400,
                            .fy_px = 400,
                            .cx_px = 320,
                            .cx_right_px = 320,
                            .cy_px = 180,
                            .baseline_m = 0.5,
                            .width_px = 640,
                            .height_px = 400,
                            .mount = {1.2, radians(8), 0.0}};
  const OwnPair pair = render_ground(camera);
  const auto pgm = [](const std::vector<std::uint8_t>& pixels) {
    return "P5\n640 400\n255\n" + std::string(pixels.begin(), pixels.end());
  };
  const Folder folder;
  folder.add("calib.yaml",
             "fx_px: 400\ncx_px: 320\ncy_px: 180\nbaseline_m: 0.5\nwidth_px: 640\nheight_px: 400\nheight_m: 1.65\n"
             "pitch_deg: 0\n");
  folder.add("left/0.pgm", pgm(pair.left));
  folder.add("right/0.pgm", pgm(pair.right));
  folder.add("truth/0.json", kTruth);
  EXPECT_EQ(open_dataset(folder.path()).load(0).camera.mount.height_m, 1.65);
  DatasetRequest request;
  request.find_mount = true;
  const Dataset dataset = open_dataset(folder.path(), request);
  ASSERT_EQ(dataset.notes.size(), 1u);
  EXPECT_THAT(dataset.notes[0], HasSubstr("below the camera"));
  const CameraMount mount = dataset.load(0).camera.mount;
  EXPECT_NEAR(mount.height_m, 1.2, 0.04);
  EXPECT_NEAR(mount.pitch_rad, radians(8), radians(0.5));
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

TEST(OpenDataset, TellsWhatTheCalibrationIsDoubtedFor) {
  const Folder folder;
  folder.add("calib.yaml",
             "fx_px: 60\ncx_px: 40\ncy_px: 30\nbaseline_m: 5.4\nwidth_px: 80\nheight_px: 60\nheight_m: 1.2\n"
             "pitch_deg: 0\n");
  folder.add_scene(1);
  EXPECT_THAT(open_dataset(folder.path()).notes, ElementsAre(HasSubstr("calib.yaml: a baseline of 5.4 m")));
  DatasetRequest said;
  said.baseline_m = 0.54;
  const Dataset overruled = open_dataset(folder.path(), said);
  EXPECT_EQ(overruled.load(0).camera.baseline_m, 0.54);
  EXPECT_THAT(overruled.notes, ElementsAre(HasSubstr("the baseline is 0.54 m as was said, not 5.4")));
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

/// P rows of cameras 2 and 3, the rest of a KITTI calibration and a lidar that looks ahead.
constexpr const char* kKittiCalibration =
    "P2: 60 0 40 0 0 60 30 0 0 0 1 0\nP3: 60 0 40 -30 0 60 30 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

TEST(OpenDataset, ReadsAKittiObjectFolderAndTheOneAboveIt) {
  const Folder folder;
  folder.add("training/calib/000003.txt", kKittiCalibration);
  folder.add("training/label_2/000003.txt", "Car 0.00 0 0 0 0 1 1 1.5 1.6 4.0 1.00 1.65 20.00 0\n");
  // KITTI's pictures are PNG by name; what they are is told from their content.
  folder.add("training/image_2/000003.png", picture(1));
  folder.add("training/image_3/000003.png", picture(2));
  for (const std::string place : {".", "training"}) {
    const Dataset dataset = open_dataset(folder.path(place));
    EXPECT_EQ(dataset.kind, TruthKind::kitti_object);
    ASSERT_EQ(dataset.pairs.size(), 1u);
    const TruthFrame frame = dataset.load(0);
    EXPECT_EQ(frame.camera.width_px, 80);
    EXPECT_NEAR(frame.camera.baseline_m, 0.5, 1e-9);
    ASSERT_EQ(frame.truth.objects.size(), 1u);
  }
  DatasetRequest request;
  request.calib = "mine.yaml";
  EXPECT_THAT(error_of([&] { open_dataset(folder.path(), request); }), HasSubstr("mine.yaml"));
  request.calib.clear();
  request.cameras = {0, 1};
  EXPECT_THAT(error_of([&] { open_dataset(folder.path(), request); }), HasSubstr("cameras"));
}

/// A drive of two frames with one car in the second.
void add_drive(const Folder& folder) {
  folder.add("day/calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
  std::string cameras = "R_rect_00: 1 0 0 0 1 0 0 0 1\n";
  for (const int camera : {0, 1, 2, 3}) {
    const std::string index = "0" + std::to_string(camera);
    cameras += "S_rect_" + index + ": 80 60\nP_rect_" + index + ": 60 0 40 " + (camera % 2 == 0 ? "0" : "-30") +
               " 0 60 30 0 0 0 1 0\n";
  }
  folder.add("day/calib_cam_to_cam.txt", cameras);
  folder.add("day/drive/tracklet_labels.xml",
             "<boost_serialization><tracklets><item><objectType>Car</objectType><h>1.5</h><w>1.6</w><l>4</l>"
             "<first_frame>5</first_frame><poses><item><tx>20</tx><ty>0</ty><tz>-1.65</tz><rz>0</rz>"
             "<occlusion>0</occlusion><truncation>0</truncation></item></poses></item></tracklets>"
             "</boost_serialization>");
  for (const std::string name : {"0000000004.pgm", "0000000005.pgm"}) {
    folder.add("day/drive/image_02/data/" + name, picture(1));
    folder.add("day/drive/image_03/data/" + name, picture(2));
  }
}

TEST(OpenDataset, ReadsAKittiDriveWithTheCamerasItHas) {
  const Folder folder;
  add_drive(folder);
  for (const std::string place : {"day/drive", "day/drive/"}) {
    const Dataset dataset = open_dataset(folder.path(place));
    EXPECT_EQ(dataset.kind, TruthKind::kitti_drive);
    EXPECT_TRUE(dataset.is_sequence);
    ASSERT_EQ(dataset.pairs.size(), 2u);
    EXPECT_THAT(dataset.pairs[0].left, HasSubstr("image_02"));
    EXPECT_TRUE(dataset.load(0).truth.objects.empty());
    const TruthFrame frame = dataset.load(1);
    EXPECT_EQ(frame.truth.frame, 5);
    ASSERT_EQ(frame.truth.objects.size(), 1u);
    EXPECT_NEAR(frame.truth.objects[0].footprint.x_m, 20.0, 1e-9);
  }
  DatasetRequest request;
  request.cameras = {0, 1};
  EXPECT_THAT(error_of([&] { open_dataset(folder.path("day/drive"), request); }), HasSubstr("image_00"));
}

TEST(OpenDataset, TakesTimesAndMotionOfADriveFromItsGpsAndImu) {
  const Folder folder;
  add_drive(folder);
  EXPECT_TRUE(open_dataset(folder.path("day/drive")).times_s.empty()) << "no oxts";
  folder.add("day/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  std::string stamps;
  for (int i = 0; i < 6; ++i) {
    stamps += "2011-09-26 13:02:0" + std::to_string(i / 2) + (i % 2 == 0 ? ".000000000\n" : ".500000000\n");
    std::string numbers;
    for (int k = 0; k < 30; ++k) numbers += k == 8 ? std::to_string(2 * i) + " " : "0 ";
    folder.add("day/drive/oxts/data/000000000" + std::to_string(i) + ".txt", numbers);
  }
  folder.add("day/drive/oxts/timestamps.txt", stamps);
  EXPECT_TRUE(open_dataset(folder.path("day/drive")).times_s.empty()) << "its pairs do not begin with the first";
  for (const char* camera : {"2", "3"})
    for (const char* name : {"0", "1"})
      folder.add(std::string("day/drive/image_0") + camera + "/data/000000000" + name + ".pgm", picture(1));
  for (const char* camera : {"2", "3"})
    for (const char* name : {"4", "5"})
      fs::remove(folder.path(std::string("day/drive/image_0") + camera + "/data/000000000" + name + ".pgm"));
  const Dataset dataset = open_dataset(folder.path("day/drive"));
  ASSERT_EQ(dataset.times_s.size(), 2u);
  EXPECT_NEAR(dataset.times_s[1], 0.5, 1e-9);
  ASSERT_EQ(dataset.true_ego.size(), 2u);
  EXPECT_FALSE(dataset.true_ego[0].is_known);
  EXPECT_NEAR(dataset.true_ego[1].vx_mps, 1.0, 1e-9) << "the mean of 0 and 2 m/s";
}

/// A map of one disparity, which is a wall ahead.
cv::Mat wall_map(int width_px = 80) { return {60, width_px, CV_16UC1, cv::Scalar(3 * 256)}; }

TEST(OpenDataset, ReadsAKittiStereoFolderAndTheOneAboveIt) {
  const Folder folder;
  folder.add("training/calib_80x60.yaml", kCalibration);
  // Pairs without a map are none.
  for (const std::string name : {"000000_10", "000000_11"}) {
    folder.add("training/image_0/" + name + ".png", picture(1));
    folder.add("training/image_1/" + name + ".png", picture(2));
  }
  fs::create_directories(folder.path("training/disp_noc"));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }), HasSubstr("holds no disparity maps"));
  write_png(folder.path("training/disp_noc/000000_10.png"), wall_map());
  for (const std::string place : {".", "training"}) {
    const Dataset dataset = open_dataset(folder.path(place));
    EXPECT_EQ(dataset.kind, TruthKind::kitti_stereo);
    EXPECT_FALSE(dataset.is_sequence);
    ASSERT_EQ(dataset.pairs.size(), 1u);
    const TruthFrame frame = dataset.load(0);
    EXPECT_EQ(frame.truth.name, "000000_10");
    EXPECT_EQ(frame.camera.mount.height_m, 1.2);
    EXPECT_TRUE(frame.truth.objects.empty());
    ASSERT_EQ(frame.truth.map.size(), 4800u);
    EXPECT_NEAR(frame.truth.map[0].point.x_m, 10.0, 1e-9);
    EXPECT_EQ(frame.truth.lidar.size(), 4800u);
  }
  write_png(folder.path("training/disp_noc/000000_10.png"), wall_map(70));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()).load(0); }), HasSubstr("disp_noc/000000_10.png"));
  fs::remove(folder.path("training/calib_80x60.yaml"));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()).load(0); }), HasSubstr("calib_80x60.yaml"));
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

TEST(OpenDataset, SaysWhatItLooksFor) {
  const Folder folder;
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }),
              HasSubstr("holds no truth, expected tracklet_labels.xml"));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path("gone")); }), HasSubstr("gone: is not a folder"));
}

}  // namespace
}  // namespace flies
