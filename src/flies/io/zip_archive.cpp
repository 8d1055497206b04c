#include "flies/io/zip_archive.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "flies/core/error.hpp"
#include "flies/core/little_endian.hpp"
#include "flies/io/crc32.hpp"

namespace flies {
namespace {

constexpr std::uint16_t kVersion = 20, kUtf8Names = 0x0800, kStored = 0, kFirstOf1980 = 0x0021;
constexpr std::size_t kHeader = 30;  // bytes before a name

/// What the header before a file and its line in the directory share.
void put_description(std::string& out, const ZipEntry& entry) {
  put_number(out, kVersion, 2);
  put_number(out, kUtf8Names, 2);
  put_number(out, kStored, 2);
  put_number(out, 0, 2);  // midnight
  put_number(out, kFirstOf1980, 2);
  put_number(out, crc32(entry.bytes), 4);
  put_number(out, entry.bytes.size(), 4);
  put_number(out, entry.bytes.size(), 4);
  put_number(out, entry.name.size(), 2);
  put_number(out, 0, 2);  // no extra field
}

}  // namespace

std::string zip_archive(std::span<const ZipEntry> entries) {
  constexpr std::size_t kLongest = std::numeric_limits<std::uint32_t>::max(),
                        kMost = std::numeric_limits<std::uint16_t>::max();
  if (entries.size() > kMost)
    throw InputError("zip archive", "", fmt::format("found {} files, expected at most {}", entries.size(), kMost));
  std::string archive, directory;
  for (const auto& entry : entries) {
    if (entry.name.size() > kMost || archive.size() + entry.bytes.size() + entry.name.size() > kLongest - kHeader)
      throw InputError("zip archive", entry.name.substr(0, 100), "is too long, or the files together are 4 GB or more");
    const std::size_t offset = archive.size();
    put_number(archive, 0x04034B50, 4);
    put_description(archive, entry);
    archive += entry.name;
    archive += entry.bytes;

    put_number(directory, 0x02014B50, 4);
    put_number(directory, kVersion, 2);
    put_description(directory, entry);
    put_number(directory, 0, 2);  // no comment
    put_number(directory, 0, 2);  // the only disk
    put_number(directory, 0, 2);  // no text known as such
    put_number(directory, 0, 4);  // no attributes
    put_number(directory, offset, 4);
    directory += entry.name;
  }
  const std::size_t offset = archive.size();
  archive += directory;
  put_number(archive, 0x06054B50, 4);
  put_number(archive, 0, 2);
  put_number(archive, 0, 2);
  put_number(archive, entries.size(), 2);
  put_number(archive, entries.size(), 2);
  put_number(archive, directory.size(), 4);
  put_number(archive, offset, 4);
  put_number(archive, 0, 2);
  return archive;
}

}  // namespace flies
