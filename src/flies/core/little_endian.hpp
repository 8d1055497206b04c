#pragma once

#include <cstdint>
#include <string>

/// For writers of binary formats; not installed.

namespace flies {

/// Appends the lowest `bytes` bytes of a number, the least significant first.
inline void put_number(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>((value >> (8 * i)) & 0xFFU));
}

}  // namespace flies
