#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/eval/truth.hpp"

namespace flies {

namespace detail {

/// lidar -> camera 0 -> rectified camera 0 -> left camera.
struct LidarPlace {
  std::array<std::array<double, 3>, 3> camera0_from_lidar{};
  Point3 camera0_from_lidar_shift;
  std::array<std::array<double, 3>, 3> rectification{};
  Point3 left_offset;

  Point3 in_left_camera(const Point3& in_lidar) const;
};

}  // namespace detail

/// A box of KITTI's tracklet_labels.xml in one frame, in the lidar's frame (x forward, y left, z up).
struct TrackletPose {
  std::string type;
  int track = 0;  ///< counts the tracklets of the file from 0
  int frame = 0;
  Point3 bottom_centre;  ///< in the lidar's frame
  double yaw_rad = 0.0;  ///< about the lidar's z axis
  double length_m = 0.0, width_m = 0.0, height_m = 0.0;
  int occlusion = 0;   ///< 0 visible, 1 partly, 2 fully occluded, -1 not labelled
  int truncation = 0;  ///< 0 in the image, 1 truncated, 2 outside, 99 behind it, -1 not labelled
};

/// Reads the text of a tracklet_labels.xml.
/// @param source file name for errors
/// @throws InputError on malformed XML, a missing or non-numeric field or a size that is not positive
std::vector<TrackletPose> parse_tracklets(std::string_view xml, const std::string& source);

/// A line of a KITTI label_2 file, in the frame of camera 0 (x right, y down, z forward).
struct KittiLabel {
  std::string type;
  double truncation = 0.0;  ///< 0 to 1
  int occlusion = 0;        ///< 0 visible, 1 partly, 2 largely, 3 unknown
  ImageBox box;             ///< in the left colour image
  double height_m = 0.0, width_m = 0.0, length_m = 0.0;
  Point3 bottom_centre;  ///< in camera 0
  double rotation_y_rad = 0.0;
};

/// Reads the text of a label file. `DontCare` lines hold a box, their other fields are meaningless.
/// @throws InputError naming the line when it does not hold 15 (or, with a score, 16) fields
std::vector<KittiLabel> parse_labels(std::string_view text, const std::string& source);

/// Truth of a KITTI raw drive folder (synced and rectified), read frame by frame.
/// An object is `visible` when at least half of its box lies in the image, its label is neither fully occluded nor
/// outside the image, and at least `kMinLidarPoints` lidar returns lie on it (without lidar: the label alone).
class KittiDrive {
 public:
  /// @param camera      the left camera; its mount places the vehicle frame
  /// @param left_camera which of the cameras 0 to 3 that is: their places differ
  /// @throws InputError when tracklet_labels.xml or the calibration beside the drive is missing or malformed
  KittiDrive(const std::filesystem::path& drive, const StereoCamera& camera, int left_camera);

  /// @param name stem of the frame's image, a number
  /// @throws InputError when the name is no number or the lidar file is damaged
  FrameTruth read(const std::string& name) const;

 private:
  std::filesystem::path drive_;
  StereoCamera camera_;
  detail::LidarPlace place_;
  std::vector<TrackletPose> poses_;
};

/// The truth of every frame with an image, in order.
std::vector<FrameTruth> read_kitti_drive(const std::filesystem::path& drive, const StereoCamera& camera,
                                         int left_camera);

/// Truth of one picture of a KITTI object folder (the one that holds `label_2`, `calib` and perhaps `velodyne`).
/// An object is `visible` when its labelled truncation is at most 0.5, half of its box lies in the image and it is
/// labelled visible or partly occluded; where the label says "unknown", at least half must be free of nearer objects.
/// Where there is lidar, `kMinLidarPoints` returns must lie on it as well: labels call a car behind a van "partly".
/// @param camera the left colour camera (2)
/// @throws InputError when the label or calibration file is missing or malformed
FrameTruth read_kitti_object(const std::filesystem::path& folder, const std::string& name, const StereoCamera& camera);

/// Fewest lidar returns on an object that is in view: a person at 40 m gives about 25.
inline constexpr int kMinLidarPoints = 10;

}  // namespace flies
