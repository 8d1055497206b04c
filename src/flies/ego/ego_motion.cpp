#include "flies/ego/ego_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/ego/follow_corners.hpp"
#include "flies/ego/solve_pose.hpp"

namespace flies {
namespace {

constexpr double kMinDisparity_px = 1.0;  // over that of infinity: farther corners have no depth

constexpr double kMinNowDepth_m = 0.5;  // of a corner that a wrong depth puts behind the camera

RigidMotion as_rigid(const cv::Matx33d& rotation, const cv::Vec3d& shift_m) {
  RigidMotion motion;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      motion.rotation[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = rotation(i, j);
  motion.shift = {shift_m[0], shift_m[1], shift_m[2]};
  return motion;
}

cv::Vec3d as_vec(const Point3& p) { return {p.x_m, p.y_m, p.z_m}; }

/// The left camera's frame (x right, y down, z forward) in the vehicle frame.
struct CameraPlace {
  cv::Matx33d vehicle_from_camera;
  cv::Vec3d at_m;

  CameraPlace(const StereoCamera& camera, const Projection& projection) {
    const auto place = [&](double x, double y) {
      return as_vec(projection.triangulate(
          {camera.cx_px + camera.fx_px * x, camera.cy_px + camera.fy_px * y, projection.disparity_at_depth(1.0)}));
    };
    at_m = {0.0, 0.0, camera.mount.height_m};
    const cv::Vec3d ahead = place(0, 0), right = place(1, 0) - ahead, down = place(0, 1) - ahead;
    const cv::Vec3d forward = ahead - at_m;
    for (int i = 0; i < 3; ++i) {
      vehicle_from_camera(i, 0) = right[i];
      vehicle_from_camera(i, 1) = down[i];
      vehicle_from_camera(i, 2) = forward[i];
    }
  }
};

/// Velocities over ground from the motion of standing points.
void set_velocities(EgoMotion& ego) {
  const RigidMotion previous_from_current = ego.current_from_previous.inverse();
  // The way of the origin, halfway between the axes at its two ends; turned on to those of now.
  const double yaw = std::atan2(previous_from_current.rotation[1][0], previous_from_current.rotation[0][0]);
  const Point3& way = previous_from_current.shift;
  ego.vx_mps = (std::cos(yaw / 2) * way.x_m + std::sin(yaw / 2) * way.y_m) / ego.dt_s;
  ego.vy_mps = (-std::sin(yaw / 2) * way.x_m + std::cos(yaw / 2) * way.y_m) / ego.dt_s;
  ego.yaw_rate_rps = yaw / ego.dt_s;
}

void check_within(double value, double least, double most, const std::string& source, const std::string& field) {
  if (!(value >= least && value <= most))
    throw InputError(source, field, fmt::format("found {:g}, expected {:g} to {:g}", value, least, most));
}

/// Nobody uses what was moved from but by mistake.
template <class Memory>
void check_has_memory(const Memory& memory) {
  if (!memory) throw std::logic_error("this tracker or estimator of motion was moved from and cannot be used");
}

}  // namespace

void detail::check_ego_motion(const EgoMotion& ego, const std::string& source) {
  check_within(ego.dt_s, kLeastStep_s, kLongestStep_s, source, "dt_s");
  check_within(ego.vx_mps, -kMostSpeed_mps, kMostSpeed_mps, source, "vx_mps");
  check_within(ego.vy_mps, -kMostSpeed_mps, kMostSpeed_mps, source, "vy_mps");
  check_within(ego.yaw_rate_rps, -kMostYawRate_rps, kMostYawRate_rps, source, "yaw_rate_rps");
  const auto& [rotation, shift] = ego.current_from_previous;
  std::array<double, 9> rows{};
  for (std::size_t i = 0; i < 9; ++i) rows[i] = rotation[i / 3][i % 3];
  for (const double entry : rows) check_within(entry, -1.1, 1.1, source, "current_from_previous.rotation");
  check_rotation(rows, source, "current_from_previous.rotation");
  const double way_m = std::hypot(shift.x_m, shift.y_m, shift.z_m), most_m = 2.0 * kMostSpeed_mps * ego.dt_s;
  if (!(way_m <= most_m))
    throw InputError(source, "current_from_previous.shift",
                     fmt::format("found {:g} m in {:g} s, expected up to {:g} m", way_m, ego.dt_s, most_m));
  for (std::size_t i = 0; i < 3; ++i) {
    const double most = std::pow(i == 2 ? kMostYawRate_rps : kMostSpeed_mps, 2);
    check_within(ego.covariance[i][i], 0.0, most, source, fmt::format("covariance[{0}][{0}]", i));
    for (std::size_t j = 0; j < 3; ++j)
      if (!std::isfinite(ego.covariance[i][j]))
        throw InputError(source, fmt::format("covariance[{}][{}]", i, j), "is no finite number");
  }
}

Point3 RigidMotion::operator()(const Point3& p) const {
  const auto row = [&](std::size_t i) {
    return rotation[i][0] * p.x_m + rotation[i][1] * p.y_m + rotation[i][2] * p.z_m;
  };
  return {row(0) + shift.x_m, row(1) + shift.y_m, row(2) + shift.z_m};
}

RigidMotion RigidMotion::inverse() const {
  RigidMotion inverse;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) inverse.rotation[i][j] = rotation[j][i];
  const Point3 back = inverse(shift);  // its own shift is still zero
  inverse.shift = {-back.x_m, -back.y_m, -back.z_m};
  return inverse;
}

EgoMotion given_ego_motion(double dt_s, double vx_mps, double vy_mps, double yaw_rate_rps,
                           const std::array<double, 3>& standard_deviations) {
  EgoMotion ego;
  ego.is_known = !(dt_s <= 0.0);
  if (!ego.is_known) return ego;
  ego.dt_s = dt_s;
  const double yaw = yaw_rate_rps * dt_s, half = yaw / 2;
  RigidMotion previous_from_current;
  previous_from_current.rotation = {{{std::cos(yaw), -std::sin(yaw), 0}, {std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}}};
  previous_from_current.shift = {(std::cos(half) * vx_mps - std::sin(half) * vy_mps) * dt_s,
                                 (std::sin(half) * vx_mps + std::cos(half) * vy_mps) * dt_s, 0.0};
  ego.current_from_previous = previous_from_current.inverse();
  ego.vx_mps = vx_mps;
  ego.vy_mps = vy_mps;
  ego.yaw_rate_rps = yaw_rate_rps;
  for (std::size_t i = 0; i < 3; ++i) {
    check_within(standard_deviations[i], 0.0, i == 2 ? kMostYawRate_rps : kMostSpeed_mps, "given motion",
                 fmt::format("standard_deviations[{}]", i));
    ego.covariance[i][i] = standard_deviations[i] * standard_deviations[i];
  }
  detail::check_ego_motion(ego, "given motion");
  return ego;
}

struct EgoEstimator::Memory {
  StereoCamera camera;
  Projection projection;
  EgoOptions options;
  CameraPlace place;
  ego::PreparedPair before;
  ego::CameraMotion motion;  ///< the last one, a guess for the next
  double motion_dt_s = 0.0;  ///< the time that it took; 0: none is known
  double time_s = 0.0;
  std::uint32_t frame = 0;

