#include "channels/channels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "flies/core/base64.hpp"
#include "live/live_outputs.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kWorld = "world";
constexpr const char* kVehicle = "vehicle";
constexpr const char* kCamera = "left_camera";

Json number(double value, double scale = 1e4) {
  return std::isfinite(value) ? Json(std::round(value * scale) / scale + 0.0) : Json(0.0);
}
Json stamp(std::uint64_t time_ns) {
  constexpr std::uint64_t kSecond_ns = 1000000000;
  return {{"sec", time_ns / kSecond_ns}, {"nsec", time_ns % kSecond_ns}};
}
Json vector3(double x, double y, double z) { return {{"x", number(x)}, {"y", number(y)}, {"z", number(z)}}; }
Json color(double r, double g, double b, double a = 1.0) { return {{"r", r}, {"g", g}, {"b", b}, {"a", a}}; }
/// A turn about the upward axis.
Json turned(double yaw_rad) {
  return {{"x", 0.0}, {"y", 0.0}, {"z", number(std::sin(yaw_rad / 2), 1e6)}, {"w", number(std::cos(yaw_rad / 2), 1e6)}};
}
Json pose_at(double x, double y, double z, double yaw_rad = 0.0) {
  return {{"position", vector3(x, y, z)}, {"orientation", turned(yaw_rad)}};
}
Json class_color(bool is_person, double alpha = 1.0) {
  return is_person ? color(1.0, 0.3, 1.0, alpha) : color(1.0, 0.6, 0.1, alpha);
}

struct Stamped {
  const LiveFrame& frame;
  std::uint64_t time_ns;

  Json in(const char* frame_id) const { return {{"timestamp", stamp(time_ns)}, {"frame_id", frame_id}}; }
  const flies::Detection& detection() const { return frame.snapshot->tracking.detection; }
};

/// The message with the bytes as its "data". Base64 needs no escaping, which a JSON writer would look for digit by
/// digit.
std::string with_data(const Json& message, const auto& bytes) {
  std::string text = message.dump();
  text.back() = ',';
  return text + R"("data":")" + flies::to_base64(bytes) + R"("})";
}

std::string image(const Stamped& at, const std::vector<std::uint8_t>& jpeg) {
  Json message = at.in(kCamera);
  message["format"] = "jpeg";
  return with_data(message, jpeg);
}

Json calibration(const Stamped& at, bool is_right) {
  const auto& c = at.frame.camera;
  const double cx = is_right ? c.cx_right_px : c.cx_px;
  Json message = at.in(kCamera);
  message["width"] = c.width_px;
  message["height"] = c.height_px;
  message["distortion_model"] = "";
  message["D"] = Json::array();
  message["K"] = {c.fx_px, 0.0, cx, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0};
  message["R"] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  message["P"] = {c.fx_px, 0.0, cx, is_right ? -c.fx_px * c.baseline_m : 0.0, 0.0, c.fy_px, c.cy_px, 0.0, 0.0,
                  0.0,     1.0, 0.0};
  return message;
}

Json annotated_box(const Stamped& at, const flies::ImageBox& box, const Json& line_color) {
  constexpr int kLineLoop = 2;
  const auto corner = [&](double right, double down) {
    return Json{{"x", number(box.u_px + right * box.width_px)}, {"y", number(box.v_px + down * box.height_px)}};
  };
  return {{"timestamp", stamp(at.time_ns)},
          {"type", kLineLoop},
          {"points", {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}},
          {"outline_color", line_color},
          {"outline_colors", Json::array()},
          {"fill_color", color(0, 0, 0, 0)},
          {"thickness", 2.0}};
}

Json annotated_text(const Stamped& at, const flies::ImageBox& box, const std::string& text, const Json& text_color) {
  return {{"timestamp", stamp(at.time_ns)},
          {"position", {{"x", number(box.u_px)}, {"y", number(box.v_px)}}},
          {"text", text},
          {"font_size", 12.0},
          {"text_color", text_color},
          {"background_color", color(0, 0, 0, 0.6)}};
}

