#include "flies/eval/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/dataset_kinds.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/images.hpp"
#include "flies/road/find_mount.hpp"

namespace flies {

namespace fs = std::filesystem;

CalibrationRequest calibration_request(const DatasetRequest& request) {
  CalibrationRequest wanted;
  wanted.baseline_m = request.baseline_m;
  wanted.disparity_shift_px = request.disparity_shift_px;
  wanted.camera_height_m = request.camera_height_m;
  wanted.camera_pitch_rad = request.camera_pitch_rad;
  wanted.camera_roll_rad = request.camera_roll_rad;
  return wanted;
}

void refuse_calib(const fs::path& folder, const DatasetRequest& request) {
  if (!request.calib.empty())
    throw InputError(request.calib, "", fmt::format("{} has its own calibration, expected none", folder.string()));
}

void refuse_cameras(const fs::path& folder, const DatasetRequest& request) {
  if (request.cameras)
    throw InputError(folder.string(), "cameras", "only a KITTI drive lets them be chosen, expected none");
}

void refuse_raw(const std::string& calibration_file) {
  throw InputError(calibration_file, "",
                   "belongs to raw images, expected that of the rectified images whose truth is known");
}

void add_files(std::initializer_list<fs::path> files, Dataset& dataset) {
  for (const auto& file : files)
    if (detail::is_there(file)) dataset.files.push_back(file.string());
}

void add_notes(const Calibration& calibration, const std::string& file, std::vector<std::string>& notes) {
  for (const auto& note : calibration.notes) notes.push_back(file + ": " + note.text);
}

std::optional<CameraMount> mount_from_road(const std::vector<PairPaths>& pairs, const StereoCamera& camera,
                                           const DatasetRequest& request, std::vector<std::string>& notes) {
  constexpr std::size_t kPairs = 5;
  if (!request.find_mount || pairs.empty()) return std::nullopt;
  std::vector<GrayPair> sample;
  const std::size_t count = std::min(kPairs, pairs.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [left, right] = pairs[count == 1 ? 0 : k * (pairs.size() - 1) / (count - 1)];
    GrayPair images = load_pair(left, right);
    if (sample.empty() || images.left.width_px == sample.front().left.width_px) sample.push_back(std::move(images));
  }
  std::vector<RectifiedPair> views;
  for (const auto& images : sample) views.push_back(images.view());
  const MountFinding finding = find_mount(views, camera);
  if (const auto note = mount_note(finding)) notes.push_back(pairs.front().left + ": " + *note);
  return finding.is_replaced ? std::optional(finding.mount) : std::nullopt;
}

CalibrationRequest with_mount(CalibrationRequest wanted, const CameraMount& mount) {
  wanted.camera_height_m = mount.height_m;
  wanted.camera_pitch_rad = mount.pitch_rad;
  wanted.camera_roll_rad = mount.roll_rad;
  return wanted;
}

StereoCamera shared_camera(const fs::path& folder, const DatasetRequest& request, Dataset& dataset) {
  const GrayPair images = load_pair(dataset.pairs.front().left, dataset.pairs.front().right);
  const RectifiedPair first = images.view();
  constexpr const char* kCalibrationNames[] = {"calib.yaml", "calib.txt", "extrinsics.yml"};
  std::string file = request.calib;
  for (const char* name : kCalibrationNames)
    if (file.empty() && detail::is_there(folder / name)) file = (folder / name).string();
  if (file.empty()) throw InputError(folder.string(), "calib.yaml", "not found, give a calibration");
  CalibrationRequest wanted = calibration_request(request);
  ask_for_images(wanted, first);
  const Calibration calibration = load_calibration(file, wanted);
  if (calibration.rectifier) refuse_raw(file);
  check_camera_fits(calibration.camera, first.left.width_px, first.left.height_px, file);
  add_notes(calibration, file, dataset.notes);
  add_files({file}, dataset);
  StereoCamera camera = calibration.camera;
  camera.width_px = first.left.width_px;
  camera.height_px = first.left.height_px;
  if (const auto mount = mount_from_road(dataset.pairs, camera, request, dataset.notes)) camera.mount = *mount;
  return camera;
}

GrayPair load_images(const PairPaths& pair) { return load_pair(pair.left, pair.right); }

GrayPair load_images(const PairPaths& pair, const StereoCamera& camera) {
  GrayPair images = load_images(pair);
  check_camera_fits(camera, images.left.width_px, images.left.height_px, pair.left);
  return images;
}

namespace {

/// Recognises the kind.
Dataset open_folder(const fs::path& folder, const DatasetRequest& request) {
  if (!detail::is_there_as_folder(folder)) throw InputError(folder.string(), "", "is not a folder");
  const auto has = [&](const char* name) { return detail::is_there(folder / name); };
  // `flies synth` writes label_2 as well, so scenes are looked for first.
  if (has("truth") && has("left") && has("right")) return open_scenes(folder, request);
  if (has("label_2") && has("calib")) return open_kitti_object(folder, request);
  if (has("training/label_2")) return open_kitti_object(folder / "training", request);
  if (has("tracklet_labels.xml")) return open_kitti_drive(folder, request);
  if (has("disp_noc")) return open_kitti_stereo(folder, request);
  if (has("training/disp_noc")) return open_kitti_stereo(folder / "training", request);
  if (has("truth.csv")) return open_foot_points(folder, request);
  if (has("rectified/truth.csv")) return open_foot_points(folder / "rectified", request);
  throw InputError(folder.string(), "",
                   "holds no truth, expected tracklet_labels.xml (KITTI drive), label_2 and calib (KITTI object), "
                   "truth with left and right (flies synth), disp_noc (KITTI stereo) or truth.csv (foot points)");
}

}  // namespace

Dataset open_dataset(const fs::path& folder, const DatasetRequest& request) {
  Dataset dataset = open_folder(folder, request);
  dataset.load = [load = std::move(dataset.load)](std::size_t i) {
    TruthFrame frame = load(i);
    complete_boxes(frame.camera, frame.truth);
    return frame;
  };
  return dataset;
}

}  // namespace flies
