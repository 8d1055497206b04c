#include "flies/eval/dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "flies/eval/dataset_folder.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/road/textured_road.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::error_of;
using testing::Folder;
using ::testing::HasSubstr;
using testing::kCalibration;
using testing::kTruth;
using testing::picture;
using testing::wall_map;

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
  EXPECT_THAT(overruled.notes, ElementsAre(HasSubstr("the baseline is 0.54 m as given, not 5.4")));
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

TEST(OpenDataset, SaysWhatItLooksFor) {
  const Folder folder;
  EXPECT_THAT(error_of([&] { open_dataset(folder.path()); }),
              HasSubstr("holds no truth, expected tracklet_labels.xml"));
  EXPECT_THAT(error_of([&] { open_dataset(folder.path("gone")); }), HasSubstr("gone: is not a folder"));
}

}  // namespace
}  // namespace flies
