#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flies/io/image_decoders.hpp"

namespace flies::detail {
namespace {

std::uint32_t little_endian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = count - 1; i >= 0; --i)
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

/// The headers of a bitmap, as far as files of cameras and painting programs use them.
struct Header {
  std::size_t pixels_at = 0, palette_at = 0;
  std::size_t palette_step = 4;  ///< bytes of a colour: 3 in OS/2's oldest files
  int width = 0, height = 0;
  bool is_top_down = false;
  bool is_packed = false;  ///< by run lengths, RLE4 or RLE8
  int bits = 0;            ///< a pixel: 1, 2, 4 or 8 with a palette, 16, 24 or 32
  std::size_t colors = 0;
  std::array<std::uint32_t, 3> masks = {};  ///< of blue, green and red in pixels of 16 and 32 bits
};

constexpr std::size_t kFileHeader = 14;
constexpr std::size_t kOldestHeader = 12, kShortHeader = 16;  // OS/2
constexpr std::size_t kUsualHeader = 40;                      // and longer ones, which begin with it

bool is_known_depth(int bits) {
  constexpr std::array kKnown = {1, 2, 4, 8, 16, 24, 32};
  return std::ranges::find(kKnown, bits) != kKnown.end();
}

/// Where size and depth are that the file says, whatever is done with them.
std::optional<Header> sizes_of(std::string_view bytes, std::size_t length) {
  Header header{.pixels_at = little_endian(bytes, 10, 4), .palette_at = kFileHeader + length};
  if (length == kOldestHeader) {
    header.palette_step = 3;
    header.width = static_cast<int>(little_endian(bytes, 18, 2));
    header.height = static_cast<int>(little_endian(bytes, 20, 2));
    header.bits = static_cast<int>(little_endian(bytes, 24, 2));
  } else {
    const auto height = static_cast<std::int32_t>(little_endian(bytes, 22, 4));
    header.width = static_cast<std::int32_t>(little_endian(bytes, 18, 4));
    header.height = height == INT32_MIN ? 0 : std::abs(height);
    header.is_top_down = height < 0;
    header.bits = static_cast<int>(little_endian(bytes, 28, 2));
  }
  if (!is_known_depth(header.bits) || header.width <= 0 || header.height <= 0) return std::nullopt;
  if (static_cast<double>(header.width) * header.height > kMaxPixels) return std::nullopt;
  return header;
}

/// How the pixels are packed. @returns whether they can be read
bool read_packing(std::string_view bytes, Header& header) {
  constexpr std::uint32_t kPlain = 0, kRunLengths8 = 1, kRunLengths4 = 2, kBitFields = 3, kAlphaBitFields = 6;
  constexpr std::size_t kMasks = kFileHeader + kUsualHeader;  // behind the usual header, or in a longer one
  const std::uint32_t packing = little_endian(bytes, 30, 4);
  header.colors = little_endian(bytes, 46, 4);
  header.is_packed = !header.is_top_down && packing == (header.bits == 8 ? kRunLengths8 : kRunLengths4) &&
                     (header.bits == 8 || header.bits == 4);
  if (packing == kPlain || header.is_packed) return true;
  if (packing != kBitFields && packing != kAlphaBitFields) return false;
  if ((header.bits != 16 && header.bits != 32) || bytes.size() < kMasks + 12) return false;
  for (std::size_t c = 0; c < 3; ++c) header.masks[c] = little_endian(bytes, kMasks + 4 * (2 - c), 4);
  return std::ranges::none_of(header.masks, [](std::uint32_t mask) { return mask == 0; });
}

std::optional<Header> header_of(std::string_view bytes) {
  if (bytes.size() < kFileHeader + kOldestHeader) return std::nullopt;
  const std::size_t length = little_endian(bytes, kFileHeader, 4);
  const bool is_old = length == kOldestHeader || length == kShortHeader;
  if ((!is_old && length < kUsualHeader) || bytes.size() < kFileHeader + (is_old ? length : kUsualHeader))
    return std::nullopt;
  auto header = sizes_of(bytes, length);
  if (!header) return std::nullopt;
  if (header->bits == 16) header->masks = {0x1F, 0x3E0, 0x7C00};
  if (header->bits == 32) header->masks = {0xFF, 0xFF00, 0xFF0000};
  if (!is_old && !read_packing(bytes, *header)) return std::nullopt;
  if (header->bits <= 8 && header->colors == 0) header->colors = std::size_t{1} << header->bits;
  // Two bytes are at most 255 pixels of a row, which alone may be left out and are then of the first colour.
  const std::size_t least =
      header->is_packed ? row_bytes_of_bmp(header->width, 8) / 128 : row_bytes_of_bmp(header->width, header->bits);
  if (header->pixels_at > bytes.size() ||
      (bytes.size() - header->pixels_at) / std::max<std::size_t>(1, least) < static_cast<std::size_t>(header->height))
    return std::nullopt;
  if (header->bits <= 8 &&
      (header->colors > 256 || header->palette_at + header->palette_step * header->colors > bytes.size()))
    return std::nullopt;
  return header;
}

/// The rows of a packed bitmap as they are in others of 8 bits; nothing when they break off or leave the image.
/// @param bits of a pixel in it, 4 or 8
std::optional<std::string> unpacked(std::string_view packed, std::size_t width, std::size_t height, int bits) {
  constexpr std::size_t kEndOfRow = 0, kEndOfImage = 1, kMove = 2;  // behind a length of 0; a greater number is literal
  const std::size_t row_bytes = row_bytes_of_bmp(static_cast<int>(width), 8);
  const std::size_t pixels_a_byte = bits == 4 ? 2 : 1;
  const auto byte_at = [&](std::size_t at) { return std::size_t{static_cast<std::uint8_t>(packed[at])}; };
  const auto index_in = [&](std::size_t byte, std::size_t pixel) {
    return static_cast<char>(bits == 8 ? byte : pixel % 2 == 0 ? byte >> 4 : byte & 0xF);
  };
  std::string rows(row_bytes * height, '\0');
  std::size_t u = 0, row = 0;
  for (std::size_t at = 0; at + 2 <= packed.size();) {
    const std::size_t length = byte_at(at), order = byte_at(at + 1);
    at += 2;
    if (length == 0 && order == kEndOfImage) return rows;
    if (length == 0 && order == kEndOfRow) {
      u = 0;
      ++row;
    } else if (length == 0 && order == kMove) {
      if (packed.size() - at < 2) return std::nullopt;
      u += byte_at(at);
      row += byte_at(at + 1);
      at += 2;
    } else {
      const std::size_t pixels = length > 0 ? length : order;
      const std::size_t literal_bytes = length > 0 ? 0 : (pixels + pixels_a_byte - 1) / pixels_a_byte;
      if (row >= height || u > width || pixels > width - u) return std::nullopt;
      if (literal_bytes > packed.size() - at) return std::nullopt;
      for (std::size_t i = 0; i < pixels; ++i)
        rows[row * row_bytes + u++] = index_in(byte_at(length > 0 ? at - 1 : at + i / pixels_a_byte), i);
      at += literal_bytes + literal_bytes % 2;
    }
  }
  return std::nullopt;
}

/// The colour that a mask cuts out of a pixel, of 255.
std::uint8_t level_of(std::uint32_t pixel, std::uint32_t mask) {
  const int first_bit = std::countr_zero(mask);
  const std::uint64_t most = mask >> first_bit, level = (pixel & mask) >> first_bit;
  return static_cast<std::uint8_t>((level * 255 + most / 2) / most);
}

/// Where grey is all that the palette has, it is grey.
cv::Mat without_color(const cv::Mat& bgr) {
  std::vector<cv::Mat> channels;
  cv::split(bgr, channels);
  const bool is_gray = cv::norm(channels[0], channels[1], cv::NORM_INF) == 0.0 &&
                       cv::norm(channels[0], channels[2], cv::NORM_INF) == 0.0;
  return is_gray ? channels[0] : bgr;
}

}  // namespace