Json annotations(const Stamped& at) {
  Json points = Json::array(), texts = Json::array();
  for (const auto& track : at.frame.snapshot->tracking.tracks) {
    const Json own = class_color(track.kind == flies::TrackClass::person);
    points.push_back(annotated_box(at, track.box, own));
    char text[64];
    std::snprintf(text, sizeof text, "#%llu %.1f m", static_cast<unsigned long long>(track.id),
                  std::hypot(track.state.x_m, track.state.y_m));
    texts.push_back(annotated_text(at, track.box, text, own));
  }
  return {{"circles", Json::array()}, {"points", points}, {"texts", texts}};
}

/// JSON has no NaN: a range of 0 says that nothing was reported.
Json laser_scan(const Stamped& at) {
  const flies::Scan& scan = at.detection().scan;
  Json message = at.in(kVehicle);
  message["pose"] = pose_at(0, 0, 0);
  message["start_angle"] = scan.empty() ? 0.0 : scan.angle_rad(0);
  message["end_angle"] = scan.empty() ? 0.0 : scan.angle_rad(scan.size() - 1);
  Json ranges = Json::array(), intensities = Json::array();
  for (std::size_t i = 0; i < scan.size(); ++i) {
    ranges.push_back(number(scan.ranges_m[i], 1e3));
    intensities.push_back(number(scan.confidence[i], 1e3));
  }
  message["ranges"] = std::move(ranges);
  message["intensities"] = std::move(intensities);
  return message;
}

std::string point_cloud(const Stamped& at) {
  static_assert(std::endian::native == std::endian::little, "packed elements are little-endian");
  const flies::Population& flies = at.detection().evolved.flies;
  constexpr int kFloat32 = 7;
  std::string bytes;
  bytes.reserve(flies.size() * 4 * sizeof(float));
  for (std::size_t i = 0; i < flies.size(); ++i)
    for (const float value : {flies.x_m[i], flies.y_m[i], flies.z_m[i], flies.fitness[i]})
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  Json message = at.in(kVehicle);
  message["pose"] = pose_at(0, 0, 0);
  message["point_stride"] = 4 * sizeof(float);
  Json fields = Json::array();
  int offset = 0;
  for (const char* name : {"x", "y", "z", "fitness"}) {
    fields.push_back({{"name", name}, {"offset", offset}, {"type", kFloat32}});
    offset += static_cast<int>(sizeof(float));
  }
  message["fields"] = std::move(fields);
  return with_data(message, bytes);
}

/// A track as a box of its size, with its number and, where it moves, an arrow as long as its way in a second.
Json entity(const Stamped& at, const flies::Track& track) {
  const bool is_person = track.kind == flies::TrackClass::person;
  const double x = track.state.x_m, y = track.state.y_m;
  const double speed = std::hypot(track.velocity.vx_mps, track.velocity.vy_mps);
  const double width = std::max(track.width_m, 0.1), height = std::max(track.height_m, 0.1);
  Json e = at.in(kVehicle);
  e["id"] = std::to_string(track.id);
  e["lifetime"] = {{"sec", 0}, {"nsec", 0}};
  e["frame_locked"] = true;
  e["metadata"] = Json::array({{{"key", "probability"}, {"value", std::to_string(track.probability)}}});
  e["arrows"] = Json::array();
  constexpr double kMoves_mps = 0.3, kMostHead_m = 0.3;
  const double head_m = std::min(kMostHead_m, 0.5 * speed);
  if (speed > kMoves_mps)
    e["arrows"].push_back({{"pose", pose_at(x, y, 0.2, std::atan2(track.velocity.vy_mps, track.velocity.vx_mps))},
                           {"shaft_length", number(speed - head_m)},
                           {"shaft_diameter", 0.1},
                           {"head_length", number(head_m)},
                           {"head_diameter", 0.25},
                           {"color", class_color(is_person)}});
  e["cubes"] = Json::array({{{"pose", pose_at(x, y, height / 2, std::atan2(y, x))},
                             {"size", vector3(0.2, width, height)},
                             {"color", class_color(is_person, 0.6)}}});
  for (const char* none : {"spheres", "cylinders", "lines", "triangles"}) e[none] = Json::array();
  e["texts"] = Json::array({{{"pose", pose_at(x, y, height + 0.3)},
                             {"billboard", true},
                             {"font_size", 14.0},
                             {"scale_invariant", true},
                             {"color", color(1, 1, 1)},
                             {"text", "#" + std::to_string(track.id)}}});
  e["models"] = Json::array();
  return e;
}

