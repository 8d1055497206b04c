#include "flies/record/mcap_writer.hpp"

#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <numeric>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/crc32.hpp"
#include "flies/io/exclusive_file.hpp"
#include "flies/record/mcap_records.hpp"

namespace flies {
namespace {

using namespace mcap;

constexpr std::size_t kChunk = 1U << 22;                // bytes
constexpr std::uint64_t kLongestChunk_ns = 1000000000;  // what a kill may cost
constexpr int kLevel = 1;                               // of compression: quick

/// Ids of schemas and channels count from 1: 0 means no schema.
std::uint16_t id_of(std::size_t channel) { return static_cast<std::uint16_t>(channel + 1); }

std::string compressed(std::string_view bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kLevel);
  assert(!ZSTD_isError(size));
  result.resize(size);
  return result;
}

}  // namespace

McapWriter::McapWriter(const std::string& path, std::vector<McapChannel> channels)
    : path_(path),
      descriptor_(open_exclusively(path, path)),
      channels_(std::move(channels)),
      sequences_(channels_.size(), 0) {
  std::string header, begin(kMagic);
  put_text(header, "");  // no profile
  put_text(header, "flies");
  put_record(begin, Opcode::header, header);
  append(begin + schemas_record() + channels_record());
}

McapWriter::~McapWriter() {
  try {
    close();
  } catch (const InputError&) {  // who wants to know calls close
  }
}

void McapWriter::fail(int error_number) {
  error_number_ = error_number;
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  throw InputError(path_, "", std::string("cannot write: ") + std::strerror(error_number));
}

void McapWriter::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(count < 0 ? errno : ENOSPC);
    position_ += static_cast<std::uint64_t>(count);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

std::string McapWriter::schemas_record() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    std::string schema;
    put_number(schema, id_of(i), 2);
    put_text(schema, channels_[i].schema_name);
    put_text(schema, "jsonschema");
    put_text(schema, channels_[i].schema);
    put_record(records, Opcode::schema, schema);
  }
  return records;
}

std::string McapWriter::channels_record() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    std::string channel;
    put_number(channel, id_of(i), 2);
    put_number(channel, id_of(i), 2);
    put_text(channel, channels_[i].topic);
    put_text(channel, "json");
    put_number(channel, 0, 4);  // no metadata
    put_record(records, Opcode::channel, channel);
  }
  return records;
}

void McapWriter::write(std::size_t channel, std::uint64_t time_ns, std::string_view message) {
  assert(channel < channels_.size());
  if (error_number_ != 0) fail(error_number_);
  if (descriptor_ < 0) return;
  if (chunk_.empty()) chunk_start_ns_ = chunk_end_ns_ = time_ns;
  chunk_start_ns_ = std::min(chunk_start_ns_, time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, time_ns);
  chunk_index_[id_of(channel)].emplace_back(time_ns, chunk_.size());
  std::string content;
  put_number(content, id_of(channel), 2);
  put_number(content, sequences_[channel]++, 4);
  put_number(content, time_ns, 8);  // logged and published at once
  put_number(content, time_ns, 8);
  content += message;
  put_record(chunk_, Opcode::message, content);
  if (chunk_.size() >= kChunk || chunk_end_ns_ - chunk_start_ns_ >= kLongestChunk_ns) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::string packed = compressed(chunk_);
  std::string content, records;
  put_number(content, chunk_start_ns_, 8);
  put_number(content, chunk_end_ns_, 8);
  put_number(content, chunk_.size(), 8);
  put_number(content, crc32(chunk_), 4);
  put_text(content, "zstd");
  put_number(content, packed.size(), 8);
  content += packed;
  put_record(records, Opcode::chunk, content);

  const std::size_t chunk_length = records.size();
  std::map<std::uint16_t, std::uint64_t> index_offsets;
  for (const auto& [id, entries] : chunk_index_) {
    index_offsets[id] = position_ + records.size();
    std::string index;
    put_number(index, id, 2);
    put_number(index, entries.size() * 16, 4);
    for (const auto& [time_ns, offset] : entries) {
      put_number(index, time_ns, 8);
      put_number(index, offset, 8);
    }
    put_record(records, Opcode::message_index, index);
  }
  std::string index;
  put_number(index, chunk_start_ns_, 8);
  put_number(index, chunk_end_ns_, 8);
  put_number(index, position_, 8);
  put_number(index, chunk_length, 8);
  put_map(index, index_offsets);
  put_number(index, records.size() - chunk_length, 8);
  put_text(index, "zstd");
  put_number(index, packed.size(), 8);
  put_number(index, chunk_.size(), 8);
  put_record(chunk_indexes_, Opcode::chunk_index, index);
  start_ns_ = chunks_ == 0 ? chunk_start_ns_ : std::min(start_ns_, chunk_start_ns_);
  end_ns_ = std::max(end_ns_, chunk_end_ns_);
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  append(records);
}

std::string McapWriter::statistics_record() const {
  std::string content, record;
  put_number(content, std::accumulate(sequences_.begin(), sequences_.end(), std::uint64_t{0}), 8);
  put_number(content, channels_.size(), 2);
  put_number(content, channels_.size(), 4);
  put_number(content, 0, 4);  // attachments
  put_number(content, 0, 4);  // metadata
  put_number(content, chunks_, 4);
  put_number(content, start_ns_, 8);
  put_number(content, end_ns_, 8);
  std::map<std::uint16_t, std::uint64_t> counts;
  for (std::size_t i = 0; i < channels_.size(); ++i)
    if (sequences_[i] > 0) counts[id_of(i)] = sequences_[i];
  put_map(content, counts);
  put_record(record, Opcode::statistics, content);
  return record;
}

void McapWriter::close() {
  if (error_number_ != 0) fail(error_number_);
  if (descriptor_ < 0) return;
  end_chunk();
  std::string end, content;
  put_number(content, 0, 4);  // no checksum of the data: its chunks have theirs
  put_record(end, Opcode::data_end, content);
  append(end);

  const std::uint64_t summary_start = position_;
  std::string summary, offsets;
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    if (records.empty()) return;
    std::string offset;
    put_number(offset, static_cast<std::uint8_t>(opcode), 1);
    put_number(offset, summary_start + summary.size(), 8);
    put_number(offset, records.size(), 8);
    put_record(offsets, Opcode::summary_offset, offset);
    summary += records;
  };
  add_group(Opcode::schema, schemas_record());
  add_group(Opcode::channel, channels_record());
  add_group(Opcode::statistics, statistics_record());
  add_group(Opcode::chunk_index, chunk_indexes_);
  const std::uint64_t offsets_start = summary_start + summary.size();
  std::string tail = summary + offsets;
  put_number(tail, static_cast<std::uint8_t>(Opcode::footer), 1);
  put_number(tail, 8 + 8 + 4, 8);
  put_number(tail, summary_start, 8);
  put_number(tail, offsets_start, 8);
  put_number(tail, crc32(tail), 4);
  append(tail + std::string(kMagic));
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);  // some file systems tell of a full disk only here
}

}  // namespace flies