  Memory(const StereoCamera& c, const EgoOptions& o) : camera(c), projection(c), options(o), place(c, projection) {}

  EgoMotion estimate(const ego::PreparedPair& now, double dt_s);
  std::vector<CornerMotion> moved(const ego::PreparedPair& now, std::span<const ego::FollowedCorner> corners,
                                  const EgoMotion& ego) const;
  EgoMotion in_vehicle(const ego::PoseResult& pose, double dt_s) const;
  std::optional<DisparityShift> shift_of(std::span<const ego::FollowedCorner> corners, const ego::Pinhole& pinhole,
                                         const ego::CameraMotion& found) const;
};

std::optional<DisparityShift> EgoEstimator::Memory::shift_of(std::span<const ego::FollowedCorner> corners,
                                                             const ego::Pinhole& pinhole,
                                                             const ego::CameraMotion& found) const {
  constexpr double kMaxDeviation_px = 0.5;
  const auto shift = ego::solve_disparity_shift(corners, pinhole, camera.fx_px * camera.baseline_m, found, options);
  if (!shift || !(shift->deviation_px <= kMaxDeviation_px) || shift->agreeing < options.min_agreeing ||
      shift->agreeing < options.min_agreeing_share * static_cast<double>(corners.size()))
    return std::nullopt;
  return DisparityShift{shift->shift_px, shift->deviation_px};
}

EgoMotion EgoEstimator::Memory::estimate(const ego::PreparedPair& now, double dt_s) {
  EgoMotion lost;
  lost.dt_s = dt_s;
  if (before.empty() || now.empty() || dt_s > kLongestStep_s) return lost;
  const ego::Pinhole pinhole{camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px};
  // Corners too far to have a depth say nothing of the shift and would be taken for near ones' outliers.
  std::erase_if(before.corners, [&](const ego::StereoCorner& corner) {
    return corner.disparity_px < projection.disparity_offset_px() + kMinDisparity_px;
  });
  const auto likely = motion_dt_s > 0.0 ? ego::scaled(motion, dt_s / motion_dt_s) : motion;
  std::vector<ego::FollowedCorner> corners;
  std::vector<cv::Point2f> guess_px;
  for (const auto& corner : before.corners) {
    const double z = projection.depth_at_disparity(corner.disparity_px);
    const cv::Vec3d point((corner.left_px.x - camera.cx_px) / camera.fx_px * z,
                          (corner.left_px.y - camera.cy_px) / camera.fy_px * z, z);
    const cv::Vec3d guess = likely.rotation * point + likely.shift_m;
    corners.push_back({point, {}});
    guess_px.push_back(guess[2] > 0.5
                           ? cv::Point2f(static_cast<float>(camera.cx_px + camera.fx_px * guess[0] / guess[2]),
                                         static_cast<float>(camera.cy_px + camera.fy_px * guess[1] / guess[2]))
                           : corner.left_px);
  }
  const auto found_px = ego::follow_corners(before, now, guess_px);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found_px.size(); ++i) {
    if (std::isnan(found_px[i].x)) continue;
    corners[kept++] = {corners[i].before_m, {found_px[i].x, found_px[i].y}};
  }
  corners.resize(kept);
  lost.followed = static_cast<int>(kept);
  const auto pose = ego::solve_pose(corners, pinhole, likely, options, frame);
  if (!pose) return lost;
  lost.disparity_shift = shift_of(corners, pinhole, pose->motion);
  lost.agreeing = pose->agreeing;
  if (pose->agreeing < options.min_agreeing ||
      pose->agreeing < options.min_agreeing_share * static_cast<double>(corners.size()))
    return lost;
  EgoMotion known = in_vehicle(*pose, dt_s);
  known.followed = lost.followed;
  known.disparity_shift = lost.disparity_shift;
  known.corners = moved(now, corners, known);
  motion = pose->motion;
  motion_dt_s = dt_s;
  return known;
}