Json scene(const Stamped& at) {
  constexpr int kAll = 1;
  Json entities = Json::array();
  for (const auto& track : at.frame.snapshot->tracking.tracks) entities.push_back(entity(at, track));
  return {{"deletions", Json::array({{{"timestamp", stamp(at.time_ns)}, {"type", kAll}, {"id", ""}}})},
          {"entities", entities}};
}

Json transform(const Stamped& at, const char* parent, const char* child, const Json& translation,
               const Json& rotation) {
  return {{"timestamp", stamp(at.time_ns)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", translation},
          {"rotation", rotation}};
}

/// Quaternion product of (w, x, y, z).
using Quaternion = std::array<double, 4>;
Quaternion times(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// The camera's axes (x right, y down, z forward) in the vehicle's: pitch about y down, roll about x.
Json camera_transform(const Stamped& at) {
  const auto& mount = at.frame.camera.mount;
  const Quaternion pitch = {std::cos(mount.pitch_rad / 2), 0, std::sin(mount.pitch_rad / 2), 0};
  const Quaternion roll = {std::cos(mount.roll_rad / 2), std::sin(mount.roll_rad / 2), 0, 0};
  const Quaternion axes = {0.5, -0.5, 0.5, -0.5};
  const Quaternion q = times(times(pitch, roll), axes);
  const Json rotation = {
      {"x", number(q[1], 1e9)}, {"y", number(q[2], 1e9)}, {"z", number(q[3], 1e9)}, {"w", number(q[0], 1e9)}};
  return transform(at, kVehicle, kCamera, vector3(0, 0, mount.height_m), rotation);
}

std::string message_of(Channel channel, const Stamped& at) {
  const GroundPose& pose = at.frame.pose;
  switch (channel) {
    case Channel::left:
      return image(at, left_jpeg(at.frame));
    case Channel::right:
      return image(at, picture_jpeg(at.frame.pair->images.right));
    case Channel::left_calibration:
      return calibration(at, false).dump();
    case Channel::right_calibration:
      return calibration(at, true).dump();
    case Channel::annotations:
      return annotations(at).dump();
    case Channel::scan:
      return laser_scan(at).dump();
    case Channel::flies:
      return point_cloud(at);
    case Channel::scene:
      return scene(at).dump();
    case Channel::pose: {
      Json message = at.in(kWorld);
      message["pose"] = pose_at(pose.x_m, pose.y_m, 0, pose.yaw_rad);
      return message.dump();
    }
    case Channel::vehicle_transform:
      return transform(at, kWorld, kVehicle, vector3(pose.x_m, pose.y_m, 0), turned(pose.yaw_rad)).dump();
    case Channel::camera_transform:
      return camera_transform(at).dump();
    case Channel::record:
    case Channel::log:
      break;
  }
  return {};
}

}  // namespace

std::uint64_t time_ns_of(const LiveFrame& frame) {
  return frame.began_ns + static_cast<std::uint64_t>(std::llround(frame.pair->time_s * 1e9));
}

std::string channel_message(Channel channel, const LiveFrame& frame) {
  if (channel == Channel::record) return json_line(frame);
  return message_of(channel, {frame, time_ns_of(frame)});
}

std::string log_message(const std::string& sentence, std::uint64_t time_ns) {
  constexpr int kWarning = 3;
  constexpr int kOneLine = -1;
  const Json message = {{"timestamp", stamp(time_ns)},
                        {"level", kWarning},
                        {"message", sentence},
                        {"name", "flies"},
                        {"file", ""},
                        {"line", 0}};
  return message.dump(kOneLine, ' ', false, Json::error_handler_t::replace);
}
