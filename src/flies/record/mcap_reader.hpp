#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace flies {

/// Where a message is in its file.
struct McapPlace {
  std::uint64_t record = 0;  ///< of its chunk, or of itself when it is in none
  std::size_t in_chunk = 0;  ///< position among the chunk's records
};

struct McapMessage {
  std::string topic, schema_name, encoding;  ///< encoding "json" of those that we write
  std::uint64_t time_ns = 0;                 ///< when it was logged, since 1970
  std::string data;
  McapPlace place;
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

  /// The message at a place that `next` told, in any order. Its chunk is kept for the next call.
  /// @throws InputError as `next`
  McapMessage at(const McapPlace& place);

  /// Whether the file ends as it should; known after its last message.
  bool is_whole() const { return is_whole_; }

 private:
  struct Channel {
    std::string topic, schema_name, encoding;
  };

  /// A chunk's records, and how far they are read.
  struct Chunk {
    std::uint64_t record = 0;
    std::string records;
    std::size_t position = 0;
  };
  struct Record {
    std::uint8_t opcode = 0;
    std::string content;
  };

  std::optional<Record> read_record(std::uint64_t position);
  std::optional<Record> next_in_chunk(Chunk& chunk) const;
  std::optional<McapMessage> take(const Record& record, const McapPlace& place);
  std::string unpacked(const std::string& chunk) const;
  [[noreturn]] void complain(const std::string& what) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0, position_ = 0;  ///< of the file, and of its next record
  Chunk chunk_, chunk_at_;                 ///< of `next` and of `at`
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  bool is_whole_ = false, has_ended_ = false;
};

}  // namespace flies
