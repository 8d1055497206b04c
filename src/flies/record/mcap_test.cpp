#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/record/mcap_reader.hpp"
#include "flies/record/mcap_records.hpp"
#include "flies/record/mcap_writer.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::uint64_t kSecond_ns = 1000000000;

std::vector<RecordedMessage> messages_of(const std::string& path, bool* is_whole = nullptr) {
  McapReader reader(path);
  std::vector<RecordedMessage> messages;
  while (auto message = reader.next()) messages.push_back(std::move(*message));
  if (is_whole != nullptr) *is_whole = reader.is_whole();
  return messages;
}

void write_some(const std::string& path, int count) {
  McapWriter writer(path, {{"/a", "test.A", R"({"type":"object"})"}, {"/b", "test.B", "{}"}});
  for (int i = 0; i < count; ++i)
    writer.write(static_cast<std::size_t>(i % 2), static_cast<std::uint64_t>(i) * kSecond_ns / 4,
                 "{\"n\":" + std::to_string(i) + "}");
  writer.close();
}

TEST(Mcap, ReadsWhatWasWritten) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("t.mcap");
  write_some(path, 21);
  bool is_whole = false;
  const auto messages = messages_of(path, &is_whole);
  ASSERT_EQ(messages.size(), 21U);
  EXPECT_TRUE(is_whole);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    EXPECT_EQ(messages[i].topic, i % 2 == 0 ? "/a" : "/b");
    EXPECT_EQ(messages[i].schema_name, i % 2 == 0 ? "test.A" : "test.B");
    EXPECT_EQ(messages[i].encoding, "json");
    EXPECT_EQ(messages[i].time_ns, i * kSecond_ns / 4);
    EXPECT_EQ(messages[i].data, "{\"n\":" + std::to_string(i) + "}");
  }
}

TEST(Mcap, MessagesAreFoundAgainInAnyOrder) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("t.mcap");
  write_some(path, 30);
  McapReader reader(path);
  std::vector<RecordedMessage> messages;
  while (auto message = reader.next()) {
    messages.push_back(*message);
    EXPECT_EQ(reader.at(messages.front().place).data, messages.front().data);  // does not disturb `next`
  }
  ASSERT_EQ(messages.size(), 30U);
  for (const std::size_t i : {29U, 0U, 13U, 14U, 5U}) {
    EXPECT_EQ(reader.at(messages[i].place).data, messages[i].data);
    EXPECT_EQ(reader.at(messages[i].place).topic, messages[i].topic);
  }
}

/// The reader sets less memory aside for such a chunk at first.
TEST(Mcap, MessagesThatPackWellAreUnpacked) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("t.mcap"), data(3'000'000, 'x');
  McapWriter writer(path, {{"/a", "test.A", "{}"}});
  writer.write(0, 0, data);
  writer.close();
  ASSERT_LT(std::filesystem::file_size(path), 100'000U);
  const auto messages = messages_of(path);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_TRUE(messages[0].data == data);
}

TEST(Mcap, OneRunAtATimeWritesARecording) {
  const testing::TemporaryFolder folder;
  const auto path = folder.file("t.mcap");
  {
    McapWriter writer(path, {{"/a", "A", "{}"}});
    writer.write(0, 1, "{}");
    EXPECT_THAT(
        [&] {
          McapWriter(path, {{"/b", "B", "{}"}});
        },
        ThrowsMessage<InputError>(HasSubstr("t.mcap: another run is writing it")));
    writer.write(0, 2, "{}");
    writer.close();
  }
  EXPECT_EQ(messages_of(path).size(), 2U);
  EXPECT_NO_THROW(McapWriter(path, {{"/b", "B", "{}"}}));
}

TEST(Mcap, NoMessagesAreARecordingToo) {
  const testing::TemporaryFolder folder;
  write_some(folder.file("t.mcap"), 0);
  EXPECT_TRUE(messages_of(folder.file("t.mcap")).empty());
}

TEST(Mcap, CutOffFileIsReadToItsLastWholeChunk) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("t.mcap");
  write_some(path, 40);
  const auto size = std::filesystem::file_size(path);
  std::size_t most = 0, fewest = 40;
  for (auto cut = size; cut > 8; cut -= 7) {
    std::filesystem::resize_file(path, cut);
    bool is_whole = true;
    const auto messages = messages_of(path, &is_whole);
    for (std::size_t i = 0; i < messages.size(); ++i) ASSERT_EQ(messages[i].data, "{\"n\":" + std::to_string(i) + "}");
    most = std::max(most, messages.size());
    fewest = std::min(fewest, messages.size());
    if (messages.size() < 40) {
      EXPECT_FALSE(is_whole);
    }
  }
  EXPECT_EQ(most, 40U);
  EXPECT_EQ(fewest, 0U);
}

