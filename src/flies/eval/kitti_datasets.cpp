#include <fmt/format.h>

#include <memory>
#include <set>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/dataset_kinds.hpp"
#include "flies/eval/disparity_map.hpp"
#include "flies/eval/kitti_motion.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/pair_matching.hpp"

namespace flies {

namespace fs = std::filesystem;

namespace {

/// Times and motion of the pairs of a drive; left empty where its GPS/IMU does not cover them from the first one on.
/// The laser triggers the cameras evenly, while the times of the GPS/IMU step by 10 ms: over all pairs both keep the
/// same time, so even times are right.
void add_motion(const fs::path& drive, Dataset& dataset) {
  if (!detail::is_there(drive / "oxts" / "timestamps.txt")) return;
  const auto motion = read_kitti_motion(drive);
  const std::size_t count = dataset.pairs.size();
  if (motion.size() < count || count < 2) return;
  for (std::size_t i = 0; i < count; ++i)
    if (fs::path(dataset.pairs[i].left).stem() != fmt::format("{:010}", i)) return;
  const double interval_s = motion[count - 1].time_s / static_cast<double>(count - 1);
  dataset.true_ego.emplace_back();
  for (std::size_t i = 0; i < count; ++i) dataset.times_s.push_back(static_cast<double>(i) * interval_s);
  for (std::size_t i = 1; i < count; ++i) {
    const auto &a = motion[i - 1], &b = motion[i];
    dataset.true_ego.push_back(given_ego_motion(interval_s, (a.vx_mps + b.vx_mps) / 2, (a.vy_mps + b.vy_mps) / 2,
                                                (a.yaw_rate_rps + b.yaw_rate_rps) / 2));
  }
}

void add_drive_files(const fs::path& drive, Dataset& dataset) {
  const fs::path day = drive.parent_path(), oxts = drive / "oxts";
  add_files({day / "calib_cam_to_cam.txt", day / "calib_velo_to_cam.txt", day / "calib_imu_to_velo.txt",
             drive / "tracklet_labels.xml", oxts / "timestamps.txt"},
            dataset);
  if (detail::is_there_as_folder(oxts / "data"))
    for (const auto& file : detail::files_of(oxts / "data")) add_files({file}, dataset);
  for (const auto& pair : dataset.pairs)
    add_files({drive / "velodyne_points" / "data" / (detail::stem_of(pair.left) + ".bin")}, dataset);
}

}  // namespace

Dataset open_kitti_drive(const fs::path& folder, const DatasetRequest& request) {
  refuse_calib(folder, request);
  const bool has_grey =
      detail::is_there_as_folder(folder / "image_00") && detail::is_there_as_folder(folder / "image_01");
  const auto cameras = request.cameras.value_or(has_grey ? std::array{0, 1} : std::array{2, 3});
  const auto images = [&](int camera) { return (folder / fmt::format("image_{:02}", camera) / "data").string(); };
  CalibrationRequest wanted = calibration_request(request);
  wanted.cameras = cameras;
  // The calibration lies beside the drive, which may be given as "." or with a slash at its end.
  const fs::path drive = (fs::absolute(folder) / "").lexically_normal().parent_path();
  const std::string calib = (drive.parent_path() / "calib_cam_to_cam.txt").string();
  const Calibration calibration = load_calibration(calib, wanted);
  StereoCamera camera = calibration.camera;

  Dataset dataset{.kind = TruthKind::kitti_drive, .is_sequence = true};
  auto found = match_all(images(cameras[0]), images(cameras[1]));
  dataset.pairs = std::move(found.pairs);
  dataset.notes = std::move(found.notes);
  add_notes(calibration, calib, dataset.notes);
  if (const auto mount = mount_from_road(dataset.pairs, camera, request, dataset.notes)) camera.mount = *mount;
  const auto truth = std::make_shared<KittiDrive>(drive, camera, cameras[0]);
  add_motion(drive, dataset);
  add_drive_files(drive, dataset);
  dataset.load = [truth, camera, pairs = dataset.pairs](std::size_t i) {
    return TruthFrame{load_images(pairs[i], camera), camera, truth->read(detail::stem_of(pairs[i].left))};
  };
  return dataset;
}

Dataset open_kitti_object(const fs::path& folder, const DatasetRequest& request) {
  refuse_calib(folder, request);
  refuse_cameras(folder, request);
  std::set<std::string> names;
  for (const auto& file : detail::files_of(folder / "label_2"))
    if (file.extension() == ".txt") names.insert(file.stem().string());
  if (names.empty()) throw InputError((folder / "label_2").string(), "", "holds no labels, expected .txt files");
  Dataset dataset{.kind = TruthKind::kitti_object};
  for (const auto& name : names) {
    dataset.pairs.push_back(
        {(folder / "image_2" / (name + ".png")).string(), (folder / "image_3" / (name + ".png")).string()});
    add_files({folder / "label_2" / (name + ".txt"), folder / "calib" / (name + ".txt"),
               folder / "velodyne" / (name + ".bin")},
              dataset);
  }
  const auto calib_of = [folder](const std::string& name) { return (folder / "calib" / (name + ".txt")).string(); };
  const auto calibration_of = [calib_of](const std::string& name, const GrayPair& images, CalibrationRequest wanted) {
    ask_for_images(wanted, images.view());
    Calibration calibration = load_calibration(calib_of(name), wanted);
    calibration.camera.width_px = wanted.width_px;
    calibration.camera.height_px = wanted.height_px;
    return calibration;
  };
  CalibrationRequest wanted = calibration_request(request);
  const Calibration first = calibration_of(*names.begin(), load_images(dataset.pairs.front()), wanted);
  add_notes(first, calib_of(*names.begin()), dataset.notes);
  if (request.find_mount) {
    if (const auto mount = mount_from_road(dataset.pairs, first.camera, request, dataset.notes))
      wanted = with_mount(wanted, *mount);
  }
  dataset.load = [folder, wanted, calibration_of, pairs = dataset.pairs](std::size_t i) {
    const std::string name = detail::stem_of(pairs[i].left);
    TruthFrame frame{load_images(pairs[i]), {}, {}};
    frame.camera = calibration_of(name, frame.images, wanted).camera;
    frame.truth = read_kitti_object(folder, name, frame.camera);
    return frame;
  };
  return dataset;
}

Dataset open_kitti_stereo(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  std::set<std::string> names;
  for (const auto& file : detail::files_of(folder / "disp_noc"))
    if (file.extension() == ".png") names.insert(file.stem().string());
  if (names.empty())
    throw InputError((folder / "disp_noc").string(), "", "holds no disparity maps, expected .png files");
  Dataset dataset{.kind = TruthKind::kitti_stereo};
  for (const auto& name : names) {
    dataset.pairs.push_back(
        {(folder / "image_0" / (name + ".png")).string(), (folder / "image_1" / (name + ".png")).string()});
    add_files({folder / "disp_noc" / (name + ".png")}, dataset);
  }
  for (const auto& file : detail::files_of(folder))
    if (file.filename().string().starts_with("calib_")) add_files({file}, dataset);
  const auto calib_of = [folder, file = request.calib](const GrayPair& images) {
    const auto [width_px, height_px] = std::pair(images.left.width_px, images.left.height_px);
    return file.empty() ? (folder / fmt::format("calib_{}x{}.yaml", width_px, height_px)).string() : file;
  };
  const auto calibration_of = [calib_of](const GrayPair& images, CalibrationRequest wanted) {
    ask_for_images(wanted, images.view());
    Calibration calibration = load_calibration(calib_of(images), wanted);
    if (calibration.rectifier) refuse_raw(calib_of(images));
    calibration.camera.width_px = wanted.width_px;
    calibration.camera.height_px = wanted.height_px;
    return calibration;
  };
  CalibrationRequest wanted = calibration_request(request);
  const GrayPair first_images = load_images(dataset.pairs.front());
  const Calibration first = calibration_of(first_images, wanted);
  add_notes(first, calib_of(first_images), dataset.notes);
  if (request.find_mount) {
    if (const auto mount = mount_from_road(dataset.pairs, first.camera, request, dataset.notes))
      wanted = with_mount(wanted, *mount);
  }
  dataset.load = [folder, wanted, calibration_of, pairs = dataset.pairs](std::size_t i) {
    TruthFrame frame{load_images(pairs[i]), {}, {}};
    frame.camera = calibration_of(frame.images, wanted).camera;
    frame.truth.frame = static_cast<int>(i);
    frame.truth.name = detail::stem_of(pairs[i].left);
    frame.truth.map = read_disparity_map(folder / "disp_noc" / (frame.truth.name + ".png"), frame.camera);
    frame.truth.lidar = frame.truth.map;  // the maps are lidar, gathered over several turns
    return frame;
  };
  return dataset;
}

}  // namespace flies
