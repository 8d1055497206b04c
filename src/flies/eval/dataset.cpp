#include "flies/eval/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/disparity_map.hpp"
#include "flies/eval/foot_truth.hpp"
#include "flies/eval/kitti_motion.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/scene_truth.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/images.hpp"
#include "flies/road/find_mount.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCalibrationNames[] = {"calib.yaml", "calib.txt", "extrinsics.yml"};

CalibrationRequest calibration_request(const DatasetRequest& request) {
  CalibrationRequest wanted;
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

[[noreturn]] void refuse_raw(const std::string& calibration_file) {
  throw InputError(calibration_file, "",
                   "belongs to raw images, expected that of the rectified images whose truth is known");
}

/// The mount of a camera by the road of up to five pairs of its size, spread over all; nothing when it is as told or
/// not asked for.
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

/// A request for the calibrations of pairs that have one each, with that mount.
CalibrationRequest with_mount(CalibrationRequest wanted, const CameraMount& mount) {
  wanted.camera_height_m = mount.height_m;
  wanted.camera_pitch_rad = mount.pitch_rad;
  wanted.camera_roll_rad = mount.roll_rad;
  return wanted;
}

/// The camera of a folder in which all pairs share one.
StereoCamera shared_camera(const fs::path& folder, const DatasetRequest& request, Dataset& dataset) {
  const GrayPair images = load_pair(dataset.pairs.front().left, dataset.pairs.front().right);
  const RectifiedPair first = images.view();
  std::string file = request.calib;
  for (const char* name : kCalibrationNames)
    if (file.empty() && fs::exists(folder / name)) file = (folder / name).string();
  if (file.empty()) throw InputError(folder.string(), "calib.yaml", "not found, give a calibration");
  CalibrationRequest wanted = calibration_request(request);
  wanted.width_px = first.left.width_px;
  wanted.height_px = first.left.height_px;
  const Calibration calibration = load_calibration(file, wanted);
  if (calibration.rectifier) refuse_raw(file);
  check_camera_fits(calibration.camera, first.left.width_px, first.left.height_px, file);
  if (!calibration.has_height)
    dataset.notes.push_back(
        fmt::format("{}: holds no camera height, {} m assumed", file, calibration.camera.mount.height_m));
  StereoCamera camera = calibration.camera;
  camera.width_px = first.left.width_px;
  camera.height_px = first.left.height_px;
  if (const auto mount = mount_from_road(dataset.pairs, camera, request, dataset.notes)) camera.mount = *mount;
  return camera;
}

GrayPair load_images(const PairPaths& pair) { return load_pair(pair.left, pair.right); }

/// The same with the check that they fit.
GrayPair load_images(const PairPaths& pair, const StereoCamera& camera) {
  GrayPair images = load_images(pair);
  check_camera_fits(camera, images.left.width_px, images.left.height_px, pair.left);
  return images;
}

std::string stem_of(const std::string& path) { return fs::path(path).stem().string(); }

/// Times and motion of the pairs of a drive; left empty where its GPS/IMU does not cover them from the first one on.
/// The laser triggers the cameras evenly, while the times of the GPS/IMU step by 10 ms: over all pairs both keep the
/// same time, so even times are right.
void add_motion(const fs::path& drive, Dataset& dataset) {
  if (!fs::exists(drive / "oxts" / "timestamps.txt")) return;
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

Dataset open_kitti_drive(const fs::path& folder, const DatasetRequest& request) {
  refuse_calib(folder, request);
  const bool has_grey = fs::is_directory(folder / "image_00") && fs::is_directory(folder / "image_01");
  const auto cameras = request.cameras.value_or(has_grey ? std::array{0, 1} : std::array{2, 3});
  const auto images = [&](int camera) { return (folder / fmt::format("image_{:02}", camera) / "data").string(); };
  CalibrationRequest wanted = calibration_request(request);
  wanted.cameras = cameras;
  // The calibration lies beside the drive, which may be given as "." or with a slash at its end.
  const fs::path drive = (fs::absolute(folder) / "").lexically_normal().parent_path();
  StereoCamera camera = load_calibration((drive.parent_path() / "calib_cam_to_cam.txt").string(), wanted).camera;

  Dataset dataset{.kind = TruthKind::kitti_drive, .is_sequence = true};
  dataset.pairs = find_pairs(images(cameras[0]), images(cameras[1]));
  if (const auto mount = mount_from_road(dataset.pairs, camera, request, dataset.notes)) camera.mount = *mount;
  const auto truth = std::make_shared<KittiDrive>(drive, camera, cameras[0]);
  add_motion(drive, dataset);
  dataset.load = [truth, camera, pairs = dataset.pairs](std::size_t i) {
    return TruthFrame{load_images(pairs[i], camera), camera, truth->read(stem_of(pairs[i].left))};
  };
  return dataset;
}

Dataset open_kitti_object(const fs::path& folder, const DatasetRequest& request) {
  refuse_calib(folder, request);
  refuse_cameras(folder, request);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "label_2"))
    if (entry.path().extension() == ".txt" && !detail::is_hidden(entry.path()))
      names.insert(entry.path().stem().string());
  if (names.empty()) throw InputError((folder / "label_2").string(), "", "holds no labels, expected .txt files");
  Dataset dataset{.kind = TruthKind::kitti_object};
  for (const auto& name : names)
    dataset.pairs.push_back(
        {(folder / "image_2" / (name + ".png")).string(), (folder / "image_3" / (name + ".png")).string()});
  const auto camera_of = [folder](const std::string& name, const GrayPair& images, CalibrationRequest wanted) {
    wanted.width_px = images.left.width_px;
    wanted.height_px = images.left.height_px;
    StereoCamera camera = load_calibration((folder / "calib" / (name + ".txt")).string(), wanted).camera;
    camera.width_px = wanted.width_px;
    camera.height_px = wanted.height_px;
    return camera;
  };
  CalibrationRequest wanted = calibration_request(request);
  if (request.find_mount) {
    const StereoCamera first = camera_of(*names.begin(), load_images(dataset.pairs.front()), wanted);
    if (const auto mount = mount_from_road(dataset.pairs, first, request, dataset.notes))
      wanted = with_mount(wanted, *mount);
  }
  dataset.load = [folder, wanted, camera_of, pairs = dataset.pairs](std::size_t i) {
    const std::string name = stem_of(pairs[i].left);
    TruthFrame frame{load_images(pairs[i]), {}, {}};
    frame.camera = camera_of(name, frame.images, wanted);
    frame.truth = read_kitti_object(folder, name, frame.camera);
    return frame;
  };
  return dataset;
}

