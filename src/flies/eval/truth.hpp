#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/eval/footprint.hpp"

namespace flies {

/// A labelled object of one frame.
struct LabelledObject {
  std::string type;  ///< as the labels say: "Car", "Van", "Pedestrian", "Cyclist", ...
  int track = -1;    ///< number of its track or of its line in the label file
  Footprint footprint;
  double bottom_z_m = 0.0;
  double height_m = 0.0;
  int occlusion = 0;              ///< as labelled: 0 visible, 1 partly, 2 largely, 3 unknown
  double truncation = 0.0;        ///< labelled fraction outside the image, 0 to 1
  double in_view_fraction = 1.0;  ///< of its projected box that lies inside the left image
  int lidar_points = 0;           ///< inside the box and clear of the road
  bool visible = true;            ///< to be found: enough of it in view and not heavily occluded or truncated
  ImageBox box = {};              ///< in the left image, as labelled, else see `complete_boxes`
};

/// A lidar return in the vehicle frame.
struct LidarPoint {
  Point3 point;
  double above_road_m = 0.0;  ///< over the locally fitted road
};

/// When a pair was taken, and where the vehicle frame was then, in that of another time.
struct VehicleMoment {
  double time_s = 0.0;
  double x_m = 0.0, y_m = 0.0, yaw_rad = 0.0;
};

/// What is known about one pair.
struct FrameTruth {
  int frame = 0;
  std::string name;  ///< file name stem of its left image
  std::vector<LabelledObject> objects;
  std::vector<LidarPoint> lidar;     ///< empty when there was none
  std::vector<LidarPoint> map = {};  ///< points of a disparity map, see disparity_map.hpp; empty when there was none
  std::vector<ImageBox> ignored_regions;     ///< of the left image, where people may stand that nobody labelled
  std::optional<VehicleMoment> moment = {};  ///< of a pair of a drawn sequence
};

/// A point of the left camera's frame (x right, y down, z forward along the optical axis, > 0) in the vehicle frame.
Point3 vehicle_from_left_camera(const StereoCamera& camera, const Projection& projection, const Point3& in_camera);

/// Measures every lidar point over the road near it: a plane is fitted to the whole scene from the nominal ground
/// upwards, then corrected by the low end of the returns in the 1 m cells around the point, so that slopes, kerbs
/// and crowned roads do not turn into obstacles. A point that is not finite has no height over the road: NaN.
std::vector<LidarPoint> measure_above_road(std::span<const Point3> points);

/// Fills `in_view_fraction`, and `lidar_points` when there is lidar.
void measure_visibility(const StereoCamera& camera, FrameTruth& truth);

/// Gives every object without a labelled box that of an upright board of its height and seen width through its middle:
/// for a person, head to feet.
void complete_boxes(const StereoCamera& camera, FrameTruth& truth);

/// Fraction of the object's projected box that nearer objects of the frame leave free, 0 to 1.
double free_fraction(const StereoCamera& camera, const FrameTruth& truth, const LabelledObject& object);

/// True when the lidar point belongs to the object: inside its box, grown by 0.1 m for label noise, and clear of the
/// road.
bool is_on_object(const LabelledObject& object, const LidarPoint& lidar);

}  // namespace flies
