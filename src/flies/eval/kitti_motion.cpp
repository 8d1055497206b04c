#include "flies/eval/kitti_motion.hpp"

#include <fmt/format.h>

#include <array>
#include <sstream>
#include <string>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/number_table.hpp"
#include "flies/io/time_stamps.hpp"

namespace flies {
namespace {

// Columns of an oxts file, from 0 (its dataformat.txt).
constexpr std::size_t kForward = 8, kLeft = 9, kYawRate = 22, kColumns = 30;

/// Where the left grey camera sits from the GPS/IMU, in the latter's axes (x forward, y left).
struct Arm {
  double x_m = 0.0, y_m = 0.0;
};

/// Both transforms turn by less than a degree and a half but for the change of axes, which moves the arm by 3 cm.
Arm read_arm(const std::filesystem::path& day) {
  const auto lidar_from_imu = read_number_table((day / "calib_imu_to_velo.txt").string()).require("T", 3);
  const NumberTable camera = read_number_table((day / "calib_velo_to_cam.txt").string());
  const auto &r = camera.require("R", 9), &t = camera.require("T", 3);
  const auto camera_in_lidar = [&](std::size_t axis) {
    return -(r[axis] * t[0] + r[3 + axis] * t[1] + r[6 + axis] * t[2]);
  };
  return {camera_in_lidar(0) - lidar_from_imu[0], camera_in_lidar(1) - lidar_from_imu[1]};
}

}  // namespace

std::vector<KittiMotion> read_kitti_motion(const std::filesystem::path& drive) {
  const Arm arm = read_arm(drive.parent_path());
  const auto times_s = read_time_stamps((drive / "oxts" / "timestamps.txt").string());
  std::vector<KittiMotion> motions;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const auto path = drive / "oxts" / "data" / fmt::format("{:010}.txt", i);
    if (i > 0 && !detail::is_there(path)) break;  // the beginning of a drive: its times are all there
    std::vector<double> values;
    for (const auto& line : detail::lines_of(detail::read_truth(path))) {
      std::istringstream words(line.content);
      for (std::string word; words >> word;)
        values.push_back(detail::parse_number(word, path.string(), fmt::format("number {}", values.size() + 1)));
    }
    if (values.size() != kColumns)
      throw InputError(path.string(), "", fmt::format("found {} numbers, expected {}", values.size(), kColumns));
    const double yaw_rate = values[kYawRate];
    motions.push_back(
        {times_s[i], values[kForward] - yaw_rate * arm.y_m, values[kLeft] + yaw_rate * arm.x_m, yaw_rate});
  }
  return motions;
}

}  // namespace flies