/// How the vehicle moved from one moment to another.
EgoMotion motion_between(const VehicleMoment& from, const VehicleMoment& to) {
  EgoMotion motion;
  motion.is_known = true;
  motion.dt_s = to.time_s - from.time_s;
  const double turn_rad = to.yaw_rad - from.yaw_rad;
  const double c = std::cos(to.yaw_rad), s = std::sin(to.yaw_rad);
  const double dx_m = to.x_m - from.x_m, dy_m = to.y_m - from.y_m;  // in the frame of the poses, then in that of `to`
  const double forward_m = c * dx_m + s * dy_m, left_m = -s * dx_m + c * dy_m;
  const double cos_turn = std::cos(turn_rad), sin_turn = std::sin(turn_rad);
  motion.current_from_previous.rotation = {{{cos_turn, sin_turn, 0}, {-sin_turn, cos_turn, 0}, {0, 0, 1}}};
  motion.current_from_previous.shift = {-forward_m, -left_m, 0.0};
  motion.vx_mps = forward_m / motion.dt_s;
  motion.vy_mps = left_m / motion.dt_s;
  motion.yaw_rate_rps = turn_rad / motion.dt_s;
  return motion;
}

/// Times and motion of a drawn sequence, from its truth.
void add_moments(const fs::path& folder, Dataset& dataset) {
  std::optional<VehicleMoment> before;
  for (const auto& pair : dataset.pairs) {
    const fs::path file = folder / "truth" / (stem_of(pair.left) + ".json");
    const auto moment = read_scene_truth(file).moment;
    if (!moment) throw InputError(file.string(), "time_s", "found none, expected one in each file of a sequence");
    if (before && moment->time_s <= before->time_s)
      throw InputError(file.string(), "time_s", "is not after that of the pair before");
    dataset.times_s.push_back(moment->time_s);
    dataset.true_ego.push_back(before ? motion_between(*before, *moment) : EgoMotion{});
    before = moment;
  }
  dataset.is_sequence = true;
}

/// The camera of a scene by its name: that of all, or of `calib/NAME.yaml`, for scenes of several cameras.
std::function<StereoCamera(const std::string&)> camera_of_scenes(const fs::path& folder, const DatasetRequest& request,
                                                                 Dataset& dataset) {
  const fs::path calibrations = folder / "calib";
  if (!request.calib.empty() || !fs::is_directory(calibrations))
    return [camera = shared_camera(folder, request, dataset)](const std::string&) { return camera; };
  CalibrationRequest wanted = calibration_request(request);
  const auto camera_of = [calibrations](const std::string& name, const CalibrationRequest& with) {
    const std::string file = (calibrations / (name + ".yaml")).string();
    const Calibration calibration = load_calibration(file, with);
    if (calibration.rectifier) refuse_raw(file);
    return calibration.camera;
  };
  const StereoCamera first = camera_of(stem_of(dataset.pairs.front().left), wanted);
  if (const auto mount = mount_from_road(dataset.pairs, first, request, dataset.notes))
    wanted = with_mount(wanted, *mount);
  return [camera_of, wanted](const std::string& name) { return camera_of(name, wanted); };
}

