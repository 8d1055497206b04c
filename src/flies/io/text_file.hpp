#pragma once

#include <cstddef>
#include <string>

namespace flies {

/// The bytes of a file.
/// @throws InputError naming `path` when it is missing, a folder, unreadable, empty or larger than `max_bytes`
std::string read_file(const std::string& path, std::size_t max_bytes);

}  // namespace flies
