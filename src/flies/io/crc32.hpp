#pragma once

#include <cstdint>
#include <string_view>

namespace flies {

/// The checksum of ZIP, PNG and MCAP (ISO 3309). @param seed that of the bytes before
std::uint32_t crc32(std::string_view bytes, std::uint32_t seed = 0);

}  // namespace flies
