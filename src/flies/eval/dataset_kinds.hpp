#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "flies/eval/dataset.hpp"
#include "flies/io/calibration.hpp"

// What `open_dataset` is made of: one function a kind of folder, and what those share.
namespace flies {

Dataset open_kitti_drive(const std::filesystem::path& folder, const DatasetRequest& request);
Dataset open_kitti_object(const std::filesystem::path& folder, const DatasetRequest& request);
/// The pairs with a disparity map: the full folders have a second, later pair of each place without one.
Dataset open_kitti_stereo(const std::filesystem::path& folder, const DatasetRequest& request);
Dataset open_scenes(const std::filesystem::path& folder, const DatasetRequest& request);
Dataset open_foot_points(const std::filesystem::path& folder, const DatasetRequest& request);

CalibrationRequest calibration_request(const DatasetRequest& request);
/// A request for the calibrations of pairs that have one each, with that mount.
CalibrationRequest with_mount(CalibrationRequest wanted, const CameraMount& mount);

/// @throws InputError when a calibration was given for a folder that has its own
void refuse_calib(const std::filesystem::path& folder, const DatasetRequest& request);
/// @throws InputError when cameras were chosen that the folder does not have
void refuse_cameras(const std::filesystem::path& folder, const DatasetRequest& request);
[[noreturn]] void refuse_raw(const std::string& calibration_file);

/// Adds those files that are there to the ones that are read.
void add_files(std::initializer_list<std::filesystem::path> files, Dataset& dataset);

/// Notes on a calibration with the name of its file.
void add_notes(const Calibration& calibration, const std::string& file, std::vector<std::string>& notes);

/// The mount of a camera by the road of up to five pairs of its size, spread over all; nothing when it is as told or
/// not asked for.
std::optional<CameraMount> mount_from_road(const std::vector<PairPaths>& pairs, const StereoCamera& camera,
                                           const DatasetRequest& request, std::vector<std::string>& notes);

/// The camera of a folder in which all pairs share one.
StereoCamera shared_camera(const std::filesystem::path& folder, const DatasetRequest& request, Dataset& dataset);

GrayPair load_images(const PairPaths& pair);
/// The same with the check that they fit the camera.
GrayPair load_images(const PairPaths& pair, const StereoCamera& camera);

}  // namespace flies
