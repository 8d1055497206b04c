#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/io/image_decoders.hpp"
#include "flies/io/image_file.hpp"

namespace flies::detail {
namespace {

constexpr std::size_t kWhite = 255;  // what the maximum becomes where it is lower

std::uint8_t byte_at(std::string_view bytes, std::size_t at) { return static_cast<std::uint8_t>(bytes[at]); }

/// What the pixels take at least, so that a file of a few bytes cannot ask for gigabytes.
std::size_t least_bytes(char kind, std::size_t width, std::size_t height, std::size_t maximum) {
  const std::size_t values = width * height * (kind == '3' || kind == '6' ? 3 : 1);
  if (kind == '1') return values;
  if (kind <= '3') return 2 * values - 1;  // a digit each, and a blank between
  return kind == '4' ? (width + 7) / 8 * height : values * (maximum > 255 ? 2 : 1);
}

/// A digit is a pixel, a set bit is black.
cv::Mat bitmap(std::string_view bytes, std::size_t at, int width, int height, bool is_text) {
  cv::Mat image(height, width, CV_8U, cv::Scalar(255));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      bool is_black = false;
      if (is_text) {
        at = bytes.find_first_of("01", at);
        if (at == std::string_view::npos) return {};
        is_black = bytes[at++] == '1';
      } else {
        const std::size_t byte = at + static_cast<std::size_t>(v) * static_cast<std::size_t>((width + 7) / 8) +
                                 static_cast<std::size_t>(u / 8);
        is_black = (byte_at(bytes, byte) >> (7 - u % 8) & 1) != 0;
      }
      if (is_black) image.at<std::uint8_t>(v, u) = 0;
    }
  }
  return image;
}

}  // namespace

cv::Mat decode_pnm(std::string_view bytes) {
  const char kind = bytes[1];
  const bool is_text = kind <= '3', is_bitmap = kind == '1' || kind == '4';
  std::size_t at = 2;
  const auto width = pnm_number(bytes, at), height = pnm_number(bytes, at);
  const auto maximum = is_bitmap ? std::optional<std::size_t>(1) : pnm_number(bytes, at);
  if (!width || !height || !maximum || *width == 0 || *height == 0 || *maximum == 0 || *maximum > 65535) return {};
  if (static_cast<double>(*width) * static_cast<double>(*height) > kMaxPixels) return {};
  const auto columns = static_cast<int>(*width), rows = static_cast<int>(*height);
  if (!is_text) ++at;  // one blank before the pixels
  if (at > bytes.size() || bytes.size() - at < least_bytes(kind, *width, *height, *maximum)) return {};
  if (is_bitmap) return bitmap(bytes, at, columns, rows, is_text);

  const bool is_color = kind == '3' || kind == '6';
  cv::Mat levels(rows, columns, CV_16UC(is_color ? 3 : 1));
  for (int v = 0; v < rows; ++v) {
    auto* const row = levels.ptr<std::uint16_t>(v);
    for (int i = 0; i < columns * levels.channels(); ++i) {
      std::size_t level = 0;
      if (is_text) {
        const auto number = pnm_number(bytes, at);
        if (!number) return {};
        level = *number;
      } else {
        level = byte_at(bytes, at++);
        if (*maximum > 255) level = level << 8 | byte_at(bytes, at++);
      }
      level = std::min(level, is_text || *maximum < kWhite ? *maximum : std::size_t{65535});
      if (*maximum < kWhite) level = (level * kWhite + *maximum / 2) / *maximum;
      row[i] = static_cast<std::uint16_t>(level);
    }
  }
  if (*maximum <= 255) levels.convertTo(levels, CV_8U);
  if (is_color) cv::cvtColor(levels, levels, cv::COLOR_RGB2BGR);
  return levels;
}

}  // namespace flies::detail
