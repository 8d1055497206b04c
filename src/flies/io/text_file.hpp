#pragma once

#include <cstddef>
#include <string>

namespace flies {

/// The bytes of a file.
/// @throws InputError naming `path` when it is missing, a folder, unreadable, empty or larger than `max_bytes`
std::string read_file(const std::string& path, std::size_t max_bytes);

/// Text as UTF-8 without a byte order mark and with '\n' at the ends of lines. UTF-16 is known by its mark, or by the
/// zero byte beside its first letter; other bytes stay as they are.
std::string plain_text(const std::string& bytes);

}  // namespace flies
