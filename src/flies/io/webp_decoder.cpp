#include <webp/decode.h>

#include <opencv2/core.hpp>

#include "flies/io/image_decoders.hpp"

namespace flies::detail {

cv::Mat decode_webp(std::string_view bytes) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  int width = 0, height = 0;
  if (WebPGetInfo(data, bytes.size(), &width, &height) == 0 || static_cast<double>(width) * height > kMaxPixels)
    return {};
  cv::Mat image(height, width, CV_8UC3);
  const std::size_t row_bytes = image.step[0];
  if (WebPDecodeBGRInto(data, bytes.size(), image.data, row_bytes * static_cast<std::size_t>(height),
                        static_cast<int>(row_bytes)) == nullptr)
    return {};
  return image;
}

}  // namespace flies::detail
