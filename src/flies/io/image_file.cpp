#include "flies/io/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "flies/io/crc32.hpp"

namespace flies::detail {
namespace {

using namespace std::string_view_literals;

constexpr auto kPngSignature = "\x89PNG\r\n\x1a\n"sv;
const std::string kTruncated = "is truncated";
const std::string kDamaged = "is damaged";

std::uint8_t byte_at(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }

std::uint32_t big_endian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | byte_at(bytes, at + static_cast<std::size_t>(i));
  return value;
}

std::string png_fault(std::string_view bytes) {
  constexpr std::size_t kFrame = 12;  // length, type and checksum around the data of a chunk
  for (std::size_t at = kPngSignature.size(); bytes.size() - at >= kFrame;) {
    const std::size_t length = big_endian(bytes, at, 4);
    if (length > bytes.size() - at - kFrame) return kTruncated;
    if (crc32(bytes.substr(at + 4, length + 4)) != big_endian(bytes, at + 8 + length, 4)) return kDamaged;
    if (bytes.substr(at + 4, 4) == "IEND") return {};
    at += kFrame + length;
  }
  return kTruncated;
}

std::string jpeg_fault(std::string_view bytes) {
  constexpr std::uint8_t kStuffed = 0x00, kFirstRestart = 0xD0, kLastRestart = 0xD7, kEnd = 0xD9, kFill = 0xFF;
  std::size_t at = 2;  // behind the start of image
  while (true) {
    // Skip entropy-coded data (none between the first segments) up to the next marker.
    at = bytes.find('\xFF', at);
    if (at == std::string_view::npos || at + 1 >= bytes.size()) return kTruncated;
    const std::uint8_t marker = byte_at(bytes, at + 1);
    if (marker == kEnd) return {};
    if (marker == kFill) {
      at += 1;
    } else if (marker == kStuffed || (marker >= kFirstRestart && marker <= kLastRestart)) {
      at += 2;
    } else {
      if (at + 4 > bytes.size()) return kTruncated;
      at += 2 + big_endian(bytes, at + 2, 2);
      if (at > bytes.size()) return kTruncated;
    }
  }
}

std::string pnm_fault(std::string_view bytes) {
  const char kind = bytes[1];
  std::size_t at = 2;
  const auto width = pnm_number(bytes, at), height = pnm_number(bytes, at);
  const bool is_bitmap = kind == '1' || kind == '4';
  const auto maximum = is_bitmap ? std::optional<std::size_t>(1) : pnm_number(bytes, at);
  if (!width || !height || !maximum || at >= bytes.size()) return kTruncated;
  if (kind <= '3') {
    std::size_t samples = 0;
    const std::size_t expected = *width * *height * (kind == '3' ? 3 : 1);
    if (is_bitmap) return {};  // its digits need no blanks between them
    while (samples < expected && pnm_number(bytes, at)) ++samples;
    return samples < expected ? kTruncated : "";
  }
  const std::size_t row = kind == '4'   ? (*width + 7) / 8
                          : kind == '5' ? *width * (*maximum > 255 ? 2 : 1)
                                        : *width * (*maximum > 255 ? 6 : 3);
  return bytes.size() - at - 1 < row * *height ? kTruncated : "";
}

std::string webp_fault(std::string_view bytes) {
  std::uint32_t length = 0;  // of what is behind it, little-endian
  for (std::size_t i = 8; i-- > 4;) length = length << 8 | byte_at(bytes, i);
  return bytes.size() - 8 < length ? kTruncated : "";
}

std::string bmp_fault(std::string_view bytes) {
  constexpr std::size_t kLength = 14, kBits = 28, kPacking = 30;
  constexpr std::uint8_t kShortHeader = 16;  // OS/2: without a packing
  constexpr std::uint8_t kPlain = 0, kRunLengths8 = 1, kRunLengths4 = 2, kBitFields = 3, kAlphaBitFields = 6;
  if (byte_at(bytes, kLength) <= kShortHeader) return {};
  if (bytes.size() < kPacking + 4) return kTruncated;
  const std::uint8_t bits = byte_at(bytes, kBits), packing = byte_at(bytes, kPacking);
  const bool is_packed = (packing == kRunLengths8 && bits == 8) || (packing == kRunLengths4 && bits == 4);
  const bool is_read = packing == kPlain || is_packed || packing == kBitFields || packing == kAlphaBitFields;
  return is_read ? "" : "is a bitmap of a compression that is not read, expected none, RLE4 or RLE8";
}

/// A format that is not read, by bytes that its files have in one place.
struct OtherFormat {
  std::size_t at;
  std::string_view bytes;
  const char* fault;
};

constexpr OtherFormat kOtherFormats[] = {
    {0, "GIF8", "is a GIF image"},
    {4, "ftypavif", "is an AVIF image"},
    {4, "ftypavis", "is an AVIF image"},
    {4, "ftyphei", "is a HEIC image"},
    {4, "ftypmif1", "is a HEIC image"},
    {4, "ftyp", "is a film, from which `flies live` takes pairs"},
    {0, "\x1A\x45\xDF\xA3", "is a film, from which `flies live` takes pairs"},
    {4, "jP  \r\n\x87\n", "is a JPEG 2000 image"},
    {0, "\xFF\x4F\xFF\x51", "is a JPEG 2000 image"},
    {0, "\x76\x2F\x31\x01", "is an OpenEXR image"},
    {0, "PF\n", "is a PFM image of floating-point numbers"},
    {0, "Pf\n", "is a PFM image of floating-point numbers"},
    {0, "P7\n", "is a PAM image"},
    {0, "DDS ", "is a DDS image"},
    {0, "\x93NUMPY", "is an array of NumPy, which cv2.imwrite('left.png', numpy.load('left.npy')) makes an image"},
    {0, "PK\x03\x04", "is a zip archive"},
    {0, "\x89HDF", "is an HDF5 file"},
    {0, "%PDF", "is a PDF"}};

/// What a file is that is none of the images that are read.
std::string other_fault(std::string_view bytes) {
  const auto expected = ", expected " + std::string(kReadableImages);
  for (const auto& [at, mark, fault] : kOtherFormats)
    if (bytes.size() >= at + mark.size() && bytes.substr(at, mark.size()) == mark) return std::string(fault) + expected;
  return "is not an image" + expected;
}

}  // namespace

