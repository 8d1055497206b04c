#include <bzlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sys/resource.h>

#include <fstream>
#include <map>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/record/bag_reader.hpp"
#include "flies/record/ros_bytes.hpp"

namespace flies {
namespace {

using testing::BagBytes;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::uint64_t kSecond_ns = 1'000'000'000U;

std::string lz4(const std::string& bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

std::string bz2(std::string bytes) {
  std::string packed(bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()), 9, 0, 0);
  packed.resize(size);
  return packed;
}

/// Two chunks of three messages, the second one packed as told.
std::string bag(const std::string& compression, std::string (*pack)(std::string)) {
  const auto records = [](int first) {
    std::string own = BagBytes::connection(0, "/a", "std_msgs/A") + BagBytes::connection(1, "/b", "std_msgs/B");
    for (int i = first; i < first + 3; ++i)
      own += BagBytes::message({static_cast<std::uint32_t>(i % 2), static_cast<std::uint64_t>(i) * kSecond_ns / 2,
                                "message " + std::to_string(i)});
    return own;
  };
  const std::string first = records(0), second = records(3);
  return BagBytes::start() + BagBytes::chunk("none", first, first.size()) +
         BagBytes::record(0x04, BagBytes::field("ver", "\1"), "index") +
         BagBytes::chunk(compression, pack(second), second.size()) + BagBytes::record(0x06, "", "");
}

std::string same(std::string bytes) { return bytes; }
std::string lz4_copy(std::string bytes) { return lz4(bytes); }

std::string write(const testing::TemporaryFolder& folder, const std::string& bytes) {
  const std::string path = folder.file("t.bag");
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::vector<RecordedMessage> messages_of(RecordingReader& reader) {
  std::vector<RecordedMessage> messages;
  while (auto message = reader.next()) messages.push_back(std::move(*message));
  return messages;
}

TEST(Bag, MessagesAreReadInOrderWhateverTheCompression) {
  const testing::TemporaryFolder folder;
  for (const auto& bytes : {bag("none", same), bag("lz4", lz4_copy), bag("bz2", bz2)}) {
    const auto reader = open_recording(write(folder, bytes));
    const auto messages = messages_of(*reader);
    ASSERT_EQ(messages.size(), 6U);
    EXPECT_TRUE(reader->is_whole());
    for (std::size_t i = 0; i < messages.size(); ++i) {
      EXPECT_EQ(messages[i].topic, i % 2 == 0 ? "/a" : "/b");
      EXPECT_EQ(messages[i].schema_name, i % 2 == 0 ? "std_msgs/A" : "std_msgs/B");
      EXPECT_EQ(messages[i].encoding, "ros1");
      EXPECT_EQ(messages[i].time_ns, i * kSecond_ns / 2);
      EXPECT_EQ(messages[i].data, "message " + std::to_string(i));
    }
    for (const std::size_t i : {5U, 0U, 4U, 1U}) EXPECT_EQ(reader->at(messages[i].place).data, messages[i].data);
  }
}

TEST(Bag, WhatIsCutOffIsReadAsFarAsItIsWhole) {
  const testing::TemporaryFolder folder;
  const std::string bytes = bag("none", same);
  BagReader reader(write(folder, bytes.substr(0, bytes.size() - 40)));
  EXPECT_EQ(messages_of(reader).size(), 3U);
  EXPECT_FALSE(reader.is_whole());
}

TEST(Bag, WhatStandsInItsPlaceIsNamed) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"t.bag", "t.mcap"}) {
    const auto path = folder.write(name, "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
    EXPECT_THAT([&] { open_recording(path); }, ThrowsMessage<InputError>(HasSubstr("git lfs pull"))) << name;
  }
}

TEST(Bag, FaultsAreTold) {
  const testing::TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) {
    BagReader reader(write(folder, bytes));
    messages_of(reader);
  };
  EXPECT_THAT([&] { read("#ROSBAG V1.2\n"); }, ThrowsMessage<InputError>(HasSubstr("is no bag of ROS 1, format 2.0")));
  EXPECT_THAT([&] { read(bag("zip", same)); },
              ThrowsMessage<InputError>(HasSubstr("compressed with 'zip', expected none, zstd, lz4 or bz2")));
  EXPECT_THAT([&] { read(bag("lz4", same)); }, ThrowsMessage<InputError>(HasSubstr("a chunk is damaged")));
  EXPECT_THAT([&] { read(bag("bz2", lz4_copy)); }, ThrowsMessage<InputError>(HasSubstr("a chunk is damaged")));
  EXPECT_THAT(
      [&] {
        read(BagBytes::start() + BagBytes::message({9, 0, "x"}));
      },
      ThrowsMessage<InputError>(HasSubstr("messages of connections that it does not describe")));
}

