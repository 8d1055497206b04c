#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

enum class SceneKind {
  street,      ///< town street: facades, parked and driving cars, poles, trees, people
  crossing,    ///< the same street with a zebra crossing that people walk over
  empty_road,  ///< textured road and verges, nothing stands on them
  pedestrian,  ///< one person on the empty road, `people_min_range_m` ahead
  wall,        ///< one wall across the empty road, `people_min_range_m` ahead
  room,        ///< a room with tables, chairs, cupboards and boxes, for a camera 1 m above its floor
  aisle,       ///< the aisle of a store between shelves, with pallets and boxes in it
  woods,       ///< trunks and crowns before a drone, far above the ground
  pavement,    ///< kerbs, boxes, bollards, tables and legs before a low rover
};
template <>
struct EnumNames<SceneKind> {
  static constexpr std::array<std::string_view, 9> names = {"street", "crossing", "empty_road", "pedestrian", "wall",
                                                            "room",   "aisle",    "woods",      "pavement"};
};

/// Everything that decides a synthetic pair. The scene and its images are a pure function of these values.
struct SceneOptions {
  std::uint64_t seed = 1;
  SceneKind kind = SceneKind::street;
  int people = 6;
  int cars = 5;
  int poles = 6;
  int trees = 5;
  int things = 8;
  double people_min_range_m = 6.0;
  double people_max_range_m = 30.0;
  double children = 0.15;
  double sun_elevation_deg = 55.0;
  double sun_azimuth_deg = 115.0;
  double sun_strength = 1.0;
  double ambient = 0.55;
  double texture_contrast = 1.0;

  int width_px = 1242;
  int height_px = 375;
  double focal_px = 721.5;
  double baseline_m = 0.54;
  double camera_height_m = 1.65;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;

  int samples_per_side = 2;
  double blur_px = 0.5;
  double noise_gray = 1.5;
  double gain_difference = 0.0;
  double vertical_offset_px = 0.0;
  double relative_roll_deg = 0.0;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "seed of layout, looks and sensor noise; same options give the same pixels");
    field("kind", self.kind, "kind of place, and what stands there");
    field("people", self.people, Range{0, 60}, "people wanted; fewer when no free visible place is found");
    field("cars", self.cars, Range{0, 20}, "parked and driving cars wanted");
    field("poles", self.poles, Range{0, 30}, "lamp posts, sign posts and bollards wanted");
    field("trees", self.trees, Range{0, 60}, "trees wanted");
    field("things", self.things, Range{0, 40},
          "boxes, tables and the like wanted in a room, an aisle or on a pavement");
    field("people_min_range_m", self.people_min_range_m, Range{1, 100}, "nearest person, along x");
    field("people_max_range_m", self.people_max_range_m, Range{1, 100}, "farthest person, along x");
    field("children", self.children, Range{0, 1}, "share of people who are children, 1.0 to 1.45 m tall");
    field("sun_elevation_deg", self.sun_elevation_deg, Range{5, 90}, "sun above the horizon");
    field("sun_azimuth_deg", self.sun_azimuth_deg, Range{-360, 360}, "direction of the sun, from ahead to the left");
    field("sun_strength", self.sun_strength, Range{0, 4}, "light of the sun; 0 for an overcast sky");
    field("ambient", self.ambient, Range{0.05, 4}, "light of the sky");
    field("texture_contrast", self.texture_contrast, Range{0, 3}, "strength of surface texture, 1 is natural");
    field("width_px", self.width_px, Range{16, 8192}, "image width");
    field("height_px", self.height_px, Range{16, 8192}, "image height");
    field("focal_px", self.focal_px, Range{10, 20000}, "focal length of both cameras");
    field("baseline_m", self.baseline_m, Range{0.01, 5}, "distance between the cameras");
    field("camera_height_m", self.camera_height_m, Range{0.2, 10}, "cameras above the ground");
    field("pitch_deg", self.pitch_deg, Range{-30, 30}, "positive: the cameras look down");
    field("roll_deg", self.roll_deg, Range{-30, 30}, "positive: the left side is raised");
    field("samples_per_side", self.samples_per_side, Range{1, 8}, "rays per pixel: this number squared");
    field("blur_px", self.blur_px, Range{0, 3}, "standard deviation of the lens blur");
    field("noise_gray", self.noise_gray, Range{0, 50}, "standard deviation of sensor noise, grey levels");
    field("gain_difference", self.gain_difference, Range{-0.5, 0.5},
          "grey levels of the right image are 1 + this times those of the left");
    field("vertical_offset_px", self.vertical_offset_px, Range{-5, 5},
          "rectification error: the right image shows everything this much lower");
    field("relative_roll_deg", self.relative_roll_deg, Range{-2, 2},
          "rectification error: the right image is turned clockwise about its principal point");
  }
};

/// The options that a place usually goes with. Those of roads are the defaults; a room, an aisle, woods and a pavement
/// are seen by a small camera (640 x 480 px, baseline 0.12 m, for woods 0.2 m) 1 m, 0.5 m, 7 m and 0.3 m above the
/// ground, and indoors there is no sun.
SceneOptions scene_defaults(SceneKind kind);

/// The camera the options describe. The principal point sits where it does in the KITTI cameras, in proportion to
/// the image size; both cameras have the same one.
/// @throws InputError when an option is out of range
StereoCamera synthetic_camera(const SceneOptions& options);

}  // namespace flies