cv::Mat decode_bmp(std::string_view bytes) {
  const auto header = header_of(bytes);
  if (!header) return {};
  const int stored_bits = header->is_packed ? 8 : header->bits;
  const std::size_t row_bytes = row_bytes_of_bmp(header->width, stored_bits);
  std::string_view pixels = bytes.substr(header->pixels_at);
  std::optional<std::string> rows;
  if (header->is_packed) {
    rows = unpacked(pixels, static_cast<std::size_t>(header->width), static_cast<std::size_t>(header->height),
                    header->bits);
    if (!rows) return {};
    pixels = *rows;
  }
  cv::Mat image(header->height, header->width, CV_8UC3);
  for (int v = 0; v < header->height; ++v) {
    const auto row = static_cast<std::size_t>(header->is_top_down ? v : header->height - 1 - v);
    const std::size_t from = row * row_bytes;
    for (int u = 0; u < header->width; ++u) {
      auto& bgr = image.at<cv::Vec3b>(v, u);
      const std::size_t bit = static_cast<std::size_t>(u) * static_cast<std::size_t>(stored_bits);
      if (stored_bits == 16 || stored_bits == 32) {
        const std::uint32_t pixel = little_endian(pixels, from + bit / 8, stored_bits / 8);
        for (std::size_t c = 0; c < 3; ++c) bgr[static_cast<int>(c)] = level_of(pixel, header->masks[c]);
        continue;
      }
      std::string_view color = pixels.substr(from + bit / 8);  // blue, green, red
      if (stored_bits <= 8) {
        const std::uint32_t packed = little_endian(pixels, from + bit / 8, 1);
        const std::uint32_t index = packed >> (8 - stored_bits - static_cast<int>(bit % 8)) & ((1U << stored_bits) - 1);
        if (index >= header->colors) return {};
        color = bytes.substr(header->palette_at + header->palette_step * std::size_t{index});
      }
      for (std::size_t c = 0; c < 3; ++c) bgr[static_cast<int>(c)] = static_cast<std::uint8_t>(color[c]);
    }
  }
  return header->bits <= 8 ? without_color(image) : image;
}

}  // namespace flies::detail
