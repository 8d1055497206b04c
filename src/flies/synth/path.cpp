#include "flies/synth/path.hpp"

#include <algorithm>
#include <cmath>

namespace flies::synth {
namespace {

struct Side {
  float shift_m, rate_mps;
};

/// The fifth-degree step that begins and ends without speed and acceleration.
Side side_at(const SideStep& step, float time_s) {
  const float duration_s = step.end_s - step.begin_s;
  const float s = std::clamp((time_s - step.begin_s) / duration_s, 0.0F, 1.0F);
  return {step.shift_m * s * s * s * (10.0F + s * (6.0F * s - 15.0F)),
          step.shift_m * 30.0F * s * s * (1.0F - s) * (1.0F - s) / duration_s};
}

Vec3 turned(float along, float left, float yaw_rad) {
  const float c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {c * along - s * left, s * along + c * left, 0.0F};
}

}  // namespace

float Path::speed_mps(float time_s) const {
  const auto next = std::find_if(speeds.begin(), speeds.end(), [&](const SpeedAt& s) { return s.time_s > time_s; });
  if (next == speeds.begin()) return speeds.front().speed_mps;
  if (next == speeds.end()) return speeds.back().speed_mps;
  const auto& before = *std::prev(next);
  return mix(before.speed_mps, next->speed_mps, (time_s - before.time_s) / (next->time_s - before.time_s));
}

float Path::travelled_m(float time_s) const {
  // Speed is linear between these times, so the mean of its ends is exact.
  std::vector<float> times = {0.0F, time_s};
  for (const auto& speed : speeds)
    if (speed.time_s > 0.0F && speed.time_s < time_s) times.push_back(speed.time_s);
  std::sort(times.begin(), times.end());
  float distance_m = 0.0F;
  for (std::size_t i = 1; i < times.size(); ++i)
    distance_m += 0.5F * (speed_mps(times[i - 1]) + speed_mps(times[i])) * (times[i] - times[i - 1]);
  return distance_m;
}

Placement Path::at(float time_s) const {
  const auto [shift_m, rate_mps] = side_at(side_step, time_s);
  const float turn_rad = rate_mps == 0.0F ? 0.0F : std::atan2(rate_mps, speed_mps(time_s));
  return {start.position + turned(travelled_m(time_s), shift_m, start.yaw_rad), start.yaw_rad + turn_rad};
}

Vec3 Path::velocity_at(float time_s) const {
  return turned(speed_mps(time_s), side_at(side_step, time_s).rate_mps, start.yaw_rad);
}

Placement inverse(const Placement& placement) {
  const Vec3& p = placement.position;
  const Vec3 turned_back = turned(-p.x, -p.y, -placement.yaw_rad);
  return {{turned_back.x, turned_back.y, -p.z}, -placement.yaw_rad};
}

}  // namespace flies::synth
