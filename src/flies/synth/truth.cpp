#include "flies/synth/truth.hpp"

#include <fmt/format.h>

#include <cmath>

#include "flies/io/kitti_place.hpp"

namespace flies {
namespace {

const char* kitti_type(ObjectClass kind) {
  switch (kind) {
    case ObjectClass::pedestrian:
      return "Pedestrian";
    case ObjectClass::cyclist:
      return "Cyclist";
    case ObjectClass::car:
      return "Car";
    case ObjectClass::wall:
    case ObjectClass::ground:
    case ObjectClass::backdrop:
    case ObjectClass::shelf:
    case ObjectClass::kerb:
      return "DontCare";
    case ObjectClass::hedge:
    case ObjectClass::pole:
    case ObjectClass::tree:
    case ObjectClass::box:
    case ObjectClass::furniture:
    case ObjectClass::pallet:
      return "Misc";
  }
  return "Misc";
}

std::string box_text(const ImageBox& box) {
  return fmt::format("{:.2f} {:.2f} {:.2f} {:.2f}", box.u_px, box.v_px, box.u_px + box.width_px,
                     box.v_px + box.height_px);
}

std::string json_box(const ImageBox& box) {
  return fmt::format(R"({{"u_px": {:.3f}, "v_px": {:.3f}, "width_px": {:.3f}, "height_px": {:.3f}}})", box.u_px,
                     box.v_px, box.width_px, box.height_px);
}

}  // namespace

std::string kitti_labels(const std::vector<TruthObject>& objects, const StereoCamera& camera) {
  std::string text;
  for (const auto& object : objects) {
    if (object.visible_px == 0) continue;
    const std::string type = kitti_type(object.kind);
    if (type == "DontCare") {
      text += fmt::format("DontCare -1 -1 -10 {} -1 -1 -1 -1000 -1000 -1000 -10\n", box_text(object.box));
      continue;
    }
    const auto foot = kitti_place(camera, {object.x_m, object.y_m, object.z_m});
    if (!foot) continue;
    const double heading_rad = kitti_heading_rad(object.yaw_rad);
    const double alpha_rad = wrapped_rad(heading_rad - std::atan2(foot->right_m, foot->forward_m));
    const int occluded = object.occlusion < 0.15 ? 0 : object.occlusion < 0.5 ? 1 : 2;
    text += fmt::format("{} {:.2f} {} {:.2f} {} {:.2f} {:.2f} {:.2f} {:.3f} {:.3f} {:.3f} {:.2f}\n", type,
                        object.truncation, occluded, alpha_rad, box_text(object.box), object.height_m, object.width_m,
                        object.length_m, foot->right_m, foot->down_m, foot->forward_m, heading_rad);
  }
  return text;
}

std::string truth_json(const std::vector<TruthObject>& objects, const StereoCamera& camera, std::uint64_t seed,
                       const std::optional<TruthMoment>& moment) {
  std::string text =
      fmt::format("{{\"seed\": {}, \"width_px\": {}, \"height_px\": {},\n", seed, camera.width_px, camera.height_px);
  if (moment)
    text += fmt::format(" \"time_s\": {:.6f}, \"pose\": {{\"x_m\": {:.5f}, \"y_m\": {:.5f}, \"yaw_rad\": {:.6f}}},\n",
                        moment->time_s, moment->pose.x_m, moment->pose.y_m, moment->pose.yaw_rad);
  text += " \"objects\": [";
  const char* separator = "\n";
  for (const auto& o : objects) {
    text += separator;
    separator = ",\n";
    text += fmt::format(
        R"(  {{"id": {}, "class": "{}", "x_m": {:.4f}, "y_m": {:.4f}, "z_m": {:.4f}, "yaw_rad": {:.4f}, "length_m": {:.4f}, )"
        R"("width_m": {:.4f}, "height_m": {:.4f}, "vx_mps": {:.4f}, "vy_mps": {:.4f}, "range_m": {:.4f}, "near_range_m": {:.4f}, "box": {}, )"
        R"("whole_box": {}, "truncation": {:.4f}, "occlusion": {:.4f}, "visible_px": {}}})",
        o.scene_index, kObjectClassNames[static_cast<std::size_t>(o.kind)], o.x_m, o.y_m, o.z_m, o.yaw_rad, o.length_m,
        o.width_m, o.height_m, o.vx_mps, o.vy_mps, std::hypot(o.x_m, o.y_m), o.near_range_m, json_box(o.box),
        json_box(o.whole_box), o.truncation, o.occlusion, o.visible_px);
  }
  return text + "\n ]}\n";
}

}  // namespace flies
