#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace flies::detail {

/// A rigid motion: point_in_to = rotation * point_in_from + translation. Rotation 3 x 3, row by row.
struct Pose {
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> translation{};
};

constexpr std::array<double, 9> transposed(const std::array<double, 9>& m) {
  return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
}

constexpr std::array<double, 3> turned(const std::array<double, 9>& m, const std::array<double, 3>& p) {
  return {m[0] * p[0] + m[1] * p[1] + m[2] * p[2], m[3] * p[0] + m[4] * p[1] + m[5] * p[2],
          m[6] * p[0] + m[7] * p[1] + m[8] * p[2]};
}

constexpr std::array<double, 9> product(const std::array<double, 9>& a, const std::array<double, 9>& b) {
  std::array<double, 9> ab{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) ab[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return ab;
}

/// First `second_from_first`, then `third_from_second`.
constexpr Pose chained(const Pose& third_from_second, const Pose& second_from_first) {
  Pose pose;
  pose.rotation = product(third_from_second.rotation, second_from_first.rotation);
  pose.translation = turned(third_from_second.rotation, second_from_first.translation);
  for (std::size_t i = 0; i < 3; ++i) pose.translation[i] += third_from_second.translation[i];
  return pose;
}

constexpr Pose inverse(const Pose& pose) {
  Pose back;
  back.rotation = transposed(pose.rotation);
  back.translation = turned(back.rotation, pose.translation);
  for (double& t : back.translation) t = -t;
  return back;
}

/// Of a 3 x 4 or 4 x 4 matrix, row by row.
inline Pose pose_of_rows(const std::vector<double>& m) {
  return {{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
}

constexpr Pose scaled(Pose pose, double metres_per_unit) {
  for (double& t : pose.translation) t *= metres_per_unit;
  return pose;
}

}  // namespace flies::detail
