#include <algorithm>
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

/// The headers of a Windows bitmap, as far as files of cameras and painting programs use them.
struct Header {
  std::size_t pixels_at = 0, palette_at = 0;
  int width = 0, height = 0;
  bool is_top_down = false;
  bool is_packed = false;  ///< by run lengths, RLE8
  int bits = 0;            ///< a pixel: 1, 4 or 8 with a palette, 24 or 32
  std::size_t colors = 0;
};

constexpr std::size_t kFileHeader = 14, kShortestHeader = 40;

std::optional<Header> header_of(std::string_view bytes) {
  constexpr std::uint32_t kPlain = 0, kRunLengths = 1, kBitFields = 3;
  if (bytes.size() < kFileHeader + kShortestHeader) return std::nullopt;
  const std::uint32_t length = little_endian(bytes, kFileHeader, 4), packing = little_endian(bytes, 30, 4);
  const auto width = static_cast<std::int32_t>(little_endian(bytes, 18, 4)),
             height = static_cast<std::int32_t>(little_endian(bytes, 22, 4));
  Header header{.pixels_at = little_endian(bytes, 10, 4),
                .palette_at = kFileHeader + length,
                .width = width,
                .height = height == INT32_MIN ? 0 : std::abs(height),
                .is_top_down = height < 0,
                .bits = static_cast<int>(little_endian(bytes, 28, 2)),
                .colors = little_endian(bytes, 46, 4)};
  if (header.bits <= 8 && header.colors == 0) header.colors = std::size_t{1} << header.bits;
  const bool is_known =
      header.bits == 1 || header.bits == 4 || header.bits == 8 || header.bits == 24 || header.bits == 32;
  if (length < kShortestHeader || !is_known || width <= 0 || header.height <= 0) return std::nullopt;
  header.is_packed = packing == kRunLengths && header.bits == 8 && !header.is_top_down;
  if (packing != kPlain && !header.is_packed && !(packing == kBitFields && header.bits == 32)) return std::nullopt;
  if (static_cast<double>(width) * header.height > kMaxPixels) return std::nullopt;
  // Two bytes are at most 255 pixels of a row, which alone may be left out and are then of the first colour.
  const std::size_t row = row_bytes_of_bmp(width, header.bits), least = header.is_packed ? row / 128 : row;
  if (header.pixels_at > bytes.size() ||
      (bytes.size() - header.pixels_at) / std::max<std::size_t>(1, least) < static_cast<std::size_t>(header.height))
    return std::nullopt;
  if (header.bits <= 8 && (header.colors > 256 || header.palette_at + 4 * header.colors > bytes.size()))
    return std::nullopt;
  return header;
}

/// The rows of a packed bitmap as they are in others; nothing when they break off or leave the image.
std::optional<std::string> unpacked(std::string_view packed, std::size_t width, std::size_t height) {
  constexpr std::size_t kEndOfRow = 0, kEndOfImage = 1, kMove = 2;  // behind a length of 0; a greater number is literal
  const std::size_t row_bytes = row_bytes_of_bmp(static_cast<int>(width), 8);
  const auto byte_at = [&](std::size_t at) { return std::size_t{static_cast<std::uint8_t>(packed[at])}; };
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
      if (row >= height || u > width || pixels > width - u) return std::nullopt;
      if (length == 0 && pixels > packed.size() - at) return std::nullopt;
      for (std::size_t i = 0; i < pixels; ++i) rows[row * row_bytes + u++] = packed[length > 0 ? at - 1 : at + i];
      if (length == 0) at += pixels + pixels % 2;
    }
  }
  return std::nullopt;
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
  const std::size_t row_bytes = row_bytes_of_bmp(header->width, header->bits);
  std::string_view pixels = bytes.substr(header->pixels_at);
  std::optional<std::string> rows;
  if (header->is_packed) {
    rows = unpacked(pixels, static_cast<std::size_t>(header->width), static_cast<std::size_t>(header->height));
    if (!rows) return {};
    pixels = *rows;
  }
  cv::Mat image(header->height, header->width, CV_8UC3);
  for (int v = 0; v < header->height; ++v) {
    const auto row = static_cast<std::size_t>(header->is_top_down ? v : header->height - 1 - v);
    const std::size_t from = row * row_bytes;
    for (int u = 0; u < header->width; ++u) {
      std::string_view color;  // blue, green, red
      if (header->bits <= 8) {
        const std::size_t bit = static_cast<std::size_t>(u) * static_cast<std::size_t>(header->bits);
        const std::uint32_t packed = little_endian(pixels, from + bit / 8, 1);
        const std::uint32_t index =
            packed >> (8 - header->bits - static_cast<int>(bit % 8)) & ((1U << header->bits) - 1);
        if (index >= header->colors) return {};
        color = bytes.substr(header->palette_at + 4 * std::size_t{index});
      } else {
        color = pixels.substr(from + static_cast<std::size_t>(u) * static_cast<std::size_t>(header->bits / 8));
      }
      for (std::size_t c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(v, u)[static_cast<int>(c)] = static_cast<std::uint8_t>(color[c]);
    }
  }
  return header->bits <= 8 ? without_color(image) : image;
}

}  // namespace flies::detail
