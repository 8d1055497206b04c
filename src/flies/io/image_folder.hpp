#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flies::detail {

/// Whether a file or folder is hidden, as `.git`, `.DS_Store` and what macOS puts beside files (`._a.png`).
bool is_hidden(const std::filesystem::path& path);

/// Whether a file is an image by its extension, and not hidden.
bool is_image_name(const std::filesystem::path& path);

/// The images of a folder in name order, as `find_pairs` counts them.
/// @throws InputError when it cannot be read or holds none
std::vector<std::string> images_of(const std::string& folder);

/// @returns whether `path` is a folder. @throws InputError when it does not exist or cannot be read
bool is_folder(const std::string& path);

}  // namespace flies::detail
