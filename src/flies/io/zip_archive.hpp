#pragma once

#include <span>
#include <string>

namespace flies {

struct ZipEntry {
  std::string name;  ///< "folder/file.txt"
  std::string bytes;
};

/// A ZIP archive of these files, not compressed: pictures are already. Together below 4 GB.
std::string zip_archive(std::span<const ZipEntry> entries);

}  // namespace flies