TEST(Mcap, DamagedFilesAreToldOrReadInPart) {
  const testing::TemporaryFolder folder;
  write_some(folder.file("t.mcap"), 10);
  const std::string good = testing::read_all(folder.file("t.mcap"));
  int told = 0;
  for (std::size_t i = 0; i < good.size(); i += 3) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    const std::string path = folder.write("bad.mcap", bad);
    try {
      messages_of(path);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("bad.mcap: "));
      ++told;
    }
  }
  EXPECT_GT(told, 10);
}

/// A damaged chunk costs what is in it, wherever it is: the end of the file says the channels again.
TEST(Mcap, DamagedChunksArePassedOver) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("t.mcap");
  write_some(path, 40);
  McapReader whole(path);
  std::map<std::uint64_t, std::size_t> messages_in;  // chunks, by their places
  while (const auto message = whole.next()) ++messages_in[message->place.record];
  ASSERT_GT(messages_in.size(), 2U);
  const std::string good = testing::read_all(path);
  for (const auto& [chunk, messages] : messages_in) {
    constexpr std::size_t kChecksum = mcap::kRecordHead + 8 + 8 + 8;
    std::string bad = good;
    bad[chunk + kChecksum] = static_cast<char>(bad[chunk + kChecksum] ^ 0x55);
    McapReader reader(folder.write("bad.mcap", bad));
    std::size_t read = 0, faults = 0;
    for (bool goes_on = true; goes_on;) {
      try {
        const auto message = reader.next();
        goes_on = message.has_value();
        if (message) {
          ++read;
          EXPECT_TRUE(message->topic == "/a" || message->topic == "/b");
        }
      } catch (const InputError& fault) {
        EXPECT_THAT(fault.what(), HasSubstr("a chunk is damaged"));
        ++faults;
      }
    }
    EXPECT_EQ(read, 40 - messages);
    EXPECT_EQ(faults, 1U);
    EXPECT_TRUE(reader.is_whole());
  }
}

/// What can be read of a recording, and the faults that were passed over.
struct WholePart {
  std::vector<RecordedMessage> messages;
  std::vector<std::string> faults;
};
WholePart whole_part_of(RecordingReader& reader) {
  WholePart part;
  while (true) {
    try {
      auto message = reader.next();
      if (!message) return part;
      part.messages.push_back(std::move(*message));
    } catch (const InputError& fault) {
      part.faults.emplace_back(fault.what());
    }
  }
}

std::string record_of(mcap::Opcode opcode, const std::string& content) {
  std::string bytes;
  mcap::put_record(bytes, opcode, content);
  return bytes;
}
std::string schema_record(std::string_view name) {
  std::string content;
  put_number(content, 1, 2);
  for (const auto text : {name, std::string_view("jsonschema"), std::string_view("{}")}) mcap::put_text(content, text);
  return record_of(mcap::Opcode::schema, content);
}
/// Of schema 1.
std::string channel_record(std::string_view topic) {
  std::string content;
  for (const int id : {1, 1}) put_number(content, static_cast<std::uint64_t>(id), 2);
  for (const auto text : {topic, std::string_view("json")}) mcap::put_text(content, text);
  put_number(content, 0, 4);
  return record_of(mcap::Opcode::channel, content);
}
std::string message_record(const std::string& data) {
  std::string content;
  put_number(content, 1, 2);
  for (const int size : {4, 8, 8}) put_number(content, 0, size);
  return record_of(mcap::Opcode::message, content + data);
}
std::string chunk_record(const std::string& records) {
  std::string content;
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{records.size()}})
    put_number(content, number, 8);
  put_number(content, 0, 4);  // no checksum
  mcap::put_text(content, "");
  put_number(content, records.size(), 8);
  return record_of(mcap::Opcode::chunk, content + records);
}
/// A file of these records, and of these again at its end.
std::string mcap_file(const std::string& records, const std::string& summary) {
  std::string bytes = std::string(mcap::kMagic) + records + record_of(mcap::Opcode::data_end, std::string(4, '\0'));
  std::string footer;
  put_number(footer, bytes.size(), 8);
  put_number(footer, 0, 8);
  put_number(footer, 0, 4);
  return bytes + summary + record_of(mcap::Opcode::footer, footer) + std::string(mcap::kMagic);
}

TEST(Mcap, WhatBelongsInNoChunkIsRefusedThere) {
  const testing::TemporaryFolder folder;
  const std::string records = schema_record("test.A") + channel_record("/a") + message_record("first");
  const std::string end = record_of(mcap::Opcode::data_end, std::string(4, '\0'));
  for (const auto& odd : {end, chunk_record(message_record("inner"))}) {
    const std::string bytes = chunk_record(records + odd + records) + chunk_record(message_record("last"));
    McapReader reader(folder.write("t.mcap", mcap_file(bytes, "")));
    const auto part = whole_part_of(reader);
    EXPECT_THAT(part.faults, ::testing::ElementsAre(HasSubstr("a chunk holds a record that belongs in none")));
    ASSERT_EQ(part.messages.size(), 2U);
    EXPECT_EQ(part.messages[1].data, "last");
    EXPECT_TRUE(reader.is_whole());
  }
  const std::string unknown = record_of(static_cast<mcap::Opcode>(0x7F), "?");
  McapReader reader(folder.write("t.mcap", mcap_file(chunk_record(records + unknown + message_record("last")), "")));
  EXPECT_EQ(whole_part_of(reader).messages.size(), 2U);
}

