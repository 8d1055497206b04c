#pragma once

#include <cstddef>
#include <string>

namespace flies {

/// The bytes of a file, none of an empty one: a picture without labels, a scan without returns.
/// @throws InputError naming `path` when it is missing, a folder, unreadable or larger than `max_bytes`
std::string read_bytes(const std::string& path, std::size_t max_bytes);

/// The same of a file that must not be empty. @throws InputError as `read_bytes`, when it is, and when it is
/// compressed by gzip
std::string read_file(const std::string& path, std::size_t max_bytes);

/// Text as UTF-8 without a byte order mark and with '\n' at the ends of lines. UTF-16 is known by its mark, or by the
/// zero byte beside its first letter, UTF-32 by its mark; other bytes stay as they are.
std::string plain_text(const std::string& bytes);

}  // namespace flies
