#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace flies {

/// A topic of a recording; its messages are JSON.
struct McapChannel {
  std::string topic;
  std::string schema_name;
  std::string schema;  ///< JSON Schema
};

/// Writes an MCAP file (https://mcap.dev): messages in chunks compressed with Zstandard, an index at the end. A chunk
/// is written at once, so that a file whose writer was killed is readable up to its last whole chunk.
class McapWriter {
 public:
  /// @throws InputError naming the file when it cannot be created, or another run is writing it
  McapWriter(const std::string& path, std::vector<McapChannel> channels);
  /// Closes the file; what goes wrong then is lost: call `close`.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// @param channel index of the channel
  /// @param time_ns since 1970
  /// @throws InputError naming the file when the disk is full or the like, and so does every call after that
  void write(std::size_t channel, std::uint64_t time_ns, std::string_view message);

  /// Writes what waits and the index. @throws InputError as `write`
  void close();

 private:
  [[noreturn]] void fail(int error_number);
  void append(std::string_view bytes);
  void end_chunk();
  std::string schemas_record() const;
  std::string channels_record() const;
  std::string statistics_record() const;

  std::string path_;
  int descriptor_ = -1;
  int error_number_ = 0;        ///< of what failed first
  std::uint64_t position_ = 0;  ///< in the file
  std::vector<McapChannel> channels_;
  std::vector<std::uint32_t> sequences_;  ///< messages of each channel so far
  std::string chunk_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;  ///< time and offset
  std::uint64_t chunk_start_ns_ = 0, chunk_end_ns_ = 0;
  std::uint64_t start_ns_ = 0, end_ns_ = 0;  ///< of all chunks
  std::uint32_t chunks_ = 0;
  std::string chunk_indexes_;  ///< as they will stand at the end: all that grows, some 200 bytes a chunk
};

}  // namespace flies