/// Where each corner is now by its disparity now, against where it would be had it stood still.
std::vector<CornerMotion> EgoEstimator::Memory::moved(const ego::PreparedPair& now,
                                                      std::span<const ego::FollowedCorner> corners,
                                                      const EgoMotion& ego) const {
  std::vector<cv::Point2f> now_px;
  std::vector<float> guess_px;
  std::vector<Point3> stood;
  for (const auto& corner : corners) {
    const cv::Vec3d then = place.vehicle_from_camera * corner.before_m + place.at_m;
    stood.push_back(ego.current_from_previous({then[0], then[1], then[2]}));
    now_px.emplace_back(static_cast<float>(corner.now_px[0]), static_cast<float>(corner.now_px[1]));
    const double depth_m = std::max(projection.depth_m(stood.back()), kMinNowDepth_m);
    guess_px.push_back(static_cast<float>(projection.disparity_at_depth(depth_m)));
  }
  const auto disparities_px = ego::disparities_near(now, now_px, guess_px);
  std::vector<CornerMotion> motions;
  for (std::size_t i = 0; i < now_px.size(); ++i) {
    if (!(disparities_px[i] > projection.disparity_offset_px() + kMinDisparity_px)) continue;
    const Point3 at = projection.triangulate({now_px[i].x, now_px[i].y, disparities_px[i]});
    motions.push_back({now_px[i].x, now_px[i].y, at.x_m, at.y_m, at.z_m, (at.x_m - stood[i].x_m) / ego.dt_s,
                       (at.y_m - stood[i].y_m) / ego.dt_s});
  }
  return motions;
}