std::optional<std::size_t> pnm_number(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (std::isspace(byte_at(bytes, at)) != 0 || bytes[at] == '#'))
    at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
  std::size_t value = 0, digits = 0;
  for (; at < bytes.size() && std::isdigit(byte_at(bytes, at)) != 0 && digits < 9; ++at, ++digits)
    value = value * 10 + static_cast<std::size_t>(bytes[at] - '0');
  return digits > 0 ? std::optional(value) : std::nullopt;
}

ImageFileKind image_file_kind(std::string_view bytes) {
  if (bytes.starts_with(kPngSignature)) return ImageFileKind::png;
  if (bytes.starts_with("\xFF\xD8\xFF")) return ImageFileKind::jpeg;
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv) || bytes.starts_with("II+\0"sv) ||
      bytes.starts_with("MM\0+"sv))
    return ImageFileKind::tiff;
  if (bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP") return ImageFileKind::webp;
  if (bytes.size() >= 18 && bytes.starts_with("BM") && bytes.substr(6, 4) == "\0\0\0\0"sv) return ImageFileKind::bmp;
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' && std::isspace(byte_at(bytes, 2)) != 0)
    return ImageFileKind::pnm;
  return ImageFileKind::unknown;
}

std::string image_file_fault(std::string_view bytes) {
  switch (image_file_kind(bytes)) {
    case ImageFileKind::png:
      return png_fault(bytes);
    case ImageFileKind::jpeg:
      return jpeg_fault(bytes);
    case ImageFileKind::pnm:
      return pnm_fault(bytes);
    case ImageFileKind::webp:
      return webp_fault(bytes);
    case ImageFileKind::bmp:
      return bmp_fault(bytes);
    case ImageFileKind::tiff:
      return {};
    case ImageFileKind::unknown:
      break;
  }
  return other_fault(bytes);
}

}  // namespace flies::detail