TEST(Mcap, TheEndOfTheFileSaysSchemasAndChannelsThatAreDamaged) {
  const testing::TemporaryFolder folder;
  const std::string schema = schema_record("test.A"), channel = channel_record("/a"), message = message_record("m");
  const auto cut = [](mcap::Opcode opcode) { return record_of(opcode, "\1"); };
  const std::string cut_schema = cut(mcap::Opcode::schema), cut_channel = cut(mcap::Opcode::channel);
  const auto check = [&](const std::string& records, const std::string& summary, std::size_t faults) {
    McapReader reader(folder.write("t.mcap", mcap_file(records + message, summary)));
    const auto part = whole_part_of(reader);
    EXPECT_EQ(part.faults.size(), faults);
    ASSERT_EQ(part.messages.size(), 1U);
    EXPECT_EQ(part.messages[0].topic, "/a");
    EXPECT_EQ(part.messages[0].schema_name, "test.A");
    EXPECT_EQ(reader.at(part.messages[0].place).data, "m");
  };
  check(channel, schema + channel, 0);
  check(channel + schema, "", 0);
  check(schema + channel + cut_schema + cut_channel, "", 2);
  check(cut_schema + cut_channel, cut_schema + cut_channel + schema + channel, 2);
}

/// The beginning of a recording, a record of a tebibyte of which nothing is stored, and the rest.
void write_with_huge_record(const std::string& path, const std::string& good, mcap::Opcode opcode) {
  constexpr std::uint64_t kLength = std::uint64_t{1} << 40U;
  std::string head;
  put_number(head, static_cast<std::uint8_t>(opcode), 1);
  put_number(head, kLength, 8);
  std::ofstream file(path, std::ios::binary);
  file << good.substr(0, mcap::kMagic.size()) << head;
  file.seekp(static_cast<std::streamoff>(kLength), std::ios::cur);
  file << good.substr(mcap::kMagic.size());
}

TEST(Mcap, HugeRecordsAreNotTakenIntoMemory) {
  const testing::TemporaryFolder folder;
  write_some(folder.file("t.mcap"), 10);
  const std::string good = testing::read_all(folder.file("t.mcap")), path = folder.file("huge.mcap");
  constexpr auto kAttachment = static_cast<mcap::Opcode>(0x09);
  write_with_huge_record(path, good, kAttachment);
  std::error_code error;
  if (std::filesystem::file_size(path, error) < std::uint64_t{1} << 40U)
    GTEST_SKIP() << "this file system has no files of a tebibyte";
  bool is_whole = false;
  EXPECT_EQ(messages_of(path, &is_whole).size(), 10U);
  EXPECT_TRUE(is_whole);

  write_with_huge_record(path, good, mcap::Opcode::chunk);
  EXPECT_EQ(messages_of(path, &is_whole).size(), 0U);
  EXPECT_FALSE(is_whole);
}

TEST(Mcap, OtherFilesAreRefused) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("t.mcap", "no recording at all");
  EXPECT_THAT([&] { McapReader{path}; }, ThrowsMessage<InputError>(HasSubstr("t.mcap: is no MCAP recording")));
  EXPECT_THAT([&] { McapReader{folder.file("absent.mcap")}; }, ThrowsMessage<InputError>(HasSubstr("cannot be read")));
  EXPECT_THAT([&] { McapWriter(folder.file("no/t.mcap"), {}); }, ThrowsMessage<InputError>(HasSubstr("cannot write")));
}

TEST(Mcap, FullDiskIsTold) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  EXPECT_THAT(
      [] {
        McapWriter("/dev/full", {{"/a", "A", "{}"}});
      },
      ThrowsMessage<InputError>(HasSubstr("/dev/full: cannot write")));
}

/// Files may grow to this many bytes while it lives: what does not fit is refused as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(Mcap, ARecordingThatFailedIsToldUntilItIsClosed) {
  const testing::TemporaryFolder folder;
  const FileSizeLimit limit(1000);
  McapWriter writer(folder.file("t.mcap"), {{"/a", "A", "{}"}});
  std::string noise(4000, ' ');  // that does not pack into the rest of the file
  std::uint32_t state = 1;
  for (char& c : noise) c = static_cast<char>((state = state * 1664525U + 1013904223U) >> 24U);
  const auto fails = ThrowsMessage<InputError>(HasSubstr("t.mcap: cannot write"));
  writer.write(0, 0, noise);
  EXPECT_THAT([&] { writer.write(0, 2 * kSecond_ns, noise); }, fails);
  EXPECT_THAT([&] { writer.write(0, 3 * kSecond_ns, noise); }, fails);
  EXPECT_THAT([&] { writer.close(); }, fails);
  EXPECT_THAT([&] { writer.close(); }, fails);
}

}  // namespace
}  // namespace flies
