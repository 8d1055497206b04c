#include <cstdint>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
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
  int bits = 0;  ///< a pixel: 1, 4 or 8 with a palette, 24 or 32
  std::size_t colors = 0;
};

constexpr std::size_t kFileHeader = 14, kShortestHeader = 40;

std::optional<Header> header_of(std::string_view bytes) {
  constexpr std::uint32_t kPlain = 0, kBitFields = 3;
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
  if (packing != kPlain && !(packing == kBitFields && header.bits == 32)) return std::nullopt;
  if (static_cast<double>(width) * header.height > kMaxPixels) return std::nullopt;
  const std::size_t row = row_bytes_of_bmp(width, header.bits);
  if (header.pixels_at > bytes.size() ||
      (bytes.size() - header.pixels_at) / row < static_cast<std::size_t>(header.height))
    return std::nullopt;
  if (header.bits <= 8 && (header.colors > 256 || header.palette_at + 4 * header.colors > bytes.size()))
    return std::nullopt;
  return header;
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
  cv::Mat image(header->height, header->width, CV_8UC3);
  for (int v = 0; v < header->height; ++v) {
    const auto row = static_cast<std::size_t>(header->is_top_down ? v : header->height - 1 - v);
    const std::size_t from = header->pixels_at + row * row_bytes;
    for (int u = 0; u < header->width; ++u) {
      std::size_t color_at = from + static_cast<std::size_t>(u) * static_cast<std::size_t>(header->bits / 8);
      if (header->bits <= 8) {
        const int bit = u * header->bits;
        const std::uint32_t packed = little_endian(bytes, from + static_cast<std::size_t>(bit / 8), 1);
        const std::uint32_t index = packed >> (8 - header->bits - bit % 8) & ((1U << header->bits) - 1);
        if (index >= header->colors) return {};
        color_at = header->palette_at + 4 * std::size_t{index};
      }
      for (int c = 0; c < 3; ++c)
        image.at<cv::Vec3b>(v, u)[c] = static_cast<std::uint8_t>(bytes[color_at + static_cast<std::size_t>(c)]);
    }
  }
  return header->bits <= 8 ? without_color(image) : image;
}

}  // namespace flies::detail
