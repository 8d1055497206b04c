#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/dataset_kinds.hpp"
#include "flies/eval/disparity_map.hpp"
#include "flies/eval/foot_truth.hpp"
#include "flies/eval/scene_truth.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/pair_matching.hpp"

namespace flies {

namespace fs = std::filesystem;

namespace {

/// How the vehicle moved from one moment to another.
EgoMotion motion_between(const VehicleMoment& from, const VehicleMoment& to) {
  EgoMotion motion;
  motion.is_known = true;
  motion.dt_s = to.time_s - from.time_s;
  const double turn_rad =
      std::remainder(to.yaw_rad - from.yaw_rad, 2.0 * std::numbers::pi);  // a heading may be wrapped
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
    const fs::path file = folder / "truth" / (detail::stem_of(pair.left) + ".json");
    const auto moment = read_scene_truth(file, SceneUse::in_sequence).moment;
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
  if (!request.calib.empty() || !detail::is_there_as_folder(calibrations))
    return [camera = shared_camera(folder, request, dataset)](const std::string&) { return camera; };
  CalibrationRequest wanted = calibration_request(request);
  const auto calibration_of = [calibrations](const std::string& name, const CalibrationRequest& with) {
    const std::string file = (calibrations / (name + ".yaml")).string();
    const Calibration calibration = load_calibration(file, with);
    if (calibration.rectifier) refuse_raw(file);
    return std::pair(calibration, file);
  };
  const auto [first, first_file] = calibration_of(detail::stem_of(dataset.pairs.front().left), wanted);
  add_notes(first, first_file, dataset.notes);
  if (const auto mount = mount_from_road(dataset.pairs, first.camera, request, dataset.notes))
    wanted = with_mount(wanted, *mount);
  return [calibration_of, wanted](const std::string& name) { return calibration_of(name, wanted).first.camera; };
}

void add_scene_files(const fs::path& folder, Dataset& dataset) {
  for (const auto& pair : dataset.pairs) {
    const std::string name = detail::stem_of(pair.left);
    add_files({folder / "truth" / (name + ".json"), folder / "disparity" / (name + ".png"),
               folder / "calib" / (name + ".yaml")},
              dataset);
  }
  add_files({folder / "times.txt"}, dataset);
}

}  // namespace

Dataset open_scenes(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  Dataset dataset{.kind = TruthKind::scenes};
  auto found = match_all((folder / "left").string(), (folder / "right").string());
  dataset.pairs = std::move(found.pairs);
  dataset.notes = std::move(found.notes);
  const auto truths = std::ranges::count_if(detail::files_of(folder / "truth"),
                                            [](const fs::path& file) { return file.extension() == ".json"; });
  if (static_cast<std::size_t>(truths) != dataset.pairs.size())
    throw InputError((folder / "truth").string(), "",
                     fmt::format("found {} JSON files, expected {}, one per pair", truths, dataset.pairs.size()));
  add_scene_files(folder, dataset);
  const auto camera_of = camera_of_scenes(folder, request, dataset);
  if (detail::is_there(folder / "times.txt")) add_moments(folder, dataset);
  const SceneUse use = dataset.is_sequence ? SceneUse::in_sequence : SceneUse::alone;
  dataset.load = [folder, camera_of, use, pairs = dataset.pairs](std::size_t i) {
    const std::string name = detail::stem_of(pairs[i].left);
    StereoCamera camera = camera_of(name);
    TruthFrame frame{load_images(pairs[i], camera), {}, read_scene_truth(folder / "truth" / (name + ".json"), use)};
    camera.width_px = frame.images.left.width_px;
    camera.height_px = frame.images.left.height_px;
    frame.camera = camera;
    frame.truth.frame = static_cast<int>(i);
    if (const fs::path map = folder / "disparity" / (name + ".png"); detail::is_there(map))
      frame.truth.map = read_disparity_map(map, camera);
    return frame;
  };
  return dataset;
}

Dataset open_foot_points(const fs::path& folder, const DatasetRequest& request) {
  refuse_cameras(folder, request);
  std::set<fs::path> lefts;
  for (const auto& file : detail::files_of(folder))
    if (file.stem().string().ends_with("_0")) lefts.insert(file);
  if (lefts.empty()) throw InputError(folder.string(), "", "holds no left images, expected names that end in _0");
  Dataset dataset{.kind = TruthKind::foot_points, .is_sequence = true};
  for (const auto& left : lefts) {
    std::string stem = left.stem().string();
    stem.back() = '1';
    dataset.pairs.push_back({left.string(), (folder / (stem + left.extension().string())).string()});
  }
  const StereoCamera camera = shared_camera(folder, request, dataset);
  add_files({folder / "truth.csv"}, dataset);
  auto truths = read_foot_points(folder / "truth.csv", camera);
  if (truths.size() > dataset.pairs.size())
    throw InputError((folder / "truth.csv").string(), "frame",
                     fmt::format("found {}, but there are {} pairs", truths.size(), dataset.pairs.size()));
  truths.resize(dataset.pairs.size());  // nobody stands in the pairs after the last entry
  for (std::size_t i = 0; i < truths.size(); ++i) {
    truths[i].frame = static_cast<int>(i);
    truths[i].name = detail::stem_of(dataset.pairs[i].left);
  }
  dataset.load = [camera, truths = std::move(truths), pairs = dataset.pairs](std::size_t i) {
    return TruthFrame{load_images(pairs[i], camera), camera, truths[i]};
  };
  return dataset;
}

}  // namespace flies
