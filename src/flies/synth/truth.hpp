#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/synth/scene.hpp"

namespace flies {

/// What lies behind the centre of every left pixel; row-major, width_px * height_px entries in each.
struct PixelTruth {
  int width_px = 0;
  int height_px = 0;
  std::vector<float> disparity_px;  ///< exact; NaN where the sky is seen
  std::vector<int> object;          ///< index into the scene's objects, -1 for the sky

  std::size_t index(int u_px, int v_px) const {
    return static_cast<std::size_t>(v_px) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u_px);
  }
};

/// An obstacle of the scene that the left camera has in its field of view.
struct TruthObject {
  ObjectClass kind = ObjectClass::pedestrian;
  std::size_t scene_index = 0;  ///< into the scene's objects and of `PixelTruth::object`; its "id" in JSON
  double x_m = 0.0;             ///< centre of the footprint, vehicle frame
  double y_m = 0.0;
  double z_m = 0.0;  ///< of its lowest point
  double yaw_rad = 0.0;
  double length_m = 0.0;  ///< along the yaw
  double width_m = 0.0;
  double height_m = 0.0;
  double vx_mps = 0.0;  ///< over ground, vehicle frame
  double vy_mps = 0.0;
  double near_range_m = 0.0;   ///< horizontal distance from the camera to the nearest point of the footprint
  ImageBox whole_box;          ///< around the whole object, as if nothing hid it and the image had no border
  ImageBox box;                ///< the same cut at the border of the image
  double truncation = 0.0;     ///< share of `whole_box` outside the image
  double occlusion = 0.0;      ///< share of its silhouette inside the image that other objects hide
  std::size_t visible_px = 0;  ///< pixels of the left image that show it
};

/// One line per object in the format of KITTI's label_2, nearest first. Positions are in the coordinates of the left
/// camera (x right, y down, z along its axis), at the middle of the footprint. Pedestrians and cars have their own
/// type; poles, trees, hedges, boxes, furniture and pallets are `Misc`; house fronts, walls, shelves and kerbs are
/// `DontCare` regions, for KITTI does not label buildings. Objects of which not one pixel is seen are left out.
/// Occluded is 0 below 15 % hidden, 1 below 50 %, else 2.
std::string kitti_labels(const std::vector<TruthObject>& objects, const StereoCamera& camera);

/// Where the vehicle frame stands on the ground, in its own frame of an earlier time.
struct VehiclePose {
  double x_m = 0.0, y_m = 0.0;
  double yaw_rad = 0.0;  ///< positive to the left
};

/// When a pair of a sequence was taken, and from where.
struct TruthMoment {
  double time_s = 0.0;
  VehiclePose pose;  ///< in the vehicle frame of the first pair
};

/// The objects and the options' seed as a JSON object; every number has its unit in its key.
/// @param moment of a pair of a sequence; nothing of a pair that stands alone
std::string truth_json(const std::vector<TruthObject>& objects, const StereoCamera& camera, std::uint64_t seed,
                       const std::optional<TruthMoment>& moment = std::nullopt);

}  // namespace flies
