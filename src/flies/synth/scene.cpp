#include "flies/synth/scene.hpp"

#include <numbers>

#include "flies/core/error.hpp"
#include "flies/synth/person.hpp"
#include "flies/synth/places.hpp"
#include "flies/synth/street.hpp"
#include "flies/synth/street_parts.hpp"

namespace flies {
using synth::Vec3;

namespace {

bool is_indoors(SceneKind kind) { return kind == SceneKind::room || kind == SceneKind::aisle; }

}  // namespace

Lighting lighting_of(const SceneOptions& options) {
  constexpr float kOpenReach_m = 4.0F, kIndoorReach_m = 0.6F;
  const double elevation = radians(options.sun_elevation_deg), azimuth = radians(options.sun_azimuth_deg);
  return {{static_cast<float>(std::cos(elevation) * std::cos(azimuth)),
           static_cast<float>(std::cos(elevation) * std::sin(azimuth)), static_cast<float>(std::sin(elevation))},
          static_cast<float>(options.sun_strength),
          static_cast<float>(options.ambient),
          is_indoors(options.kind) ? kIndoorReach_m : kOpenReach_m};
}

SceneOptions scene_defaults(SceneKind kind) {
  constexpr int kWidth_px = 640, kHeight_px = 480;
  constexpr double kFocal_px = 450.0, kBaseline_m = 0.12, kDroneBaseline_m = 0.2;
  SceneOptions options;
  options.kind = kind;
  const auto small_camera = [&](double baseline_m, double height_m, double pitch_deg) {
    options.width_px = kWidth_px;
    options.height_px = kHeight_px;
    options.focal_px = kFocal_px;
    options.baseline_m = baseline_m;
    options.camera_height_m = height_m;
    options.pitch_deg = pitch_deg;
  };
  const auto people = [&](int count, double max_range_m) {
    options.people = count;
    options.people_min_range_m = 1.5;
    options.people_max_range_m = max_range_m;
  };
  switch (kind) {
    case SceneKind::room:
      small_camera(kBaseline_m, 1.0, 10.0);
      people(1, 6.0);
      break;
    case SceneKind::aisle:
      small_camera(kBaseline_m, 0.5, 5.0);
      people(1, 10.0);
      break;
    case SceneKind::woods:
      small_camera(kDroneBaseline_m, 7.0, 0.0);
      people(0, 10.0);
      options.trees = 14;
      break;
    case SceneKind::pavement:
      small_camera(kBaseline_m, 0.3, 3.0);
      people(2, 8.0);
      break;
    case SceneKind::street:
    case SceneKind::crossing:
    case SceneKind::empty_road:
    case SceneKind::pedestrian:
    case SceneKind::wall:
      break;
  }
  if (is_indoors(kind)) {
    options.sun_strength = 0.0;
    options.ambient = 1.0;
  }
  return options;
}

StereoCamera synthetic_camera(const SceneOptions& options) {
  check_options(options, "scene options");
  // Where the principal point lies in the images of the KITTI cameras, 1242 x 375 px.
  constexpr double kCentreU = 609.5593 / 1242.0, kCentreV = 172.854 / 375.0;
  StereoCamera camera;
  camera.fx_px = camera.fy_px = options.focal_px;
  camera.cx_px = camera.cx_right_px = kCentreU * options.width_px;
  camera.cy_px = kCentreV * options.height_px;
  camera.baseline_m = options.baseline_m;
  camera.width_px = options.width_px;
  camera.height_px = options.height_px;
  camera.mount = {options.camera_height_m, radians(options.pitch_deg), radians(options.roll_deg)};
  return camera;
}

SyntheticScene build_scene(const SceneOptions& options) {
  check_options(options, "scene options");
  if (options.people_min_range_m > options.people_max_range_m)
    throw InputError("scene options", "people_min_range_m",
                     "found " + detail::double_text(options.people_min_range_m) + ", above people_max_range_m (" +
                         detail::double_text(options.people_max_range_m) + ")");
  SyntheticScene scene;
  scene.lighting = lighting_of(options);
  switch (options.kind) {
    case SceneKind::street:
    case SceneKind::crossing:
      scene.objects = synth::street(options);
      break;
    case SceneKind::room:
      scene.objects = synth::room(options);
      break;
    case SceneKind::aisle:
      scene.objects = synth::aisle(options);
      break;
    case SceneKind::woods:
      scene.objects = synth::woods(options);
      break;
    case SceneKind::pavement:
      scene.objects = synth::pavement(options);
      break;
    case SceneKind::empty_road:
      scene.objects = synth::country_road(options);
      break;
    case SceneKind::pedestrian: {
      scene.objects = synth::country_road(options);
      FlyRandom random(options.seed, synth::kPeoplePurpose, 0, 0);
      auto look = synth::random_look(random, false, static_cast<float>(options.texture_contrast));
      look.top.pattern = synth::Pattern::checks;  // texture is what this scene is for
      look.top.second = look.top.colour.x > 0.2F ? Vec3{0.03F, 0.03F, 0.05F} : Vec3{0.55F, 0.52F, 0.45F};
      look.top.scale_m = 0.06F;
      const auto yaw = static_cast<float>(random.uniform(-std::numbers::pi, std::numbers::pi));
      scene.objects.push_back(synth::stand(ObjectClass::pedestrian, synth::person(look),
                                           {{static_cast<float>(options.people_min_range_m), 0, 0}, yaw}));
      break;
    }
    case SceneKind::wall: {
      scene.objects = synth::country_road(options);
      FlyRandom random(options.seed, synth::kHousesPurpose, 0, 0);
      const auto mesh = synth::wall(random, 9.0F, 3.0F, 0.4F, static_cast<float>(options.texture_contrast));
      // Its face looks back at the camera.
      scene.objects.push_back(
          synth::stand(ObjectClass::wall, mesh,
                       {{static_cast<float>(options.people_min_range_m), -4.5F, 0}, std::numbers::pi_v<float> / 2.0F}));
      break;
    }
  }
  return scene;
}

}  // namespace flies
