#include "flies/io/image_codecs.hpp"

#include <opencv2/core.hpp>

#include "flies/io/exif.hpp"
#include "flies/io/image_decoders.hpp"
#include "flies/io/image_file.hpp"

namespace flies {

namespace {

cv::Mat stored_pixels(std::string_view bytes) {
  switch (detail::image_file_kind(bytes)) {
    case detail::ImageFileKind::png:
      return detail::decode_png(bytes);
    case detail::ImageFileKind::jpeg:
      return detail::decode_jpeg(bytes);
    case detail::ImageFileKind::pnm:
      return detail::decode_pnm(bytes);
    case detail::ImageFileKind::tiff:
      return detail::decode_tiff(bytes);
    case detail::ImageFileKind::webp:
      return detail::decode_webp(bytes);
    case detail::ImageFileKind::bmp:
      return detail::decode_bmp(bytes);
    case detail::ImageFileKind::unknown:
      break;
  }
  return {};
}

}  // namespace

bool has_second_image(std::string_view bytes) {
  return detail::image_file_kind(bytes) == detail::ImageFileKind::tiff && detail::has_second_tiff_image(bytes);
}

cv::Mat decode_image(std::string_view bytes) {
  const cv::Mat stored = stored_pixels(bytes);
  return stored.empty() ? stored : detail::turned(stored, detail::stored_orientation(bytes));
}

}  // namespace flies
