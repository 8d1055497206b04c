#pragma once

#include <span>
#include <string>

namespace flies {

struct ZipEntry {
  std::string name;  ///< "folder/file.txt"
  std::string bytes;
};

/// A ZIP archive of these files, not compressed: pictures are already.
/// @throws InputError when they are 4 GB or more together, or more than 65,535
std::string zip_archive(std::span<const ZipEntry> entries);

}  // namespace flies
