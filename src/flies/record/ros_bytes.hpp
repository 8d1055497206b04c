#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

/// Writes messages of ROS and bags for the tests, from their descriptions.
namespace flies::testing {

/// The fields of a message, packed as in ROS 1 or aligned as in ROS 2 (CDR).
class RosBytes {
 public:
  explicit RosBytes(bool is_cdr, bool is_big_endian = false) : is_cdr_(is_cdr), is_big_endian_(is_big_endian) {
    if (is_cdr) bytes_ = {'\0', is_big_endian ? '\0' : '\1', '\0', '\0'};
    origin_ = bytes_.size();
  }

  template <class T>
  RosBytes& number(T value) {
    while (is_cdr_ && (bytes_.size() - origin_) % sizeof(T) != 0) bytes_.push_back('\0');
    std::string own(sizeof(T), '\0');
    std::memcpy(own.data(), &value, sizeof(T));
    bytes_ += is_big_endian_ ? std::string(own.rbegin(), own.rend()) : own;
    return *this;
  }
  RosBytes& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size() + (is_cdr_ ? 1 : 0)));
    bytes_ += text;
    if (is_cdr_) bytes_.push_back('\0');
    return *this;
  }
  RosBytes& list(std::string_view bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  RosBytes& header(std::uint32_t seconds, std::uint32_t nanoseconds) {
    if (!is_cdr_) number(std::uint32_t{7});
    return number(seconds).number(nanoseconds).text("cam");
  }
  std::string bytes() const { return bytes_; }

 private:
  bool is_cdr_, is_big_endian_;
  std::string bytes_;
  std::size_t origin_ = 0;
};

/// sensor_msgs/Image
inline std::string ros_image(bool is_cdr, std::uint64_t stamp_ns, int width, int height, std::string_view encoding,
                             int step, std::string_view pixels, bool is_big_endian = false) {
  return RosBytes(is_cdr)
      .header(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000U),
              static_cast<std::uint32_t>(stamp_ns % 1'000'000'000U))
      .number(static_cast<std::uint32_t>(height))
      .number(static_cast<std::uint32_t>(width))
      .text(encoding)
      .number(static_cast<std::uint8_t>(is_big_endian))
      .number(static_cast<std::uint32_t>(step))
      .list(pixels)
      .bytes();
}

/// sensor_msgs/CameraInfo with K = P, no rotation.
/// @param shift P's fourth number, minus focal length times baseline
/// @param binning_and_roi binning_x, binning_y; x_offset, y_offset, height, width
inline std::string ros_camera_info(bool is_cdr, int width, int height, double focal_px, double shift,
                                   const std::vector<double>& distortion = {}, double cx = 320, double cy = 192,
                                   const std::array<std::uint32_t, 6>& binning_and_roi = {}) {
  RosBytes info(is_cdr);
  info.header(1, 2).number(static_cast<std::uint32_t>(height)).number(static_cast<std::uint32_t>(width));
  info.text("plumb_bob").number(static_cast<std::uint32_t>(distortion.size()));
  for (const double d : distortion) info.number(d);
  for (const double k : {focal_px, 0.0, cx, 0.0, focal_px, cy, 0.0, 0.0, 1.0}) info.number(k);
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) info.number(r);
  for (const double p : {focal_px, 0.0, cx, shift, 0.0, focal_px, cy, 0.0, 0.0, 0.0, 1.0, 0.0}) info.number(p);
  for (const std::uint32_t number : binning_and_roi) info.number(number);
  return info.number(std::uint8_t{0}).bytes();
}

/// A bag of ROS 1.
class BagBytes {
 public:
  struct Message {
    std::uint32_t connection = 0;
    std::uint64_t time_ns = 0;
    std::string data;
  };

  static std::string field(std::string_view name, std::string_view value) {
    return number(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + std::string(name) + '=' +
           std::string(value);
  }
  template <class T>
  static std::string number(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
  }
  static std::string record(std::uint8_t operation, const std::string& fields, const std::string& data) {
    const std::string header = field("op", std::string(1, static_cast<char>(operation))) + fields;
    return number(static_cast<std::uint32_t>(header.size())) + header +
           number(static_cast<std::uint32_t>(data.size())) + data;
  }
  static std::string connection(std::uint32_t id, std::string_view topic, std::string_view type) {
    return record(0x07, field("conn", number(id)) + field("topic", topic),
                  field("topic", topic) + field("type", type) + field("md5sum", "*"));
  }
  static std::string message(const Message& message) {
    const auto seconds = static_cast<std::uint32_t>(message.time_ns / 1'000'000'000U);
    const auto rest = static_cast<std::uint32_t>(message.time_ns % 1'000'000'000U);
    return record(0x02, field("conn", number(message.connection)) + field("time", number(seconds) + number(rest)),
                  message.data);
  }
  static std::string chunk(const std::string& compression, const std::string& packed, std::size_t size) {
    return record(0x05, field("compression", compression) + field("size", number(static_cast<std::uint32_t>(size))),
                  packed);
  }
  static std::string start(std::uint64_t index = 4117) {
    return "#ROSBAG V2.0\n" + record(0x03, field("index_pos", number(index)), std::string(40, ' '));
  }
};

}  // namespace flies::testing
