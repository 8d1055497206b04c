#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace flies {

/// Where a message is in its file.
struct MessagePlace {
  std::uint64_t record = 0;  ///< of its chunk, or of itself when it is in none
  std::size_t in_chunk = 0;  ///< position among the chunk's records
};

struct RecordedMessage {
  std::string topic, schema_name;
  std::string encoding;       ///< "json" of those that we write, "ros1", "cdr" (ROS 2), or as the file says
  std::uint64_t time_ns = 0;  ///< when it was recorded, since 1970
  std::string data;
  MessagePlace place;
};

/// Reads the messages of a recording. Threads: one object serves one thread at a time.
class RecordingReader {
 public:
  virtual ~RecordingReader() = default;

  /// The next message in the order of the file; nothing at its end, also where it was cut off.
  /// @throws InputError naming the file when a chunk or a message is damaged, or compressed in an unknown way; the next
  ///         call goes on behind it
  virtual std::optional<RecordedMessage> next() = 0;

  /// The message at a place that `next` told, in any order. Its chunk is kept for the next call.
  /// @throws InputError as `next`
  virtual RecordedMessage at(const MessagePlace& place) = 0;

  /// Whether the file ends as it should; known after its last message.
  virtual bool is_whole() const = 0;
};

/// Opens an MCAP file or a bag of ROS 1, by its first bytes.
/// @throws InputError naming the file when it cannot be read or is neither
std::unique_ptr<RecordingReader> open_recording(const std::string& path);

}  // namespace flies
