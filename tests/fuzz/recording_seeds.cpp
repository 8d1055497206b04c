#include "tests/fuzz/recording_seeds.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <array>
#include <opencv2/core.hpp>
#include <utility>

#include "flies/io/image_codecs.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/writers.hpp"
#include "flies/record/mcap_records.hpp"
#include "flies/record/mcap_writer.hpp"
#include "flies/record/ros_bytes.hpp"

namespace flies::testing {
namespace {

/// @param way as both formats call it
std::string packed(const std::string& way, std::string bytes) {
  std::string result(2 * bytes.size() + 1000, '\0');
  if (way == "zstd") {
    result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 3));
  } else if (way == "lz4") {
    result.resize(LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
  } else if (way == "bz2") {
    auto size = static_cast<unsigned>(result.size());
    BZ2_bzBuffToBuffCompress(result.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()), 9, 0, 0);
    result.resize(size);
  } else {
    result = std::move(bytes);
  }
  return result;
}

struct RosMessage {
  const char *topic, *type;
  std::string data;
};

std::array<RosMessage, 4> ros_messages(bool is_cdr) {
  const auto png = encode_png(cv::Mat(2, 3, CV_8U, cv::Scalar(7)));
  const std::string compressed =
      RosBytes(is_cdr).header(1, 2).text("png").list({reinterpret_cast<const char*>(png.data()), png.size()}).bytes();
  const auto camera = [&](double shift) {
    return ros_camera_info(is_cdr, 64, 48, 50, shift, {-0.3, 0.08, 0, 0, 0}, 32, 24);
  };
  return {RosMessage{"/left/image_raw", "sensor_msgs/Image", ros_image(is_cdr, 1, 2, 2, "mono8", 2, "abcd")},
          {"/right/image_raw/compressed", "sensor_msgs/CompressedImage", compressed},
          {"/left/camera_info", "sensor_msgs/CameraInfo", camera(0)},
          {"/right/camera_info", "sensor_msgs/CameraInfo", camera(-5)}};
}

std::string bag(const std::string& compression) {
  std::string records;
  std::uint32_t id = 0;
  for (const auto& [topic, type, data] : ros_messages(false)) {
    records += BagBytes::connection(id, topic, type) + BagBytes::message({id, 1, data});
    ++id;
  }
  return BagBytes::start() + BagBytes::chunk(compression, packed(compression, records), records.size());
}

/// As ROS 2 records. Its checksum of 0 is none, which would keep damage from the reader behind it.
std::string ros2_mcap(const std::string& compression) {
  std::string records;
  std::uint64_t id = 0;
  for (const auto& [topic, type, data] : ros_messages(true)) {
    std::string schema, channel, message;
    put_number(schema, ++id, 2);
    for (const char* text : {type, "ros2msg", ""}) mcap::put_text(schema, text);
    for (int i = 0; i < 2; ++i) put_number(channel, id, 2);
    for (const char* text : {topic, "cdr", ""}) mcap::put_text(channel, text);
    put_number(message, id, 2);
    put_number(message, 0, 4);
    for (int i = 0; i < 2; ++i) put_number(message, 1'000'000'000U + id, 8);
    mcap::put_record(records, mcap::Opcode::schema, schema);
    mcap::put_record(records, mcap::Opcode::channel, channel);
    mcap::put_record(records, mcap::Opcode::message, message + data);
  }
  std::string chunk;
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{9}, std::uint64_t{records.size()}})
    put_number(chunk, number, 8);
  put_number(chunk, 0, 4);
  mcap::put_text(chunk, compression == "none" ? "" : compression);
  const std::string bytes = packed(compression, records);
  put_number(chunk, bytes.size(), 8);
  std::string file(mcap::kMagic);
  mcap::put_record(file, mcap::Opcode::chunk, chunk + bytes);
  mcap::put_record(file, mcap::Opcode::data_end, std::string(4, '\0'));
  return file + std::string(mcap::kMagic);
}

/// As we record what was found.
std::string own_mcap() {
  const TemporaryFolder folder;
  const std::string path = folder.file("own.mcap");
  McapWriter writer(path, {{"/flies/detections", "flies.Detections", R"({"type":"object"})"}});
  for (int i = 0; i < 3; ++i) {
    FrameRecord record;
    record.frame = i;
    writer.write(0, 1'000'000'000U + static_cast<std::uint64_t>(i), json_line(record));
  }
  writer.close();
  return read_all(path);
}

}  // namespace

std::vector<std::string> recording_seeds() {
  std::vector<std::string> seeds = {own_mcap()};
  for (const char* compression : {"none", "zstd", "lz4", "bz2"}) {
    seeds.push_back(bag(compression));
    seeds.push_back(ros2_mcap(compression));
  }
  return seeds;
}

}  // namespace flies::testing
