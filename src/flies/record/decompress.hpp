#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace flies {

/// Larger chunks are taken for damaged ones.
inline constexpr std::uint64_t kLargestChunk_bytes = 1ULL << 30;

/// The ways in which chunks of recordings are compressed, as both formats call them.
inline constexpr std::string_view kCompressions = "none, zstd, lz4 or bz2";
bool is_known_compression(std::string_view name);

/// @param name of a known compression
/// @param size that the result must have
/// @returns nothing when the bytes are damaged
std::optional<std::string> decompress(std::string_view name, std::string_view bytes, std::uint64_t size);

}  // namespace flies
