#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace flies {

/// Bytes as text (RFC 4648, with padding).
std::string to_base64(std::string_view bytes);
std::string to_base64(std::span<const std::uint8_t> bytes);

/// The bytes; empty when `text` is not what `to_base64` writes.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace flies