/// Messages that are read, and faults that were passed over.
std::pair<std::vector<RecordedMessage>, std::vector<std::string>> whole_part_of(RecordingReader& reader) {
  std::vector<RecordedMessage> messages;
  std::vector<std::string> faults;
  while (true) {
    try {
      auto message = reader.next();
      if (!message) return {messages, faults};
      messages.push_back(std::move(*message));
    } catch (const InputError& fault) {
      faults.emplace_back(fault.what());
    }
  }
}

TEST(Bag, WhatIsDamagedIsPassedOver) {
  const testing::TemporaryFolder folder;
  const std::string records = BagBytes::connection(0, "/a", "std_msgs/A") + BagBytes::message({0, 0, "first"});
  const std::string more = BagBytes::message({0, kSecond_ns, "second"});
  const std::string bad_chunk = BagBytes::chunk("lz4", records, records.size());
  const std::string bad_record = BagBytes::number(std::uint32_t{3}) + "odd" + BagBytes::number(std::uint32_t{0});
  const std::string good_chunk = BagBytes::chunk("none", more, more.size());
  const std::size_t index = BagBytes::start().size() + bad_chunk.size() + bad_record.size() + good_chunk.size();
  BagReader reader(write(folder, BagBytes::start(index) + bad_chunk + bad_record + good_chunk +
                                     BagBytes::connection(0, "/a", "std_msgs/A")));
  const auto [messages, faults] = whole_part_of(reader);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].topic, "/a");
  EXPECT_EQ(messages[0].data, "second");
  EXPECT_EQ(reader.at(messages[0].place).data, "second");
  EXPECT_THAT(faults, ::testing::ElementsAre(HasSubstr("a chunk is damaged"), HasSubstr("a record is damaged")));
}

std::string chunk_of(const std::string& records) { return BagBytes::chunk("none", records, records.size()); }

TEST(Bag, WhatBelongsInNoChunkIsRefusedThere) {
  const testing::TemporaryFolder folder;
  const std::string records = BagBytes::connection(0, "/a", "std_msgs/A") + BagBytes::message({0, 0, "first"});
  const std::string inner = chunk_of(BagBytes::message({0, 0, "inner"}));
  const std::string last = chunk_of(BagBytes::message({0, kSecond_ns, "last"}));
  const std::string header = BagBytes::start().substr(std::string("#ROSBAG V2.0\n").size());
  for (const auto& odd : {inner, header}) {
    BagReader reader(write(folder, BagBytes::start() + chunk_of(records + odd + records) + last));
    const auto [messages, faults] = whole_part_of(reader);
    ASSERT_EQ(messages.size(), 2U);
    for (const auto& message : messages) EXPECT_EQ(reader.at(message.place).data, message.data);
    EXPECT_EQ(messages[1].data, "last");
    EXPECT_THAT(faults, ::testing::ElementsAre(HasSubstr("a chunk holds a record that belongs in none")));
  }
}

