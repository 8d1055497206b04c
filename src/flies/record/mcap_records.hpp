#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "flies/core/little_endian.hpp"

/// What MCAP files (https://mcap.dev/spec) are made of; not installed. All numbers are little-endian.
namespace flies::mcap {

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::size_t kRecordHead = 1 + 8;  ///< opcode and length

inline void put_text(std::string& out, std::string_view text) {
  put_number(out, text.size(), 4);
  out += text;
}
inline void put_record(std::string& out, Opcode opcode, std::string_view content) {
  put_number(out, static_cast<std::uint8_t>(opcode), 1);
  put_number(out, content.size(), 8);
  out += content;
}
/// A map from 16 to 64 bits, by its length in bytes.
inline void put_map(std::string& out, const std::map<std::uint16_t, std::uint64_t>& map) {
  put_number(out, map.size() * 10, 4);
  for (const auto& [key, value] : map) {
    put_number(out, key, 2);
    put_number(out, value, 8);
  }
}

}  // namespace flies::mcap
