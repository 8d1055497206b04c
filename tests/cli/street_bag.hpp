#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/record/ros_bytes.hpp"
#include "street_pair.hpp"

namespace flies::testing {

using Numbers = std::vector<double>;

inline constexpr int kPairs = 3;
inline constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000U;

/// What a bag holds.
struct Topics {
  std::string left = "/rig/left/image_raw", right = "/rig/right/image_raw";
  bool has_camera_info = true, has_camera_size = true;
  std::string encoding = "mono8";
  double level_factor = 1.0;  ///< of the grey levels of mono16
  std::uint64_t right_delay_ns = 1'000'000U;
  bool has_left_twice = false;                           ///< the left camera gives another picture 3 ms after each
  std::optional<std::uint64_t> stamp_ns = std::nullopt;  ///< of all pictures; nothing: their own times
  double baseline_factor = 1.0;                          ///< of the baseline that the camera_info has
  Numbers distortion = {};
  std::string before = {};  ///< records before those of the pairs
  std::string after = {};   ///< and after the chunk that holds them
};

inline std::string pixels_of(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

/// A camera that stands before a street; the right pictures come a little after the left ones.
inline void write_bag(const std::filesystem::path& path, const Topics& topics = {}) {
  const StereoCamera camera = street_camera();
  auto [left, right] = street_pair();
  if (topics.encoding == "mono16")
    for (cv::Mat* picture : {&left, &right}) picture->convertTo(*picture, CV_16U, topics.level_factor);
  std::string records;
  const std::vector<std::string> names = {topics.left, topics.right, "/rig/left/camera_info", "/rig/right/camera_info"};
  for (std::uint32_t i = 0; i < 4; ++i)
    records += BagBytes::connection(i, names[i], i < 2 ? "sensor_msgs/Image" : "sensor_msgs/CameraInfo");
  records += topics.before;
  for (int i = 0; i < kPairs; ++i) {
    const std::uint64_t time_ns = kStart_ns + static_cast<std::uint64_t>(i) * 100'000'000U;
    const auto image = [&](std::uint32_t connection, const cv::Mat& picture, std::uint64_t picture_ns) {
      const auto data =
          ros_image(false, topics.stamp_ns.value_or(picture_ns), picture.cols, picture.rows, topics.encoding,
                    picture.cols * static_cast<int>(picture.elemSize()), pixels_of(picture));
      records += BagBytes::message({connection, picture_ns, data});
    };
    image(0, left, time_ns);
    image(1, right, time_ns + topics.right_delay_ns);
    if (topics.has_left_twice) image(0, left, time_ns + 3'000'000U);
    for (const std::uint32_t connection : {2U, 3U}) {
      if (!topics.has_camera_info) break;
      const double shift = connection == 2 ? 0.0 : -camera.fx_px * camera.baseline_m * topics.baseline_factor;
      records += BagBytes::message({connection, time_ns,
                                    ros_camera_info(false, topics.has_camera_size ? camera.width_px : 0,
                                                    topics.has_camera_size ? camera.height_px : 0, camera.fx_px, shift,
                                                    topics.distortion, camera.cx_px, camera.cy_px)});
    }
  }
  std::ofstream(path, std::ios::binary) << BagBytes::start() << BagBytes::chunk("none", records, records.size())
                                        << topics.after;
}

}  // namespace flies::testing
