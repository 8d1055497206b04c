#include "flies/io/exif.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "flies/io/image_file.hpp"

namespace flies::detail {
namespace {

using namespace std::string_view_literals;

constexpr int kAsSeen = 1;

/// Unsigned numbers of either byte order; nothing behind the end.
struct Numbers {
  std::string_view bytes;
  bool is_big_endian = true;

  std::optional<std::uint64_t> at(std::uint64_t offset, std::size_t count) const {
    if (offset > bytes.size() || count > bytes.size() - offset) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t from = is_big_endian ? i : count - 1 - i;
      value = value << 8 | static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(offset) + from]);
    }
    return value;
  }
};

/// How wide the numbers of a directory are: classic TIFF, or Big TIFF.
struct Widths {
  std::size_t offset, entries, entry, value_at;
};

/// The orientation in the first directory of a TIFF file, of which EXIF data are one.
int orientation_of_tiff(std::string_view bytes) {
  constexpr std::uint64_t kOrientation = 0x0112, kBigTiff = 43;
  const Numbers numbers{bytes, bytes.starts_with("MM")};
  const bool is_big = numbers.at(2, 2) == kBigTiff;
  const Widths widths = is_big ? Widths{8, 8, 20, 12} : Widths{4, 2, 12, 8};
  const auto directory = numbers.at(is_big ? 8 : 4, widths.offset);
  if (!directory) return kAsSeen;
  const auto entries = numbers.at(*directory, widths.entries);
  if (!entries) return kAsSeen;
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(*entries, 1 << 12); ++i) {
    const std::uint64_t entry = *directory + widths.entries + i * widths.entry;
    const auto tag = numbers.at(entry, 2);
    if (!tag) return kAsSeen;
    if (*tag != kOrientation) continue;
    const auto value = numbers.at(entry + widths.value_at, 2);  // a short, at the front of its field
    return value && *value >= 1 && *value <= 8 ? static_cast<int>(*value) : kAsSeen;
  }
  return kAsSeen;
}

/// The EXIF data of a JPEG file, before its pixels; empty when there are none.
std::string_view exif_of_jpeg(std::string_view bytes) {
  constexpr std::uint64_t kApplication1 = 0xE1, kStartOfScan = 0xDA, kFill = 0xFF;
  constexpr auto kName = "Exif\0\0"sv;
  const Numbers numbers{bytes};
  for (std::size_t at = 2; numbers.at(at, 1) == 0xFF;) {
    const auto marker = numbers.at(at + 1, 1);
    if (marker == kFill) {
      ++at;
      continue;
    }
    const auto length = numbers.at(at + 2, 2);
    if (!marker || !length || *length < 2 || marker == kStartOfScan) break;
    const auto data = bytes.substr(at + 4, static_cast<std::size_t>(*length) - 2);
    if (marker == kApplication1 && data.starts_with(kName)) return data.substr(kName.size());
    at += 2 + static_cast<std::size_t>(*length);
    if (at >= bytes.size()) break;
  }
  return {};
}

/// The data of the first chunk of that name; empty when there is none.
/// @param first where the chunks begin
/// @param is_png length, name, data, checksum, big-endian; else of RIFF: name, length, data padded to even length
std::string_view chunk_of(std::string_view bytes, std::string_view name, std::size_t first, bool is_png) {
  const Numbers numbers{bytes, is_png};
  for (std::size_t at = first; at < bytes.size();) {
    const auto length = numbers.at(at + (is_png ? 0 : 4), 4);
    if (!length || at + 8 > bytes.size()) return {};
    const auto size = static_cast<std::size_t>(*length);
    if (bytes.substr(at + (is_png ? 4 : 0), 4) == name) return bytes.substr(at + 8, size);
    at += 8 + size + (is_png ? 4 : size % 2);
  }
  return {};
}

std::string_view exif_of_webp(std::string_view bytes) {
  constexpr auto kName = "Exif\0\0"sv;  // which some programs write here, too
  const auto data = chunk_of(bytes, "EXIF", 12, false);
  return data.starts_with(kName) ? data.substr(kName.size()) : data;
}

}  // namespace

int stored_orientation(std::string_view bytes) {
  switch (image_file_kind(bytes)) {
    case ImageFileKind::jpeg:
      return orientation_of_tiff(exif_of_jpeg(bytes));
    case ImageFileKind::png:
      return orientation_of_tiff(chunk_of(bytes, "eXIf", 8, true));
    case ImageFileKind::webp:
      return orientation_of_tiff(exif_of_webp(bytes));
    case ImageFileKind::tiff:
      return orientation_of_tiff(bytes);
    case ImageFileKind::pnm:
    case ImageFileKind::bmp:
    case ImageFileKind::unknown:
      break;
  }
  return kAsSeen;
}

cv::Mat turned(const cv::Mat& stored, int orientation) {
  constexpr int kAboutBothAxes = -1, kUpsideDown = 0, kMirrored = 1;
  cv::Mat seen = stored;
  if (orientation >= 5) cv::transpose(stored, seen);
  switch (orientation) {
    case 2:
    case 6:
      cv::flip(seen, seen, kMirrored);
      break;
    case 3:
    case 7:
      cv::flip(seen, seen, kAboutBothAxes);
      break;
    case 4:
    case 8:
      cv::flip(seen, seen, kUpsideDown);
      break;
    default:
      break;
  }
  return seen;
}

}  // namespace flies::detail