Dataset open_scenes(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  Dataset dataset{.kind = TruthKind::scenes};
  dataset.pairs = find_pairs((folder / "left").string(), (folder / "right").string());
  std::size_t truths = 0;
  for (const auto& entry : fs::directory_iterator(folder / "truth"))
    truths += entry.path().extension() == ".json" && !detail::is_hidden(entry.path());
  if (truths != dataset.pairs.size())
    throw InputError((folder / "truth").string(), "",
                     fmt::format("found {} JSON files, expected {}, one a pair", truths, dataset.pairs.size()));
  const auto camera_of = camera_of_scenes(folder, request, dataset);
  if (fs::exists(folder / "times.txt")) add_moments(folder, dataset);
  dataset.load = [folder, camera_of, pairs = dataset.pairs](std::size_t i) {
    const std::string name = stem_of(pairs[i].left);
    StereoCamera camera = camera_of(name);
    TruthFrame frame{load_images(pairs[i], camera), {}, read_scene_truth(folder / "truth" / (name + ".json"))};
    camera.width_px = frame.images.left.width_px;
    camera.height_px = frame.images.left.height_px;
    frame.camera = camera;
    frame.truth.frame = static_cast<int>(i);
    if (const fs::path map = folder / "disparity" / (name + ".png"); fs::exists(map))
      frame.truth.map = read_disparity_map(map, camera);
    return frame;
  };
  return dataset;
}

Dataset open_foot_points(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  std::set<fs::path> lefts;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().stem().string().ends_with("_0") && !detail::is_hidden(entry.path())) lefts.insert(entry.path());
  if (lefts.empty()) throw InputError(folder.string(), "", "holds no left images, expected names that end in _0");
  Dataset dataset{.kind = TruthKind::foot_points, .is_sequence = true};
  for (const auto& left : lefts) {
    std::string stem = left.stem().string();
    stem.back() = '1';
    dataset.pairs.push_back({left.string(), (folder / (stem + left.extension().string())).string()});
  }
  const StereoCamera camera = shared_camera(folder, request, dataset);
  auto truths = read_foot_points(folder / "truth.csv", camera);
  if (truths.size() > dataset.pairs.size())
    throw InputError((folder / "truth.csv").string(), "frame",
                     fmt::format("found {}, but there are {} pairs", truths.size(), dataset.pairs.size()));
  truths.resize(dataset.pairs.size());  // nobody stands in the pairs after the last entry
  for (std::size_t i = 0; i < truths.size(); ++i) {
    truths[i].frame = static_cast<int>(i);
    truths[i].name = stem_of(dataset.pairs[i].left);
  }
  dataset.load = [camera, truths = std::move(truths), pairs = dataset.pairs](std::size_t i) {
    return TruthFrame{load_images(pairs[i], camera), camera, truths[i]};
  };
  return dataset;
}

/// The pairs with a disparity map: the full folders have a second, later pair of each place without one.
Dataset open_kitti_stereo(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "disp_noc"))
    if (entry.path().extension() == ".png" && !detail::is_hidden(entry.path()))
      names.insert(entry.path().stem().string());
  if (names.empty())
    throw InputError((folder / "disp_noc").string(), "", "holds no disparity maps, expected .png files");
  Dataset dataset{.kind = TruthKind::kitti_stereo};
  for (const auto& name : names)
    dataset.pairs.push_back(
        {(folder / "image_0" / (name + ".png")).string(), (folder / "image_1" / (name + ".png")).string()});
  const auto camera_of = [folder, file = request.calib](const GrayPair& images, CalibrationRequest wanted) {
    wanted.width_px = images.left.width_px;
    wanted.height_px = images.left.height_px;
    const std::string calib =
        file.empty() ? (folder / fmt::format("calib_{}x{}.yaml", wanted.width_px, wanted.height_px)).string() : file;
    const Calibration calibration = load_calibration(calib, wanted);
    if (calibration.rectifier) refuse_raw(calib);
    StereoCamera camera = calibration.camera;
    camera.width_px = wanted.width_px;
    camera.height_px = wanted.height_px;
    return camera;
  };
  CalibrationRequest wanted = calibration_request(request);
  if (request.find_mount) {
    const StereoCamera first = camera_of(load_images(dataset.pairs.front()), wanted);
    if (const auto mount = mount_from_road(dataset.pairs, first, request, dataset.notes))
      wanted = with_mount(wanted, *mount);
  }
  dataset.load = [folder, wanted, camera_of, pairs = dataset.pairs](std::size_t i) {
    TruthFrame frame{load_images(pairs[i]), {}, {}};
    frame.camera = camera_of(frame.images, wanted);
    frame.truth.frame = static_cast<int>(i);
    frame.truth.name = stem_of(pairs[i].left);
    frame.truth.map = read_disparity_map(folder / "disp_noc" / (frame.truth.name + ".png"), frame.camera);
    frame.truth.lidar = frame.truth.map;  // the maps are lidar, gathered over several turns
    return frame;
  };
  return dataset;
}

/// Recognises the kind.
Dataset open_folder(const fs::path& folder, const DatasetRequest& request) {
  if (!fs::is_directory(folder)) throw InputError(folder.string(), "", "is not a folder");
  const auto has = [&](const char* name) { return fs::exists(folder / name); };
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
