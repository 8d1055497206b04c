#include "channels/channel_schemas.hpp"

#include <cassert>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::ordered_json;

Json number() { return {{"type", "number"}}; }
Json integer() { return {{"type", "integer"}}; }
Json text() { return {{"type", "string"}}; }
Json flag() { return {{"type", "boolean"}}; }
Json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
Json list(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json object(const Json& properties) { return {{"type", "object"}, {"properties", properties}}; }

Json titled(const char* title, Json schema) {
  schema["title"] = title;
  return schema;
}

Json time() { return titled("time", object({{"sec", integer()}, {"nsec", integer()}})); }
Json duration() { return titled("duration", object({{"sec", integer()}, {"nsec", integer()}})); }
Json vector3() { return titled("foxglove.Vector3", object({{"x", number()}, {"y", number()}, {"z", number()}})); }
Json point2() { return titled("foxglove.Point2", object({{"x", number()}, {"y", number()}})); }
Json quaternion() {
  return titled("foxglove.Quaternion", object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}}));
}
Json pose() { return titled("foxglove.Pose", object({{"position", vector3()}, {"orientation", quaternion()}})); }
Json color() {
  return titled("foxglove.Color", object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}}));
}

/// What every message of the kind with a time and a frame begins with.
Json stamped(Json properties) {
  Json all = {{"timestamp", time()}, {"frame_id", text()}};
  all.update(properties);
  return object(all);
}

Json image_annotations() {
  const Json points = object({{"timestamp", time()},
                              {"type", integer()},
                              {"points", list(point2())},
                              {"outline_color", color()},
                              {"outline_colors", list(color())},
                              {"fill_color", color()},
                              {"thickness", number()}});
  const Json texts = object({{"timestamp", time()},
                             {"position", point2()},
                             {"text", text()},
                             {"font_size", number()},
                             {"text_color", color()},
                             {"background_color", color()}});
  return object({{"circles", list(object(Json::object()))}, {"points", list(points)}, {"texts", list(texts)}});
}

Json scene_update() {
  const Json cube = object({{"pose", pose()}, {"size", vector3()}, {"color", color()}});
  const Json arrow = object({{"pose", pose()},
                             {"shaft_length", number()},
                             {"shaft_diameter", number()},
                             {"head_length", number()},
                             {"head_diameter", number()},
                             {"color", color()}});
  const Json label = object({{"pose", pose()},
                             {"billboard", flag()},
                             {"font_size", number()},
                             {"scale_invariant", flag()},
                             {"color", color()},
                             {"text", text()}});
  const Json none = list(object(Json::object()));
  const Json entity = stamped({{"id", text()},
                               {"lifetime", duration()},
                               {"frame_locked", flag()},
                               {"metadata", list(object({{"key", text()}, {"value", text()}}))},
                               {"arrows", list(arrow)},
                               {"cubes", list(cube)},
                               {"spheres", none},
                               {"cylinders", none},
                               {"lines", none},
                               {"triangles", none},
                               {"texts", list(label)},
                               {"models", none}});
  const Json deletion = object({{"timestamp", time()}, {"type", integer()}, {"id", text()}});
  return object({{"deletions", list(deletion)}, {"entities", list(entity)}});
}

Json point_cloud() {
  const Json field = object({{"name", text()}, {"offset", integer()}, {"type", integer()}});
  return stamped({{"pose", pose()}, {"point_stride", integer()}, {"fields", list(field)}, {"data", bytes()}});
}

Json camera_calibration() {
  return stamped({{"width", integer()},
                  {"height", integer()},
                  {"distortion_model", text()},
                  {"D", list(number())},
                  {"K", list(number())},
                  {"R", list(number())},
                  {"P", list(number())}});
}

Json schema_of(const std::string& name) {
  if (name == "foxglove.CompressedImage") return stamped({{"data", bytes()}, {"format", text()}});
  if (name == "foxglove.CameraCalibration") return camera_calibration();
  if (name == "foxglove.ImageAnnotations") return image_annotations();
  if (name == "foxglove.LaserScan")
    return stamped({{"pose", pose()},
                    {"start_angle", number()},
                    {"end_angle", number()},
                    {"ranges", list(number())},
                    {"intensities", list(number())}});
  if (name == "foxglove.PointCloud") return point_cloud();
  if (name == "foxglove.SceneUpdate") return scene_update();
  if (name == "foxglove.PoseInFrame") return stamped({{"pose", pose()}});
  if (name == "foxglove.FrameTransform")
    return object({{"timestamp", time()},
                   {"parent_frame_id", text()},
                   {"child_frame_id", text()},
                   {"translation", vector3()},
                   {"rotation", quaternion()}});
  if (name == "foxglove.Log")
    return object({{"timestamp", time()},
                   {"level", integer()},
                   {"message", text()},
                   {"name", text()},
                   {"file", text()},
                   {"line", integer()}});
  assert(name == "flies.Record");
  return object(Json::object());
}

}  // namespace

std::string channel_schema(const std::string& name) { return titled(name.c_str(), schema_of(name)).dump(); }
