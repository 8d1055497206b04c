#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "flies/record/recorded_message.hpp"

namespace flies {

/// Reads a bag of ROS 1 (http://wiki.ros.org/Bags/Format/2.0) from its beginning to its end, or as far as it is whole.
/// Messages have the encoding "ros1" and the schema name that ROS calls their type.
class BagReader final : public RecordingReader {
 public:
  /// @throws InputError naming the file when it cannot be read or is no bag of format 2.0
  explicit BagReader(const std::string& path);

  std::optional<RecordedMessage> next() override;
  RecordedMessage at(const MessagePlace& place) override;
  bool is_whole() const override { return is_whole_; }

 private:
  struct Connection {
    std::string topic, type;
  };
  struct Record {
    std::map<std::string, std::string, std::less<>> fields;  ///< empty when they are damaged
    std::string data;
    std::size_t length = 0;  ///< of the record in its file or chunk

    std::uint64_t number(std::string_view field) const;  ///< little-endian; 0 when it is missing
    std::string text(std::string_view field) const;
  };
  struct Chunk {
    std::uint64_t record = 0;
    std::string records;
    std::size_t position = 0;
  };

  std::optional<Record> read_record(std::uint64_t position);
  std::optional<Record> next_in_chunk(Chunk& chunk) const;
  std::optional<RecordedMessage> take(const Record& record, const MessagePlace& place);
  bool take_connection(const Record& record);
  const Connection* connection(std::uint64_t id);
  void read_index();
  std::string unpacked(const Record& chunk) const;
  [[noreturn]] void complain(const std::string& what) const;

  std::string path_;
  std::ifstream file_;
  std::uint64_t size_ = 0, position_ = 0;  ///< of the file, and of its next record
  Chunk chunk_, chunk_at_;                 ///< of `next` and of `at`
  std::map<std::uint64_t, Connection> connections_;
  std::uint64_t index_ = 0;  ///< where the connections stand again; 0: the recorder did not come to its end
  bool is_whole_ = false, has_read_index_ = false, has_told_unknown_connections_ = false;
};

}  // namespace flies
