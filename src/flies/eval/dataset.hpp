#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/ego/ego_motion.hpp"
#include "flies/eval/truth.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/io/pair_source.hpp"

namespace flies {

/// What a folder of pairs with truth holds. docs/evaluation.md describes each.
enum class TruthKind {
  kitti_drive,   ///< tracklet_labels.xml, image_00 ..., velodyne_points; calibration beside the folder
  kitti_object,  ///< label_2, calib, image_2, image_3 and perhaps velodyne
  scenes,        ///< left, right, truth/*.json and a calibration: `flies synth`, or any program's
  foot_points,   ///< truth.csv, extrinsics.yml and images that end in _0 and _1
  kitti_stereo,  ///< disp_noc, image_0, image_1 and a calibration an image size; no labelled objects
};
inline constexpr std::array<std::string_view, 5> kTruthKindNames = {
    "KITTI drive", "KITTI object folder", "folder of scenes", "folder of foot points", "KITTI stereo folder"};

/// What the user adds to a folder.
struct DatasetRequest {
  std::string calib;  ///< for scenes, foot points and KITTI stereo, where the folder holds no calibration
  std::optional<std::array<int, 2>> cameras;  ///< of a KITTI drive, left and right; else 0 and 1 if there, else 2 and 3
  std::optional<double> baseline_m, camera_height_m, camera_pitch_rad, camera_roll_rad;  ///< overrule the calibration
  double disparity_shift_px = 0.0;  ///< pixels, added to every disparity (`CalibrationRequest`)
  bool find_mount = false;          ///< take the mount from the road where it clearly lies elsewhere (`find_mount`)
};

/// One pair with its camera and truth.
struct TruthFrame {
  GrayPair images;
  StereoCamera camera;
  FrameTruth truth;
};

/// Pairs whose truth is known. Images and truth are read when they are asked for, so that folders of any size will do.
struct Dataset {
  TruthKind kind = TruthKind::scenes;
  bool is_sequence = false;             ///< consecutive pairs of one drive; otherwise each pair stands alone
  std::vector<PairPaths> pairs = {};    ///< in order
  std::vector<std::string> notes = {};  ///< sentences on what was assumed
  std::vector<std::string> files = {};  ///< that are read beside the images: calibrations, truth, times
  std::function<TruthFrame(std::size_t)> load = {};  ///< reads a pair by its index; throws InputError
  std::vector<double> times_s = {};                  ///< of the pairs, ascending; empty when not known
  std::vector<EgoMotion> true_ego = {};  ///< since the pair before, unknown at the first; empty when not known
};

/// Opens a folder; its kind is recognised from its content.
/// @throws InputError naming the folder when it holds none of the kinds, lacks a part of its kind, or the counts of
///         images and truth differ
Dataset open_dataset(const std::filesystem::path& folder, const DatasetRequest& request = {});

}  // namespace flies
