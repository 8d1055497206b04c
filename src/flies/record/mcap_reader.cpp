#include "flies/record/mcap_reader.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/crc32.hpp"
#include "flies/record/byte_taker.hpp"
#include "flies/record/decompress.hpp"
#include "flies/record/mcap_records.hpp"

namespace flies {
using namespace mcap;

namespace {

/// A chunk with its head. Longer records are taken for damaged ones.
constexpr std::uint64_t kLargestRecord_bytes = kLargestChunk_bytes + 1024;

/// Whether `McapReader` looks into records of this kind; indexes, attachments and the like may be of any length.
bool is_used(std::uint8_t opcode) {
  switch (static_cast<Opcode>(opcode)) {
    case Opcode::schema:
    case Opcode::channel:
    case Opcode::message:
    case Opcode::chunk:
    case Opcode::data_end:
      return true;
    default:
      return false;
  }
}

/// Whether a chunk may hold it; what is not used does no harm there.
bool may_be_in_chunk(Opcode opcode) { return opcode != Opcode::chunk && opcode != Opcode::data_end; }

}  // namespace

void McapReader::complain(const std::string& what) const { throw InputError(path_, "", what); }

McapReader::McapReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (!file_ || error) complain("cannot be read");
  std::string magic(kMagic.size(), '\0');
  if (!file_.read(magic.data(), static_cast<std::streamsize>(magic.size())) || magic != kMagic)
    complain("is no MCAP recording");
  position_ = magic.size();
}

std::string McapReader::unpacked(const std::string& chunk) const {
  ByteTaker taker(chunk);
  taker.take(16);  // times
  const std::uint64_t size = taker.number(8);
  const auto checksum = static_cast<std::uint32_t>(taker.number(4));
  const std::string compression = taker.text();
  const std::string_view records = taker.take(taker.number(8));
  if (!taker.is_good) complain("a chunk is damaged");
  if (!is_known_compression(compression))
    complain(fmt::format("chunks are compressed with '{}', expected {}", compression, kCompressions));
  auto unpacked = decompress(compression, records, size);
  if (!unpacked) complain("a chunk is damaged");
  std::string result = std::move(*unpacked);
  if (checksum != 0 && crc32(result) != checksum) complain("a chunk is damaged: its checksum is another");
  return result;
}

bool McapReader::knows_schema_of(const Channel& channel) const {
  return channel.schema == 0 || schemas_.contains(channel.schema);  // 0: it has none
}

/// The name of a channel's schema; empty when it has none.
std::string McapReader::schema_name(const Channel& channel) const {
  const auto found = schemas_.find(channel.schema);
  return found == schemas_.end() ? std::string() : found->second;
}

/// The channel of a message. Where the chunk that says it or its schema is damaged, the end of the file says it again.
/// @returns nothing when it does not, either
/// @throws InputError the first time
const McapReader::Channel* McapReader::channel(std::uint16_t id) {
  const auto known = channels_.find(id);
  if (!has_summary_ && (known == channels_.end() || !knows_schema_of(known->second))) read_summary();
  const auto found = channels_.find(id);
  if (found != channels_.end()) return &found->second;
  if (!std::exchange(has_told_unknown_channels_, true))
    complain("there are messages of channels that it does not describe");
  return nullptr;
}

/// The channels that the end of the file says, if it has one: the footer tells where.
void McapReader::read_summary() {
  constexpr std::uint64_t kFooter = kRecordHead + 8 + 8 + 4;
  has_summary_ = true;
  if (size_ < 2 * kMagic.size() + kFooter) return;
  const std::uint64_t footer_at = size_ - kMagic.size() - kFooter;
  std::string footer(kFooter, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(footer_at));
  if (!file_.read(footer.data(), static_cast<std::streamsize>(footer.size()))) return;
  ByteTaker taker(footer);
  if (static_cast<Opcode>(taker.number(1)) != Opcode::footer) return;
  taker.number(8);
  std::uint64_t at = taker.number(8);
  while (at >= kMagic.size() && at < footer_at) {
    const auto record = read_record(at);
    if (!record) return;
    const auto opcode = static_cast<Opcode>(record->opcode);
    if (opcode == Opcode::schema) take_schema(*record);
    if (opcode == Opcode::channel) take_channel(*record);
    at += record->length;
  }
}

/// @returns whether it is whole
bool McapReader::take_schema(const Record& record) {
  ByteTaker taker(record.content);
  const auto id = static_cast<std::uint16_t>(taker.number(2));
  std::string name = taker.text();
  if (taker.is_good) schemas_[id] = std::move(name);
  return taker.is_good;
}