EgoMotion EgoEstimator::Memory::in_vehicle(const ego::PoseResult& pose, double dt_s) const {
  EgoMotion ego;
  ego.is_known = true;
  ego.dt_s = dt_s;
  ego.agreeing = pose.agreeing;
  const cv::Matx33d& v = place.vehicle_from_camera;
  const cv::Matx33d rotation = v * pose.motion.rotation * v.t();
  ego.current_from_previous = as_rigid(rotation, v * pose.motion.shift_m + place.at_m - rotation * place.at_m);
  set_velocities(ego);
  // The origin moves by minus the shift; a turn of the camera is one about the axes of the vehicle. The arm from the
  // camera down to the origin adds pitch and roll rates, which say nothing of the way over ground, so it is left out.
  const cv::Matx33d& c = pose.covariance.get_minor<3, 3>(3, 3);
  const cv::Matx33d turn = v * pose.covariance.get_minor<3, 3>(0, 0) * v.t();
  const cv::Matx33d shift = v * c * v.t();
  const cv::Matx33d cross = v * pose.covariance.get_minor<3, 3>(0, 3) * v.t();
  const double per_s2 = 1.0 / (dt_s * dt_s);
  ego.covariance = {{{shift(0, 0) * per_s2, shift(0, 1) * per_s2, cross(2, 0) * per_s2},
                     {shift(1, 0) * per_s2, shift(1, 1) * per_s2, cross(2, 1) * per_s2},
                     {cross(2, 0) * per_s2, cross(2, 1) * per_s2, turn(2, 2) * per_s2}}};
  return ego;
}

EgoEstimator::EgoEstimator(const StereoCamera& camera, const EgoOptions& options) {
  check_camera(camera, "camera");
  check_options(options, "options");
  memory_ = std::make_unique<Memory>(camera, options);
}
EgoEstimator::~EgoEstimator() = default;
EgoEstimator::EgoEstimator(EgoEstimator&&) noexcept = default;
EgoEstimator& EgoEstimator::operator=(EgoEstimator&&) noexcept = default;

void EgoEstimator::check(const RectifiedPair& given, double time_s) const {
  check_has_memory(memory_);
  const RectifiedPair pair = detail::usable_pair(given);
  check_camera_fits(memory_->camera, pair.left.width_px, pair.left.height_px, "camera");
  check_time(time_s);
}

void EgoEstimator::check_time(double time_s) const {
  check_has_memory(memory_);
  if (!std::isfinite(time_s) || (memory_->frame > 0 && !(time_s - memory_->time_s >= kLeastStep_s)))
    throw InputError("pair", "time_s",
                     fmt::format("found {} after {}, expected times that advance", time_s, memory_->time_s));
}

std::optional<double> EgoEstimator::last_time_s() const {
  check_has_memory(memory_);
  return memory_->frame > 0 ? std::optional(memory_->time_s) : std::nullopt;
}

void EgoEstimator::skip(const RectifiedPair& pair, double time_s) {
  check(pair, time_s);
  skip(time_s);
}

void EgoEstimator::skip(double time_s) {
  check_time(time_s);
  memory_->before = {};
  memory_->motion = {};
  memory_->motion_dt_s = 0.0;
  memory_->time_s = time_s;
  ++memory_->frame;
}

EgoMotion EgoEstimator::follow(const RectifiedPair& given, double time_s) {
  check(given, time_s);
  const RectifiedPair pair = detail::usable_pair(given);
  const bool is_first = memory_->frame == 0;
  const double dt_s = is_first ? 0.0 : time_s - memory_->time_s;
  auto now = ego::prepare(pair, memory_->projection.disparity_offset_px(), memory_->options);
  EgoMotion ego = is_first ? EgoMotion{} : memory_->estimate(now, dt_s);
  if (!ego.is_known) {
    memory_->motion = {};
    memory_->motion_dt_s = 0.0;
  }
  memory_->before = std::move(now);
  memory_->time_s = time_s;
  ++memory_->frame;
  return ego;
}

}  // namespace flies