TEST(Bag, MessagesOutsideOfChunksAreFoundAgain) {
  const testing::TemporaryFolder folder;
  const std::string connection = BagBytes::connection(0, "/a", "std_msgs/A");
  BagReader reader(write(folder, BagBytes::start() + connection + BagBytes::message({0, 0, "first"}) +
                                     chunk_of(BagBytes::message({0, 1, "second"})) +
                                     BagBytes::message({0, 2, "third"})));
  const auto messages = messages_of(reader);
  ASSERT_EQ(messages.size(), 3U);
  for (const std::size_t i : {2U, 1U, 0U}) EXPECT_EQ(reader.at(messages[i].place).data, messages[i].data);
}

TEST(Bag, ABadConnectionAtTheEndCostsNoOther) {
  const testing::TemporaryFolder folder;
  const std::string chunk = chunk_of(BagBytes::message({0, 0, "first"}));
  const std::string bad = BagBytes::record(0x07, BagBytes::field("conn", BagBytes::number(std::uint32_t{1})), "odd");
  BagReader reader(write(folder, BagBytes::start(BagBytes::start().size() + chunk.size()) + chunk + bad +
                                     BagBytes::connection(0, "/a", "std_msgs/A")));
  const auto [messages, faults] = whole_part_of(reader);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].topic, "/a");
  EXPECT_THAT(faults, ::testing::ElementsAre(HasSubstr("a connection is damaged")));
}

/// The most memory that this process ever had.
long most_memory_kb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(Bag, DamagedChunksTakeNoMoreMemoryThanTheyUnpackTo) {
  constexpr std::size_t kClaimed_bytes = 1U << 30U;
  constexpr long kMost_kb = 200'000;
  const testing::TemporaryFolder folder;
  const std::string zstd("\x28\xB5\x2F\xFDrubbish");
  const long before_kb = most_memory_kb();
  for (const auto& [compression, packed] : std::map<std::string, std::vector<std::string>>{
           {"zstd", {zstd, "rubbish"}}, {"lz4", {lz4("short"), "rubbish"}}, {"bz2", {bz2("short"), "rubbish"}}})
    for (const auto& bytes : packed) {
      BagReader reader(write(folder, BagBytes::start() + BagBytes::chunk(compression, bytes, kClaimed_bytes)));
      EXPECT_THAT(whole_part_of(reader).second, ::testing::ElementsAre(HasSubstr("a chunk is damaged")));
    }
  EXPECT_LT(most_memory_kb() - before_kb, kMost_kb);
}

/// More than is set aside at first.
TEST(Bag, ChunksThatPackWellAreUnpacked) {
  const testing::TemporaryFolder folder;
  const std::string data(3'000'000, 'x');
  const std::string records = BagBytes::connection(0, "/a", "std_msgs/A") + BagBytes::message({0, 0, data});
  for (const auto& [compression, packed] :
       std::map<std::string, std::string>{{"lz4", lz4(records)}, {"bz2", bz2(records)}}) {
    for (const int more : {-1, 0, 1}) {
      const std::size_t size = records.size() + static_cast<std::size_t>(more);
      BagReader reader(write(folder, BagBytes::start() + BagBytes::chunk(compression, packed, size)));
      const auto messages = whole_part_of(reader).first;
      ASSERT_EQ(messages.size(), more == 0 ? 1U : 0U) << compression << more;
      if (more == 0) {
        EXPECT_TRUE(messages[0].data == data);
      }
    }
  }
}

/// Whatever byte is another, the reader ends, with its own error or with what it understood.
TEST(Bag, DamagedBytesNeverCrash) {
  const testing::TemporaryFolder folder;
  const std::string good = bag("lz4", lz4_copy);
  for (std::size_t i = 13; i < good.size(); i += 3) {
    std::string bytes = good;
    bytes[i] = static_cast<char>(bytes[i] ^ 0x5A);
    BagReader reader(write(folder, bytes));
    EXPECT_LE(whole_part_of(reader).first.size(), 6U);
  }
}

}  // namespace
}  // namespace flies
