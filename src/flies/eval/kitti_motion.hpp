#pragma once

#include <filesystem>
#include <vector>

namespace flies {

/// How a KITTI raw drive's camera moved by its GPS/IMU (`oxts`), at the time of a pair.
struct KittiMotion {
  double time_s = 0.0;  ///< since the first pair of the drive
  double vx_mps = 0.0;  ///< over ground, of the left grey camera: forward
  double vy_mps = 0.0;  ///< to the left
  double yaw_rate_rps = 0.0;
};

/// The motion at every pair of the drive, in order, up to the first without a file.
/// @throws InputError when a file is missing or malformed
std::vector<KittiMotion> read_kitti_motion(const std::filesystem::path& drive);

}  // namespace flies
