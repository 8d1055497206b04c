#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/io/mosaic.hpp"
#include "flies/record/recorded_message.hpp"

namespace flies {

/// What a message of ROS is that we read: sensor_msgs/Image and so on, in ROS 2 sensor_msgs/msg/Image.
enum class RosType { image, compressed_image, camera_info, other };

/// By encoding ("ros1", "cdr") and schema; `other` for all that is not ROS's.
RosType ros_type(const RecordedMessage& message);

/// The stamp of a message that is not `other`, nanoseconds: when the camera took the picture.
/// @param name of the message in errors
/// @throws InputError when the message ends before its stamp
std::uint64_t ros_stamp_ns(const RecordedMessage& message, const std::string& name);

/// How the picture of an image message is encoded, as it says itself: "mono8", "bayer_rggb8"; of a CompressedImage its
/// format, such as "bgr8; jpeg compressed bgr8".
/// @throws InputError when the message ends too early
std::string ros_picture_format(const RecordedMessage& message, const std::string& name);

/// The pattern of a mosaic of colours, of 8 or 16 bits; nothing of other formats. Of a CompressedImage too, where its
/// format does not say that colours were made of the mosaic before: "bayer_rggb8; jpeg compressed ".
std::optional<BayerPattern> ros_bayer_pattern(std::string_view format);

/// The picture of an image message: grey levels of 8 or 16 bits, for `pair_of_levels`. Image: mono, rgb, bgr, rgba and
/// bgra of 8 or 16 bits, 8UC1, 8UC3, 8UC4, 16UC1, 16UC3, yuv422 (uyvy), yuv422_yuy2 (yuyv), nv12, nv21, nv24 and Bayer
/// mosaics of 8 or 16 bits. CompressedImage: JPEG or PNG, of a mosaic too.
/// @param mosaic what the user says that grey pictures are, where they do not say themselves that they are a mosaic
/// @throws InputError naming the message: another encoding, too few bytes, a damaged picture, colours where the user
///         says that it is a mosaic
cv::Mat ros_picture(const RecordedMessage& message, const std::string& name,
                    std::optional<BayerPattern> mosaic = std::nullopt);

/// The same of a JPEG or PNG file in memory.
/// @throws InputError naming it
cv::Mat picture_of_file(std::string_view bytes, const std::string& name,
                        std::optional<BayerPattern> mosaic = std::nullopt);

/// sensor_msgs/CameraInfo. All numbers are of the pixels of whole images.
struct RosCameraInfo {
  std::string topic;  ///< where it came
  int width_px = 0, height_px = 0;
  std::string distortion_model;           ///< plumb_bob, rational_polynomial, equidistant; empty: none
  std::vector<double> distortion;         ///< D
  std::array<double, 9> intrinsics{};     ///< K, row by row
  std::array<double, 9> rectification{};  ///< R: rectified_from_camera, row by row
  std::array<double, 12> projection{};    ///< P, row by row
  int binning_x = 0, binning_y = 0;       ///< pixels of whole images that became one; 0: 1
  /// The part of the images that was given; 0 x 0: all.
  struct Window {
    int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
    bool operator==(const Window&) const = default;
  } window;
};

/// @throws InputError naming the message when it ends too early
RosCameraInfo ros_camera_info(const RecordedMessage& message, const std::string& name);

}  // namespace flies