/// @returns whether it is whole
bool McapReader::take_channel(const Record& record) {
  ByteTaker taker(record.content);
  const auto id = static_cast<std::uint16_t>(taker.number(2));
  Channel channel;
  channel.schema = static_cast<std::uint16_t>(taker.number(2));
  channel.topic = taker.text();
  channel.encoding = taker.text();
  if (taker.is_good) channels_[id] = std::move(channel);
  return taker.is_good;
}

/// What a record says; a message when it is one.
std::optional<RecordedMessage> McapReader::take(const Record& record, const MessagePlace& place) {
  ByteTaker taker(record.content);
  switch (static_cast<Opcode>(record.opcode)) {
    case Opcode::schema:
      if (!take_schema(record)) complain("a schema is damaged");
      break;
    case Opcode::channel:
      if (!take_channel(record)) complain("a channel is damaged");
      break;
    case Opcode::message: {
      const auto id = static_cast<std::uint16_t>(taker.number(2));
      taker.number(4);
      const std::uint64_t time_ns = taker.number(8);
      taker.number(8);
      if (!taker.is_good) complain("a message is damaged");
      const Channel* own = channel(id);
      if (own == nullptr) break;
      return RecordedMessage{own->topic, schema_name(*own), own->encoding, time_ns, std::string(taker.rest()), place};
    }
    case Opcode::chunk:
      chunk_ = {place.record, unpacked(record.content), 0};
      break;
    case Opcode::data_end:
      is_whole_ = has_ended_ = true;
      break;
    default:
      break;
  }
  return std::nullopt;
}

/// Nothing where the file ends before the record does: its writer was killed, or it is damaged. Nothing, too, where a
/// record is longer than any can be.
std::optional<McapReader::Record> McapReader::read_record(std::uint64_t position) {
  std::string head(kRecordHead, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  if (size_ - position < kRecordHead || !file_.read(head.data(), kRecordHead)) return std::nullopt;
  ByteTaker taker(head);
  const auto opcode = static_cast<std::uint8_t>(taker.number(1));
  const std::uint64_t length = taker.number(8);
  if (length > size_ - position - kRecordHead) return std::nullopt;
  Record record{opcode, {}, kRecordHead + length};
  if (!is_used(opcode)) return record;
  if (length > kLargestRecord_bytes) return std::nullopt;
  record.content.resize(length);
  if (!file_.read(record.content.data(), static_cast<std::streamsize>(length))) return std::nullopt;
  return record;
}

std::optional<McapReader::Record> McapReader::next_in_chunk(Chunk& chunk) const {
  if (chunk.position >= chunk.records.size()) return std::nullopt;
  ByteTaker taker(std::string_view(chunk.records).substr(chunk.position));
  Record record;
  record.opcode = static_cast<std::uint8_t>(taker.number(1));
  record.content = std::string(taker.take(taker.number(8)));
  record.length = kRecordHead + record.content.size();
  const bool belongs_here = may_be_in_chunk(static_cast<Opcode>(record.opcode));
  if (!taker.is_good || !belongs_here) {
    chunk.position = chunk.records.size();  // what follows is no better
    complain(belongs_here ? "a chunk is damaged" : "a chunk holds a record that belongs in none");
  }
  chunk.position += record.length;
  return record;
}

std::optional<RecordedMessage> McapReader::next() {
  while (!has_ended_) {
    const MessagePlace inside{chunk_.record, chunk_.position};
    if (const auto record = next_in_chunk(chunk_)) {
      if (auto message = take(*record, inside)) return message;
      continue;
    }
    const auto record = read_record(position_);
    if (!record) break;
    const MessagePlace outside{position_, 0};
    position_ += record->length;
    if (auto message = take(*record, outside)) return message;
  }
  has_ended_ = true;
  return std::nullopt;
}

RecordedMessage McapReader::at(const MessagePlace& place) {
  if (chunk_at_.record != place.record || chunk_at_.records.empty()) {
    const auto record = read_record(place.record);
    if (!record) complain("has changed while it was read");
    const auto opcode = static_cast<Opcode>(record->opcode);
    if (auto message = opcode == Opcode::message ? take(*record, place) : std::nullopt) return *message;
    if (opcode != Opcode::chunk) complain("has changed while it was read");
    chunk_at_ = {place.record, unpacked(record->content), 0};
  }
  chunk_at_.position = place.in_chunk;
  const auto record = next_in_chunk(chunk_at_);
  auto message = record ? take(*record, place) : std::nullopt;
  if (!message) complain("has changed while it was read");
  return *message;
}

}  // namespace flies
