#include "flies/record/ros_message.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/gray_levels.hpp"
#include "flies/io/image_codecs.hpp"
#include "flies/io/image_file.hpp"

namespace flies {
namespace {

/// Largest side of a picture.
constexpr std::uint32_t kMaxSide_px = 32768;

/// Takes the fields of a message in their order. ROS 1 packs them; ROS 2 (CDR) aligns numbers to their size, counted
/// from behind four bytes that say in which order bytes stand, and ends texts by a zero.
class RosFields {
 public:
  RosFields(const RecordedMessage& message, const std::string& name)
      : bytes_(message.data), name_(name), is_cdr_(message.encoding == "cdr") {
    if (!is_cdr_) return;
    is_big_endian_ = (take(4)[1] & 1) == 0;
    origin_ = position_;
  }

  template <class T>
  T number() {
    if (is_cdr_) take((sizeof(T) - (position_ - origin_) % sizeof(T)) % sizeof(T));
    std::array<char, sizeof(T)> own{};
    const std::string_view bytes = take(sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) own[i] = bytes[is_big_endian_ ? sizeof(T) - 1 - i : i];
    return std::bit_cast<T>(own);
  }
  std::string text() {
    std::string_view own = take(number<std::uint32_t>());
    if (is_cdr_ && own.ends_with('\0')) own.remove_suffix(1);
    return std::string(own);
  }
  std::string_view byte_list() { return take(number<std::uint32_t>()); }
  std::vector<double> number_list() {
    const auto count = number<std::uint32_t>();
    if (count > bytes_.size() / sizeof(double)) too_short();
    std::vector<double> numbers;
    for (std::uint32_t i = 0; i < count; ++i) numbers.push_back(number<double>());
    return numbers;
  }
  template <std::size_t N>
  void fill(std::array<double, N>& numbers) {
    for (double& value : numbers) value = number<double>();
  }

  /// std_msgs/Header; its stamp in nanoseconds.
  std::uint64_t header() {
    if (!is_cdr_) number<std::uint32_t>();  // sequence number
    const std::uint64_t seconds = number<std::uint32_t>(), rest_ns = number<std::uint32_t>();
    text();  // frame
    return seconds * 1'000'000'000U + rest_ns;
  }

 private:
  [[noreturn]] void too_short() const { throw InputError(name_, "", "the message ends too early"); }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size() - position_) too_short();
    position_ += count;
    return bytes_.substr(position_ - count, count);
  }

  std::string_view bytes_;
  const std::string& name_;
  bool is_cdr_, is_big_endian_ = false;
  std::size_t position_ = 0, origin_ = 0;
};

