#include "track/track_outputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "flies/core/options.hpp"
#include "flies/io/json_values.hpp"
#include "flies/io/kitti_place.hpp"
#include "flies/io/writers.hpp"

namespace {

using Json = nlohmann::ordered_json;

/// Metres, metres a second, seconds, milliseconds, probabilities.
Json rounded(double value, int decimals = 3) { return flies::rounded(value, decimals); }

Json ego_of(const flies::EgoMotion& ego) {
  return {{"is_known", ego.is_known},
          {"vx_mps", rounded(ego.vx_mps)},
          {"vy_mps", rounded(ego.vy_mps)},
          {"yaw_rate_rps", rounded(ego.yaw_rate_rps, 5)},
          {"vx_sd_mps", rounded(std::sqrt(ego.covariance[0][0]))},
          {"vy_sd_mps", rounded(std::sqrt(ego.covariance[1][1]))},
          {"yaw_rate_sd_rps", rounded(std::sqrt(ego.covariance[2][2]), 5)},
          {"followed", ego.followed},
          {"agreeing", ego.agreeing},
          {"disparity_shift_px", ego.disparity_shift ? rounded(ego.disparity_shift->px, 2) : Json(nullptr)}};
}

double range_m(const flies::Track& track) { return std::hypot(track.state.x_m, track.state.y_m); }

Json track_of(const flies::Track& t, const flies::EgoMotion& ego) {
  // A thing that stands still moves against the camera, which also turns under it.
  const double relative_vx = t.velocity.vx_mps - ego.vx_mps + ego.yaw_rate_rps * t.state.y_m;
  const double relative_vy = t.velocity.vy_mps - ego.vy_mps - ego.yaw_rate_rps * t.state.x_m;
  const bool moves = t.velocity.moving_probability > 0.5;
  const auto& p = t.state.covariance;
  return {{"id", t.id},
          {"class", std::string(flies::enum_name(t.kind))},
          {"probability", rounded(t.probability)},
          {"person_log_odds", rounded(t.person_log_odds)},
          {"x_m", rounded(t.state.x_m)},
          {"y_m", rounded(t.state.y_m)},
          {"range_m", rounded(range_m(t))},
          {"vx_mps", rounded(t.velocity.vx_mps)},
          {"vy_mps", rounded(t.velocity.vy_mps)},
          {"relative_vx_mps", rounded(relative_vx)},
          {"relative_vy_mps", rounded(relative_vy)},
          {"moving_probability", rounded(t.velocity.moving_probability)},
          {"heading_rad", moves ? rounded(std::atan2(t.velocity.vy_mps, t.velocity.vx_mps)) : Json(nullptr)},
          {"x_sd_m", rounded(std::sqrt(p[0][0]))},
          {"y_sd_m", rounded(std::sqrt(p[1][1]))},
          {"vx_sd_mps", rounded(std::sqrt(p[2][2]))},
          {"vy_sd_mps", rounded(std::sqrt(p[3][3]))},
          {"width_m", rounded(t.width_m)},
          {"height_m", rounded(t.height_m)},
          {"age_s", rounded(t.age_s)},
          {"unseen_s", rounded(t.unseen_s)},
          {"box", flies::box_json(t.box)}};
}

}  // namespace

std::string track_json_line(const TrackedFrame& frame, const std::string& error) {
  const auto& tracking = frame.tracking;
  const flies::FrameRecord record{.frame = frame.frame,
                                  .left = frame.left,
                                  .right = frame.right,
                                  .seed = frame.seed,
                                  .preset = frame.preset,
                                  .obstacles = tracking.detection.obstacles,
                                  .pedestrians = tracking.detection.pedestrians,
                                  .scan = tracking.detection.scan,
                                  .stage_ms = tracking.detection.stage_ms,
                                  .diagnosis = frame.diagnosis,
                                  .run = frame.run,
                                  .road = error.empty() ? std::optional(tracking.detection.road.plane) : std::nullopt,
                                  .road_found = tracking.detection.road.found,
                                  .error = error};
  Json object = Json::parse(flies::json_line(record));
  object["time_s"] = rounded(tracking.time_s, 6);
  object["ego"] = ego_of(tracking.ego);
  Json tracks = Json::array();
  for (const auto& track : tracking.tracks) tracks.push_back(track_of(track, tracking.ego));
  object["tracks"] = tracks;
  if (error.empty()) {
    object["stage_ms"]["ego"] = rounded(tracking.ego_ms);
    object["stage_ms"]["track"] = rounded(tracking.track_ms);
  }
  if (frame.live)
    object["live"] = {{"latency_ms", rounded(frame.live->latency_ms)},
                      {"skew_ms", rounded(frame.live->skew_ms)},
                      {"dropped", frame.live->dropped},
                      {"skipped", frame.live->skipped}};
  constexpr int kOneLine = -1;
  return object.dump(kOneLine, ' ', false, Json::error_handler_t::replace) + "\n";
}

// The axes of the camera: x right, y down, z forward. Lengths and headings of what stands are not known: -1 and -10, as
// KITTI has it. Feet stand on the road that was found. What is no longer before the camera has no line.
std::string kitti_tracking_lines(const TrackedFrame& frame) {
  std::string lines;
  for (const auto& t : frame.tracking.tracks) {
    const double z_m = frame.tracking.detection.road.plane.z_m(t.state.x_m, t.state.y_m);
    const auto foot = flies::kitti_place(frame.camera, {t.state.x_m, t.state.y_m, z_m});
    if (!foot) continue;
    const double heading_rad = t.velocity.moving_probability > 0.5
                                   ? flies::kitti_heading_rad(std::atan2(t.velocity.vy_mps, t.velocity.vx_mps))
                                   : -10.0;
    lines += fmt::format(
        "{} {} {} -1 -1 -10 {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} -1 {:.2f} {:.2f} {:.2f} {:.2f} {:.4f}\n",
        frame.frame, t.id, t.kind == flies::TrackClass::person ? "Pedestrian" : "Misc", t.box.u_px, t.box.v_px,
        t.box.u_px + t.box.width_px, t.box.v_px + t.box.height_px, t.height_m, t.width_m, foot->right_m, foot->down_m,
        foot->forward_m, heading_rad, t.probability);
  }
  return lines;
}

std::string track_table(const TrackedFrame& frame) {
  const auto& [time_s, ego] = std::pair(frame.tracking.time_s, frame.tracking.ego);
  std::string text = fmt::format("{:8.2f} s  ", time_s);
  text += ego.is_known
              ? fmt::format("camera {:.2f} m/s, {:+.3f} rad/s\n", std::hypot(ego.vx_mps, ego.vy_mps), ego.yaw_rate_rps)
              : std::string("camera's motion not known\n");
  for (const auto& t : frame.tracking.tracks)
    text += fmt::format("  {:>5} {:<6} x {:6.2f} m  y {:+6.2f} m  v {:5.2f} m/s  {:.2f}{}\n", t.id,
                        flies::enum_name(t.kind), t.state.x_m, t.state.y_m,
                        std::hypot(t.velocity.vx_mps, t.velocity.vy_mps), t.probability,
                        t.unseen_s > 0.0 ? "  not seen" : "");
  return text;
}
