#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "flies/record/recorded_message.hpp"

namespace flies {

/// Reads an MCAP file from its beginning to its end, or as far as it is whole. Chunks are stored as they are or
/// compressed with Zstandard or LZ4.
class McapReader final : public RecordingReader {
 public:
  /// @throws InputError naming the file when it cannot be read or is no MCAP file
  explicit McapReader(const std::string& path);

  std::optional<RecordedMessage> next() override;
  RecordedMessage at(const MessagePlace& place) override;
  bool is_whole() const override { return is_whole_; }

 private:
  struct Channel {
    std::uint16_t schema = 0;  ///< 0: none
    std::string topic, encoding;
  };

  /// A chunk's records, and how far they are read.
  struct Chunk {
    std::uint64_t record = 0;
    std::string records;
    std::size_t position = 0;
  };
  struct Record {
    std::uint8_t opcode = 0;
    std::string content;       ///< empty where the record is not used
    std::uint64_t length = 0;  ///< of the record with its head
  };

  std::optional<Record> read_record(std::uint64_t position);
  std::optional<Record> next_in_chunk(Chunk& chunk) const;
  std::optional<RecordedMessage> take(const Record& record, const MessagePlace& place);
  bool take_schema(const Record& record);
  bool take_channel(const Record& record);
  const Channel* channel(std::uint16_t id);
  bool knows_schema_of(const Channel& channel) const;
  std::string schema_name(const Channel& channel) const;
  void read_summary();
  std::string unpacked(const std::string& chunk) const;
  [[noreturn]] void complain(const std::string& what) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0, position_ = 0;  ///< of the file, and of its next record
  Chunk chunk_, chunk_at_;                 ///< of `next` and of `at`
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  bool is_whole_ = false, has_ended_ = false, has_summary_ = false, has_told_unknown_channels_ = false;
};

}  // namespace flies