/// How pixels lie in an image of ROS.
struct PixelFormat {
  std::string_view encoding;
  int type;        ///< of OpenCV
  int conversion;  ///< to grey; -1: is grey
  std::optional<BayerPattern> mosaic = {};
};
constexpr std::array<PixelFormat, 22> kFormats = {{{"mono8", CV_8UC1, -1},
                                                   {"8UC1", CV_8UC1, -1},
                                                   {"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
                                                   {"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
                                                   {"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
                                                   {"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
                                                   {"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
                                                   {"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY},
                                                   {"mono16", CV_16UC1, -1},
                                                   {"16UC1", CV_16UC1, -1},
                                                   {"rgb16", CV_16UC3, cv::COLOR_RGB2GRAY},
                                                   {"bgr16", CV_16UC3, cv::COLOR_BGR2GRAY},
                                                   {"16UC3", CV_16UC3, cv::COLOR_BGR2GRAY},
                                                   {"rgba16", CV_16UC4, cv::COLOR_RGBA2GRAY},
                                                   {"bgra16", CV_16UC4, cv::COLOR_BGRA2GRAY},
                                                   {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
                                                   {"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
                                                   {"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
                                                   {"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
                                                   {"nv12", CV_8UC1, -1},  // colours follow behind the grey rows
                                                   {"nv21", CV_8UC1, -1},
                                                   {"nv24", CV_8UC1, -1}}};

/// @throws InputError naming the message when it is not read
PixelFormat format_of(const std::string& encoding, const std::string& name) {
  if (const auto pattern = ros_bayer_pattern(encoding))
    return {encoding, encoding.ends_with("16") ? CV_16UC1 : CV_8UC1, -1, pattern};
  const auto* format = std::ranges::find(kFormats, std::string_view(encoding), &PixelFormat::encoding);
  if (format != kFormats.end()) return *format;
  std::vector<std::string_view> known;
  for (const auto& one : kFormats) known.push_back(one.encoding);
  throw InputError(
      name, "encoding",
      fmt::format("found '{}', expected {}, or bayer_rggb8 and the like", encoding, fmt::join(known, ", ")));
}

[[noreturn]] void refuse_colours(const std::string& name) {
  throw InputError(name, "pixels", "found colours, expected the grey levels of a mosaic (--bayer)");
}

bool is_gray(const PixelFormat& format) { return CV_MAT_CN(format.type) == 1 && !format.encoding.starts_with("nv"); }

cv::Mat plain_picture(RosFields& fields, const std::string& name, std::optional<BayerPattern> mosaic) {
  const auto height = fields.number<std::uint32_t>(), width = fields.number<std::uint32_t>();
  const std::string encoding = fields.text();
  const bool is_big_endian = fields.number<std::uint8_t>() != 0;
  const auto step = fields.number<std::uint32_t>();
  const std::string_view data = fields.byte_list();
  const PixelFormat format = format_of(encoding, name);
  if (mosaic && !is_gray(format)) refuse_colours(name);
  if (format.mosaic) mosaic = format.mosaic;
  const auto pixel_bytes = static_cast<std::uint64_t>(CV_ELEM_SIZE(format.type));
  if (width == 0 || height == 0 || width > kMaxSide_px || height > kMaxSide_px || step < width * pixel_bytes ||
      data.size() < std::uint64_t{step} * (height - 1) + width * pixel_bytes)
    throw InputError(name, "data",
                     fmt::format("found {} bytes and rows of {}, too few for {} x {} px of {}", data.size(), step,
                                 width, height, encoding));
  cv::Mat pixels(static_cast<int>(height), static_cast<int>(width), format.type);
  for (int v = 0; v < pixels.rows; ++v)
    std::memcpy(pixels.ptr(v), data.data() + static_cast<std::size_t>(v) * step, width * pixel_bytes);
  if (is_big_endian && pixels.depth() == CV_16U) {
    cv::Mat levels = pixels.reshape(1);  // which shares them
    for (auto level = levels.begin<std::uint16_t>(); level != levels.end<std::uint16_t>(); ++level)
      *level = static_cast<std::uint16_t>(*level << 8 | *level >> 8);
  }
  if (mosaic) return demosaiced(pixels, *mosaic);
  cv::Mat gray = pixels;
  if (format.conversion >= 0) cv::cvtColor(pixels, gray, format.conversion);
  return gray;
}

/// The pixels of a file, grey or in colours.
cv::Mat decoded(std::string_view bytes, const std::string& name) {
  if (const auto fault = detail::image_file_fault(std::string(bytes)); !fault.empty())
    throw InputError(name, "", fault);
  cv::Mat pixels = decode_image(bytes);
  if (pixels.empty() || (pixels.depth() != CV_8U && pixels.depth() != CV_16U))
    throw InputError(name, "", "is no picture of 8 or 16 bits");
  return pixels;
}

cv::Mat compressed_picture(RosFields& fields, const std::string& name, std::optional<BayerPattern> mosaic) {
  const auto own = ros_bayer_pattern(fields.text());
  const std::string_view bytes = fields.byte_list();
  if (!own) return picture_of_file(bytes, name, mosaic);
  const cv::Mat pixels = decoded(bytes, name);  // in which colours may have been made of the mosaic, unsaid
  return pixels.channels() == 1 ? demosaiced(pixels, *own) : gray_levels(pixels);
}

}  // namespace

cv::Mat picture_of_file(std::string_view bytes, const std::string& name, std::optional<BayerPattern> mosaic) {
  const cv::Mat pixels = decoded(bytes, name);
  if (!mosaic) return gray_levels(pixels);
  if (pixels.channels() > 1) refuse_colours(name);
  return demosaiced(pixels, *mosaic);
}

RosType ros_type(const RecordedMessage& message) {
  if (message.encoding != "ros1" && message.encoding != "cdr") return RosType::other;
  std::string_view schema = message.schema_name;
  constexpr std::string_view kPackage = "sensor_msgs/", kFolder = "msg/";
  if (!schema.starts_with(kPackage)) return RosType::other;
  schema.remove_prefix(kPackage.size());
  if (schema.starts_with(kFolder)) schema.remove_prefix(kFolder.size());
  if (schema == "Image") return RosType::image;
  if (schema == "CompressedImage") return RosType::compressed_image;
  return schema == "CameraInfo" ? RosType::camera_info : RosType::other;
}

std::uint64_t ros_stamp_ns(const RecordedMessage& message, const std::string& name) {
  return RosFields(message, name).header();
}

std::string ros_picture_format(const RecordedMessage& message, const std::string& name) {
  RosFields fields(message, name);
  fields.header();
  if (ros_type(message) == RosType::image) {
    fields.number<std::uint32_t>();  // height
    fields.number<std::uint32_t>();  // width
  }
  return fields.text();
}

std::optional<BayerPattern> ros_bayer_pattern(std::string_view format) {
  constexpr std::string_view kMosaic = "bayer_", kCompressed = " compressed ";
  if (const auto end = format.find(';'); end != format.npos) {
    const auto at = format.find(kCompressed);  // what was compressed follows, where it is not the picture itself
    if (at != format.npos && at + kCompressed.size() < format.size() &&
        !ros_bayer_pattern(format.substr(at + kCompressed.size())))
      return std::nullopt;
    format = format.substr(0, end);
  }
  if (!format.starts_with(kMosaic) || !(format.ends_with("8") || format.ends_with("16"))) return std::nullopt;
  format.remove_prefix(kMosaic.size());
  format.remove_suffix(format.ends_with("8") ? 1 : 2);
  return bayer_pattern_of(std::string(format));
}

cv::Mat ros_picture(const RecordedMessage& message, const std::string& name, std::optional<BayerPattern> mosaic) {
  RosFields fields(message, name);
  fields.header();
  return ros_type(message) == RosType::image ? plain_picture(fields, name, mosaic)
                                             : compressed_picture(fields, name, mosaic);
}

RosCameraInfo ros_camera_info(const RecordedMessage& message, const std::string& name) {
  RosFields fields(message, name);
  fields.header();
  RosCameraInfo info;
  info.topic = message.topic;
  const auto count = [&](const char* field, const char* unit) {
    const auto found = fields.number<std::uint32_t>();
    if (found > kMaxSide_px) throw InputError(name, field, fmt::format("found {}{}, which no camera has", found, unit));
    return static_cast<int>(found);
  };
  const auto pixels = [&](const char* field) { return count(field, " px"); };
  info.height_px = pixels("height");
  info.width_px = pixels("width");
  info.distortion_model = fields.text();
  info.distortion = fields.number_list();
  fields.fill(info.intrinsics);
  fields.fill(info.rectification);
  fields.fill(info.projection);
  info.binning_x = count("binning_x", "");
  info.binning_y = count("binning_y", "");
  info.window.x_px = pixels("roi.x_offset");
  info.window.y_px = pixels("roi.y_offset");
  info.window.height_px = pixels("roi.height");
  info.window.width_px = pixels("roi.width");
  return info;
}

}  // namespace flies
