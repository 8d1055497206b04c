#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace flies {

struct McapMessage {
  std::string topic, schema_name, encoding;  ///< encoding "json" of those that we write
  std::uint64_t time_ns = 0;                 ///< when it was logged, since 1970
  std::string data;
};

/// Reads an MCAP file from its beginning to its end, or as far as it is whole. Chunks are stored as they are or
/// compressed with Zstandard.
class McapReader {
 public:
  /// @throws InputError naming the file when it cannot be read or is no MCAP file
  explicit McapReader(const std::string& path);

  /// The next message in the order of the file; nothing at its end, also where it was cut off.
  /// @throws InputError naming the file when a chunk is damaged or compressed in another way
  std::optional<McapMessage> next();

  /// Whether the file ends as it should; known after its last message.
  bool is_whole() const { return is_whole_; }

 private:
  struct Channel {
    std::string topic, schema_name, encoding;
  };

  std::optional<McapMessage> take(std::uint8_t opcode, const std::string& content);
  std::string unpacked(const std::string& chunk) const;
  [[noreturn]] void complain(const std::string& what) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t left_ = 0;  ///< bytes of the file
  std::string chunk_;       ///< records of the present one
  std::size_t chunk_position_ = 0;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  bool is_whole_ = false, has_ended_ = false;
};

}  // namespace flies
