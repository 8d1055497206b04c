#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace flies {

/// The checksum of ZIP, PNG and others. @param seed that of the bytes before
std::uint32_t crc32(std::string_view bytes, std::uint32_t seed = 0);

struct ZipEntry {
  std::string name;  ///< "folder/file.txt"
  std::string bytes;
};

/// A ZIP archive of these files, not compressed: pictures are already. Together below 4 GB.
std::string zip_archive(std::span<const ZipEntry> entries);

}  // namespace flies
