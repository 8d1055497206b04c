#include "flies/io/formats/pose_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/calib3d.hpp>

#include "flies/core/error.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies::detail {
namespace {

constexpr double kZero = 1e-9;
constexpr double kRounding = 1e-3;  // of rotations in files that keep four digits

bool is_near(double a, double b) { return std::abs(a - b) <= kRounding; }

std::array<double, 9> rotation_of_quaternion(const std::vector<double>& q, const std::string& source,
                                             const std::string& key) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  constexpr double kLeastLarge = 0.71;  // less than a right angle
  const bool w_first = std::abs(q[0]) > kLeastLarge, w_last = std::abs(q[3]) > kLeastLarge;
  if (std::abs(length - 1.0) > 1e-2 || w_first == w_last)
    throw InputError(source, key,
                     "found 4 numbers, expected 9 of a rotation matrix, 3 of a rotation vector or 4 of a quaternion of "
                     "length 1 whose largest number is the first or the last");
  const std::size_t w = w_first ? 0 : 3, x = w_first ? 1 : 0;
  const double sine = std::hypot(q[x], q[x + 1], q[x + 2]);
  if (sine == 0.0) return Pose{}.rotation;
  const double angle = 2.0 * std::atan2(sine, std::abs(q[w])) * (q[w] < 0.0 ? -1.0 : 1.0) / sine;
  return rotation_about({angle * q[x], angle * q[x + 1], angle * q[x + 2]});
}

double angle_deg(const std::array<double, 9>& r) {
  return degrees(std::acos(std::clamp((r[0] + r[4] + r[8] - 1.0) / 2.0, -1.0, 1.0)));
}

/// Whether the numbers at these places, three and three, are rows of length 1 that stand upright on each other.
bool is_rotation(const std::vector<double>& m, std::size_t stride) {
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = a; b < 3; ++b) {
      double dot = 0.0;
      for (std::size_t i = 0; i < 3; ++i) dot += m[a * stride + i] * m[b * stride + i];
      if (!is_near(dot, a == b ? 1.0 : 0.0)) return false;
    }
  return true;
}

/// Rotation and translation of a list that goes column by column.
Pose pose_of_columns(const std::vector<double>& m, std::size_t stride) {
  Pose pose;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) pose.rotation[3 * row + column] = m[stride * column + row];
    pose.translation[row] = m[3 * stride + row];
  }
  return pose;
}

bool stands_by_columns(const std::vector<double>& m) {
  if (m.size() == 12) return !is_rotation(m, 4) && is_rotation(m, 3);
  const auto is_last = [&](std::size_t first, std::size_t step) {
    return std::abs(m[first]) <= kZero && std::abs(m[first + step]) <= kZero && std::abs(m[first + 2 * step]) <= kZero;
  };
  return std::abs(m[15] - 1.0) <= kZero && !is_last(12, 1) && is_last(3, 4);
}

}  // namespace

std::array<double, 9> rotation_about(const std::array<double, 3>& axis_angle) {
  cv::Matx33d matrix;
  cv::Rodrigues(cv::Vec3d(axis_angle.data()), matrix);
  std::array<double, 9> rotation{};
  std::copy_n(matrix.val, rotation.size(), rotation.begin());
  return rotation;
}

std::array<double, 9> rotation_of(const NumberTable& table, const std::string& key, CalibrationNotes& notes) {
  const auto& numbers = table.require(key);
  std::array<double, 9> rotation{};
  if (numbers.size() == rotation.size()) {
    std::copy_n(numbers.begin(), rotation.size(), rotation.begin());
    return rotation;
  }
  if (numbers.size() != 3 && numbers.size() != 4)
    throw InputError(
        table.source, key,
        fmt::format("found {} numbers, expected 9 of a rotation matrix or 3 of a rotation vector{}", numbers.size(),
                    hint_of_decimal_commas(numbers, numbers.size() > rotation.size() ? rotation.size() : 3)));
  const bool is_vector = numbers.size() == 3;
  rotation = is_vector ? rotation_about({numbers[0], numbers[1], numbers[2]})
                       : rotation_of_quaternion(numbers, table.source, key);
  notes.push_back(
      {fmt::format("{} is read as a {}, {:.3g} degrees", key,
                   is_vector ? "rotation vector (OpenCV's Rodrigues, radians)" : "quaternion", angle_deg(rotation)),
       CalibrationNoteKind::told});
  return rotation;
}

Pose pose_of(const NumberTable& table, const std::string& key, CalibrationNotes& notes) {
  const auto& m = table.require(key);
  if (m.size() != 12 && m.size() != 16)
    throw InputError(table.source, key,
                     fmt::format("found {} numbers, expected 16 of a 4 x 4 or 12 of a 3 x 4 pose{}", m.size(),
                                 hint_of_decimal_commas(m, m.size() > 16 ? 16 : 12)));
  if (stands_by_columns(m)) {
    CalibrationNote note{
        fmt::format("{} is transposed (its translation stands in the last row, as MATLAB writes it) and is read so",
                    key),
        CalibrationNoteKind::told};
    // Both cameras' files may have the key, and chains share poses.
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(std::move(note));
    return pose_of_columns(m, m.size() == 12 ? 3 : 4);
  }
  if (m.size() == 16 && (std::abs(m[12]) > kRounding || std::abs(m[13]) > kRounding || std::abs(m[14]) > kRounding ||
                         std::abs(m[15] - 1.0) > kRounding))
    throw InputError(
        table.source, key,
        "is no pose: expected a rotation, the translation in the last column, and 0 0 0 1 in the last row");
  return pose_of_rows(m);
}

std::string check_turn(const std::array<double, 9>& right_from_left, const std::string& source,
                       const std::string& key) {
  constexpr double kProbable_deg = 30.0;
  const double found_deg = angle_deg(right_from_left);
  if (found_deg <= kProbable_deg) return "";
  const auto found = fmt::format(
      "turns the right camera by {:.3g} degrees against the left one: is it in degrees where radians are expected, or "
      "the pose between other frames?",
      found_deg);
  if (right_from_left[8] <= 0.0) throw InputError(source, key, found);  // one looks away from what the other sees
  return key + " " + found;
}

}  // namespace flies::detail
