#include "flies/io/image_codecs.hpp"

#include "flies/io/image_decoders.hpp"
#include "flies/io/image_file.hpp"

namespace flies {

cv::Mat decode_image(std::string_view bytes) {
  switch (detail::image_file_kind(bytes)) {
    case detail::ImageFileKind::png:
      return detail::decode_png(bytes);
    case detail::ImageFileKind::jpeg:
      return detail::decode_jpeg(bytes);
    case detail::ImageFileKind::pnm:
      return detail::decode_pnm(bytes);
    case detail::ImageFileKind::tiff:
      return detail::decode_tiff(bytes);
    case detail::ImageFileKind::unknown:
      break;
  }
  return {};
}

}  // namespace flies
