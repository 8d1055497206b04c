#include "flies/record/bag_reader.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/record/byte_taker.hpp"
#include "flies/record/decompress.hpp"

namespace flies {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
enum Operation : std::uint8_t { kMessage = 0x02, kBagHeader = 0x03, kChunk = 0x05, kConnection = 0x07 };

/// `name=value` after its length, one after the other.
std::optional<std::map<std::string, std::string, std::less<>>> fields_of(std::string_view header) {
  std::map<std::string, std::string, std::less<>> fields;
  ByteTaker taker(header);
  while (taker.left() > 0) {
    const std::string field = taker.text();
    const auto equal = field.find('=');
    if (!taker.is_good || equal == std::string::npos) return std::nullopt;
    fields[field.substr(0, equal)] = field.substr(equal + 1);
  }
  return fields;
}

}  // namespace

std::uint64_t BagReader::Record::number(std::string_view field) const {
  const auto found = fields.find(field);
  if (found == fields.end() || found->second.size() > 8) return 0;
  return ByteTaker(found->second).number(static_cast<int>(found->second.size()));
}

std::string BagReader::Record::text(std::string_view field) const {
  const auto found = fields.find(field);
  return found == fields.end() ? std::string() : found->second;
}

void BagReader::complain(const std::string& what) const { throw InputError(path_, "", what); }

BagReader::BagReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code error;
  size_ = std::filesystem::file_size(path, error);
  if (!file_ || error) complain("cannot be read");
  std::string magic(kMagic.size(), '\0');
  if (!file_.read(magic.data(), static_cast<std::streamsize>(magic.size())) || magic != kMagic)
    complain("is no bag of ROS 1, format 2.0");
  position_ = magic.size();
}

/// Nothing where the file ends before the record does, and where a part of it is longer than any can be.
std::optional<BagReader::Record> BagReader::read_record(std::uint64_t position) {
  constexpr std::size_t kLength = 4;
  Record record;
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  const auto part = [&]() -> std::optional<std::string> {
    std::string head(kLength, '\0');
    if (size_ - position < record.length + kLength || !file_.read(head.data(), kLength)) return std::nullopt;
    const std::uint64_t length = ByteTaker(head).number(kLength);
    record.length += kLength;
    if (length > size_ - position - record.length || length > kLargestChunk_bytes) return std::nullopt;
    std::string content(length, '\0');
    if (!file_.read(content.data(), static_cast<std::streamsize>(length))) return std::nullopt;
    record.length += length;
    return content;
  };
  const auto header = part();
  if (!header) return std::nullopt;
  auto data = part();
  if (!data) return std::nullopt;
  record.fields = fields_of(*header).value_or(decltype(record.fields){});
  record.data = std::move(*data);
  return record;
}

std::optional<BagReader::Record> BagReader::next_in_chunk(Chunk& own) const {
  if (own.position >= own.records.size()) return std::nullopt;
  ByteTaker taker(std::string_view(own.records).substr(own.position));
  const std::size_t before = taker.left();
  auto fields = fields_of(taker.text());
  Record record;
  record.data = taker.text();
  record.length = before - taker.left();
  if (!taker.is_good || !fields) {
    own.position = own.records.size();  // what follows is no better
    complain("a chunk is damaged");
  }
  record.fields = std::move(*fields);
  const std::uint64_t operation = record.number("op");
  if (!record.fields.empty() && operation != kConnection && operation != kMessage) {
    own.position = own.records.size();
    complain("a chunk holds a record that belongs in none");
  }
  own.position += record.length;
  return record;
}

std::string BagReader::unpacked(const Record& record) const {
  const std::string compression = record.text("compression");
  if (!is_known_compression(compression))
    complain(fmt::format("chunks are compressed with '{}', expected {}", compression, kCompressions));
  auto records = decompress(compression, record.data, record.number("size"));
  if (!records) complain("a chunk is damaged");
  return std::move(*records);
}

/// The connection of a message. Where the chunk that says it is damaged, the end of the file says it again.
/// @returns nothing when it does not, either
/// @throws InputError the first time
const BagReader::Connection* BagReader::connection(std::uint64_t id) {
  if (!connections_.contains(id) && !has_read_index_) read_index();
  const auto found = connections_.find(id);
  if (found != connections_.end()) return &found->second;
  if (!std::exchange(has_told_unknown_connections_, true))
    complain("there are messages of connections that it does not describe");
  return nullptr;
}

void BagReader::read_index() {
  has_read_index_ = true;
  for (std::uint64_t at = index_; at >= kMagic.size() && at < size_;) {
    const auto record = read_record(at);
    if (!record) return;
    if (record->number("op") == kConnection) take_connection(*record);
    at += record->length;
  }
}

/// @returns whether it is whole
bool BagReader::take_connection(const Record& record) {
  const auto fields = fields_of(record.data);
  if (!fields || !fields->contains("type")) return false;
  connections_[record.number("conn")] = {record.text("topic"), fields->at("type")};
  return true;
}

std::optional<RecordedMessage> BagReader::take(const Record& record, const MessagePlace& place) {
  if (record.fields.empty()) complain("a record is damaged");
  switch (record.number("op")) {
    case kBagHeader:
      index_ = record.number("index_pos");
      break;
    case kConnection:
      if (!take_connection(record)) complain("a connection is damaged");
      break;
    case kMessage: {
      const Connection* own = connection(record.number("conn"));
      if (own == nullptr) break;
      const std::uint64_t time = record.number("time");
      const std::uint64_t time_ns = (time & 0xFFFFFFFFU) * 1'000'000'000U + (time >> 32);
      return RecordedMessage{own->topic, own->type, "ros1", time_ns, record.data, place};
    }
    case kChunk:
      chunk_ = {place.record, unpacked(record), 0};
      break;
    default:
      break;
  }
  return std::nullopt;
}

std::optional<RecordedMessage> BagReader::next() {
  while (true) {
    const MessagePlace inside{chunk_.record, chunk_.position};
    if (const auto record = next_in_chunk(chunk_)) {
      if (auto found = take(*record, inside)) return found;
      continue;
    }
    if (position_ >= size_) {
      is_whole_ = index_ != 0;
      return std::nullopt;
    }
    const auto record = read_record(position_);
    if (!record) return std::nullopt;
    const MessagePlace outside{position_, 0};
    position_ += record->length;
    if (auto found = take(*record, outside)) return found;
  }
}

RecordedMessage BagReader::at(const MessagePlace& place) {
  if (chunk_at_.record != place.record || chunk_at_.records.empty()) {
    const auto record = read_record(place.record);
    const std::uint64_t operation = record ? record->number("op") : 0;
    if (auto message = operation == kMessage ? take(*record, place) : std::nullopt) return *message;
    if (!record || operation != kChunk) complain("has changed while it was read");
    chunk_at_ = {place.record, unpacked(*record), 0};
  }
  chunk_at_.position = place.in_chunk;
  const auto record = next_in_chunk(chunk_at_);
  auto found = record ? take(*record, place) : std::nullopt;
  if (!found) complain("has changed while it was read");
  return *found;
}

}  // namespace flies
