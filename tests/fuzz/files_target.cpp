#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string_view>

#include "flies/classify/network_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/eval/disparity_map.hpp"
#include "flies/eval/kitti_motion.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/unlabelled.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/time_stamps.hpp"
#include "flies/record/ros_calibration.hpp"
#include "flies/record/ros_message.hpp"
#include "flies/train/checkpoint.hpp"
#include "tests/fuzz/calibration_seeds.hpp"
#include "tests/fuzz/recording_seeds.hpp"
#include "tests/fuzz/target.hpp"

namespace {

namespace fs = std::filesystem;

const flies::StereoCamera kCamera{700, 700, 600, 600, 170, 0.5, 1242, 375, {}};
const flies::StereoCamera kDisparityCamera{20, 20, 16, 16, 8, 0.5, 32, 16, {}};

/// A KITTI raw drive and a network, whole but for the file that the input is.
struct Folder {
  fs::path day = fs::temp_directory_path() / ("flies-fuzz-" + std::to_string(::getpid())), drive = day / "drive";

  Folder() {
    fs::create_directories(drive / "velodyne_points" / "data");
    fs::create_directories(drive / "oxts" / "data");
    write(day / "calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 700 0 600 0 0 700 170 0 0 0 1 0\n");
    write(day / "calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
    write(day / "calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
    write(drive / "tracklet_labels.xml", "<boost_serialization><tracklets></tracklets></boost_serialization>");
    write(drive / "oxts" / "timestamps.txt", "2011-09-26 13:02:25.964389445\n");
    write(day / "net.prototxt",
          "name: \"n\" input: \"data\" input_shape { dim: 1 dim: 1 dim: 8 dim: 4 }\n"
          "layer { name: \"p\" type: \"Pooling\" bottom: \"data\" top: \"p\" "
          "pooling_param { pool: AVE global_pooling: true } }\n");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(day, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  static void write(const fs::path& file, std::string_view text) { std::ofstream(file, std::ios::binary) << text; }
};

/// @param right of the right camera, or the other half of the calibration; empty: none is named
void read_calibrations(const std::string& file, const std::string& right = {}) {
  std::vector<flies::CalibrationRequest> requests(right.empty() ? 4 : 5);
  requests[1].width_px = kCamera.width_px;
  requests[1].height_px = kCamera.height_px;
  requests[2].cameras = {0, 1};
  requests[3].images_are_raw = true;
  requests.back().right_path = right;
  for (const auto& request : requests) {
    try {
      flies::load_calibration(file, request);
    } catch (const flies::InputError&) {
    }
  }
}

/// The next message behind what is damaged.
std::optional<flies::RecordedMessage> next_whole(flies::RecordingReader& reader) {
  while (true) {
    try {
      return reader.next();
    } catch (const flies::InputError&) {
    }
  }
}

/// A message may be refused the second time, but is never another.
void check_found_again(flies::RecordingReader& reader, const flies::RecordedMessage& message) {
  try {
    if (reader.at(message.place).data != message.data) std::abort();
  } catch (const flies::InputError&) {
  }
}

void read_recording(const std::string& file) {
  const auto reader = flies::open_recording(file);
  std::vector<flies::RosCameraInfo> cameras;
  while (const auto message = next_whole(*reader)) {
    check_found_again(*reader, *message);
    try {
      flies::ros_stamp_ns(*message, file);
      flies::ros_picture(*message, file);
    } catch (const flies::InputError&) {
    }
    try {
      cameras.push_back(flies::ros_camera_info(*message, file));
    } catch (const flies::InputError&) {
    }
  }
  if (cameras.size() < 2) return;
  std::vector<flies::CalibrationRequest> requests(4);
  requests[1].images_are_raw = true;
  requests[2].width_px = kCamera.width_px;
  requests[2].height_px = kCamera.height_px;
  requests[3].images_are_raw = true;
  requests[3].baseline_m = kCamera.baseline_m;
  for (const auto& request : requests) {
    try {
      flies::ros_calibration(cameras[0], cameras[1], request, file);
    } catch (const flies::InputError&) {
    }
  }
}

struct Reader {
  std::vector<const char*> files;  ///< below the folder; of several, a byte of 0 ends each but the last
  std::function<void(const Folder&, const std::string&)> read;
};

// Inputs that were found say by their first byte which reader is meant: new ones are added at the end.
const std::array<Reader, 13> kReaders = {
    Reader{{"calib.txt"}, [](const Folder&, const std::string& file) { read_calibrations(file); }},
    Reader{{"calib.yaml"}, [](const Folder&, const std::string& file) { read_calibrations(file); }},
    Reader{{"calib.json"}, [](const Folder&, const std::string& file) { read_calibrations(file); }},
    Reader{{"calib.xml"}, [](const Folder&, const std::string& file) { read_calibrations(file); }},
    Reader{{"state.json"},
           [](const Folder& folder, const std::string&) { flies::Checkpoint(folder.day, "x").check_pictures(2); }},
    Reader{{"times.txt"}, [](const Folder&, const std::string& file) { flies::read_time_stamps(file); }},
    Reader{{"drive/velodyne_points/data/0000000000.bin"},
           [](const Folder& folder, const std::string&) {
             flies::KittiDrive(folder.drive, kCamera, 2).read("0000000000");
           }},
    Reader{{"drive/oxts/data/0000000000.txt"},
           [](const Folder& folder, const std::string&) { flies::read_kitti_motion(folder.drive); }},
    Reader{{"recording.mcap"}, [](const Folder&, const std::string& file) { read_recording(file); }},
    Reader{{"net.yaml"},
           [](const Folder& folder, const std::string&) {
             flies::network_classifier((folder.day / "net.prototxt").string());
           }},
    Reader{{"unlabelled.txt"}, [](const Folder&, const std::string& file) { flies::read_unlabelled(file); }},
    Reader{{"cam0.yaml", "cam1.yaml", "cam2.yaml"},
           [](const Folder& folder, const std::string& file) {
             read_calibrations(file, (folder.day / "cam1.yaml").string());
           }},
    Reader{{"disparity.png"},
           [](const Folder&, const std::string& file) { flies::read_disparity_map(file, kDisparityCamera); }}};

}  // namespace

// Everything that is read from a file by its name: the first byte says what the others are.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  if (size == 0) return 0;
  const auto& reader = kReaders[data[0] % kReaders.size()];
  std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  for (const char* name : reader.files) {
    const auto end = name == reader.files.back() ? rest.size() : std::min(rest.find('\0'), rest.size());
    Folder::write(folder.day / name, rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  try {
    reader.read(folder, (folder.day / reader.files.front()).string());
  } catch (const flies::InputError&) {
  }
  for (const char* name : reader.files) fs::remove(folder.day / name);
  return 0;
}

namespace {

/// As a training leaves it behind.
std::string training_state() {
  const flies::testing::TemporaryFolder folder;
  flies::TrainingState state;
  state.rounds_done = 1;
  state.background = {{1, false, {1, 2, 3, 4}}};
  state.rounds = {{"round 1", 3, 4}};
  flies::Checkpoint(folder.file("state"), "x").save(state);
  return flies::testing::read_all(folder.file("state/state.json"));
}

std::string disparity_map() {
  cv::Mat map(kDisparityCamera.height_px, kDisparityCamera.width_px, CV_16U);
  for (int v = 0; v < map.rows; ++v) map.row(v).setTo(256 * v / 2);
  const auto png = flies::encode_png(map);
  return {png.begin(), png.end()};
}

}  // namespace

std::vector<std::string> fuzz_seeds() {
  const auto seed = [](char reader, const std::string& text) { return std::string(1, reader) + text; };
  std::string points;
  for (const float value : {12.0F, 1.0F, -1.0F, 0.5F, 1e30F, 0.0F, 0.0F, 0.0F})
    points.append(reinterpret_cast<const char*>(&value), sizeof value);
  std::string motion;
  for (int i = 0; i < 30; ++i) motion += "0.5 ";
  std::vector<std::string> seeds = {
      seed(0, "P2: 700 0 600 0 0 700 170 0 0 0 1 0\nP3: 700 0 600 -280 0 700 170 0 0 0 1 0\n"),
      seed(0, "cam0=[700 0 600; 0 700 170; 0 0 1]\ncam1=[700 0 600; 0 700 170; 0 0 1]\nbaseline=100\nwidth=9\n"),
      seed(1, "fx_px: 700\ncx_px: 600\ncy_px: 170\nbaseline_m: 0.5\nwidth_px: 1242\nheight_px: 375\n"),
      seed(1,
           "%YAML:1.0\n---\nP1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 500., 0., 320., "
           "0., 0., 500., 240., 0., 0., 0., 1., 0. ]\nP2: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   "
           "data: [ 500., 0., 320., -60., 0., 500., 240., 0., 0., 0., 1., 0. ]\n"),
      seed(1,
           "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\ncamera_matrix:\n  rows: 3\n  cols: "
           "3\n  data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: "
           "[500, 0, 320, -60, 0, 500, 240, 0, 0, 0, 1, 0]\n"),
      seed(2, R"({"fx_px": 700, "cx_px": 600, "cy_px": 170, "baseline_m": 0.5})"),
      seed(3,
           "<?xml version=\"1.0\"?>\n<opencv_storage><P1 type_id=\"opencv-matrix\"><rows>1</rows><cols>2</cols>"
           "<dt>d</dt><data>1. 2.</data></P1></opencv_storage>\n"),
      seed(4, R"({"fingerprint": "x", "rounds_done": 1, "rounds": [["round 1", 3, 4]], "background": )"
              R"([{"picture": 1, "window": [1, 2, 3, 4], "is_mirrored": false}]})"),
      seed(5, "0.0\n0.1\n2011-09-26 13:02:25.964389445\n"),
      seed(6, points),
      seed(7, motion),
      seed(8, std::string("\x89MCAP0\r\n", 8) + std::string("\x01\x08\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 17)),
      seed(9, "input_width_px: 4\ninput_height_px: 8\n"),
      seed(10, "000000,10,20,30,40,behind a car\n"),
      seed(12, disparity_map())};
  seeds.push_back(seed(4, training_state()));
  for (const auto& text : flies::testing::calibration_seeds()) seeds.push_back(seed(11, text));
  for (const auto& bytes : flies::testing::recording_seeds()) seeds.push_back(seed(8, bytes));
  return seeds;
}
