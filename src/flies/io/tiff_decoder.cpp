#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "flies/io/image_decoders.hpp"

namespace flies::detail {
namespace {

struct Source {
  std::string_view bytes;
  std::size_t at = 0;
  bool has_bad_jpeg = false;  ///< libjpeg inside of libtiff fills what is missing with grey and only warns
};

Source& source_of(thandle_t handle) { return *static_cast<Source*>(handle); }

tmsize_t read_bytes(thandle_t handle, void* out, tmsize_t count) {
  Source& source = source_of(handle);
  const std::size_t left = source.bytes.size() - std::min(source.at, source.bytes.size());
  const std::size_t taken = std::min(static_cast<std::size_t>(count), left);
  if (taken > 0) std::memcpy(out, source.bytes.data() + source.at, taken);
  source.at += taken;
  return static_cast<tmsize_t>(taken);
}

tmsize_t write_nothing(thandle_t, void*, tmsize_t) { return 0; }

toff_t seek(thandle_t handle, toff_t offset, int whence) {
  Source& source = source_of(handle);
  const toff_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? source.at : source.bytes.size();
  source.at = static_cast<std::size_t>(from + offset);
  return source.at;
}

int close_nothing(thandle_t) { return 0; }
toff_t size_of(thandle_t handle) { return source_of(handle).bytes.size(); }
int note_bad_jpeg(TIFF*, void* source, const char* module, const char*, va_list) {
  if (module != nullptr && std::strstr(module, "JPEG") != nullptr) static_cast<Source*>(source)->has_bad_jpeg = true;
  return 1;
}

int be_silent(TIFF*, void*, const char*, const char*, va_list) { return 1; }

using File = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

File open_file(Source& source) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), be_silent, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), note_bad_jpeg, &source);
  return {TIFFClientOpenExt("image", "rm", &source, read_bytes, write_nothing, seek, close_nothing, size_of, nullptr,
                            nullptr, options.get()),
          &TIFFClose};
}

struct Layout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, channels = 1, format = SAMPLEFORMAT_UINT, planes = PLANARCONFIG_CONTIG, photometric = 0,
                orientation = ORIENTATION_TOPLEFT;
};

Layout layout_of(TIFF* file) {
  Layout layout;
  TIFFGetField(file, TIFFTAG_IMAGEWIDTH, &layout.width);
  TIFFGetField(file, TIFFTAG_IMAGELENGTH, &layout.height);
  TIFFGetFieldDefaulted(file, TIFFTAG_BITSPERSAMPLE, &layout.bits);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLESPERPIXEL, &layout.channels);
  TIFFGetFieldDefaulted(file, TIFFTAG_SAMPLEFORMAT, &layout.format);
  TIFFGetFieldDefaulted(file, TIFFTAG_PLANARCONFIG, &layout.planes);
  TIFFGetField(file, TIFFTAG_PHOTOMETRIC, &layout.photometric);
  TIFFGetFieldDefaulted(file, TIFFTAG_ORIENTATION, &layout.orientation);
  return layout;
}

bool is_packed(const Layout& layout) { return layout.bits > 8 && layout.bits < 16; }

/// OpenCV's depth for these samples, -1 where they need converting.
int depth_of(const Layout& layout) {
  const bool is_plain = layout.planes == PLANARCONFIG_CONTIG && layout.channels >= 1 && layout.channels <= 4 &&
                        (layout.photometric == PHOTOMETRIC_MINISBLACK || layout.photometric == PHOTOMETRIC_MINISWHITE ||
                         layout.photometric == PHOTOMETRIC_RGB);
  if (!is_plain) return -1;
  switch (layout.format) {
    case SAMPLEFORMAT_IEEEFP:
      return layout.bits == 32 ? CV_32F : layout.bits == 64 ? CV_64F : -1;
    case SAMPLEFORMAT_INT:
      return layout.bits == 8 ? CV_8S : layout.bits == 16 ? CV_16S : layout.bits == 32 ? CV_32S : -1;
    default:
      return layout.bits == 8                         ? CV_8U
             : layout.bits == 16 || is_packed(layout) ? CV_16U
             : layout.bits == 32                      ? CV_32S
                                                      : -1;
  }
}

/// Samples of 9 to 15 bits, one behind the other, the highest bit first.
void unpack(const std::uint8_t* packed, int bits, std::size_t count, std::uint16_t* samples) {
  std::uint32_t held = 0;
  int held_bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (; held_bits < bits; held_bits += 8) held = held << 8 | *packed++;
    held_bits -= bits;
    samples[i] = static_cast<std::uint16_t>(held >> held_bits & ((1U << bits) - 1));
  }
}

/// Samples as they are, strip by strip or tile by tile.
cv::Mat plain_samples(TIFF* file, const Layout& layout, int depth) {
  cv::Mat image(static_cast<int>(layout.height), static_cast<int>(layout.width), CV_MAKETYPE(depth, layout.channels));
  const bool is_tiled = TIFFIsTiled(file) != 0;
  std::uint32_t part_width = layout.width, part_height = layout.height;
  if (is_tiled) {
    TIFFGetField(file, TIFFTAG_TILEWIDTH, &part_width);
    TIFFGetField(file, TIFFTAG_TILELENGTH, &part_height);
  } else {
    TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &part_height);
    part_height = std::min(part_height, layout.height);
  }
  if (part_width == 0 || part_height == 0) return {};
  const std::size_t row_bytes = (std::size_t{part_width} * layout.channels * layout.bits + 7) / 8;
  const auto part_bytes = static_cast<std::size_t>(is_tiled ? TIFFTileSize(file) : TIFFStripSize(file));
  if (part_bytes != row_bytes * part_height || static_cast<double>(part_bytes) > kMaxPixels) return {};
  std::vector<std::uint8_t> part(part_bytes);
  for (std::uint32_t v = 0; v < layout.height; v += part_height) {
    const std::uint32_t rows = std::min(part_height, layout.height - v);
    for (std::uint32_t u = 0; u < layout.width; u += part_width) {
      const std::uint32_t columns = std::min(part_width, layout.width - u);
      const auto size = static_cast<tmsize_t>(is_tiled ? part.size() : rows * row_bytes);
      const tmsize_t read = is_tiled ? TIFFReadEncodedTile(file, TIFFComputeTile(file, u, v, 0, 0), part.data(), size)
                                     : TIFFReadEncodedStrip(file, TIFFComputeStrip(file, v, 0), part.data(), size);
      if (read < size) return {};
      for (std::uint32_t r = 0; r < rows; ++r) {
        const std::uint8_t* const from = part.data() + r * row_bytes;
        std::uint8_t* const to = image.ptr(static_cast<int>(v + r), static_cast<int>(u));
        if (is_packed(layout))
          unpack(from, layout.bits, std::size_t{columns} * layout.channels, reinterpret_cast<std::uint16_t*>(to));
        else
          std::memcpy(to, from, columns * image.elemSize());
      }
    }
  }
  if (layout.photometric == PHOTOMETRIC_MINISWHITE && (depth == CV_8U || depth == CV_16U))
    cv::subtract(cv::Scalar::all((1 << layout.bits) - 1), image, image);
  if (image.channels() >= 3 && (depth == CV_8U || depth == CV_16U))
    cv::cvtColor(image, image, image.channels() == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
  return image;
}

/// Palettes, YCbCr, bits and all else that libtiff can turn into 8 bits a colour.
cv::Mat converted_samples(TIFF* file, const Layout& layout) {
  cv::Mat image(static_cast<int>(layout.height), static_cast<int>(layout.width), CV_8UC4);
  constexpr int kStopOnError = 1;
  // The file's own orientation leaves the pixels as they are stored; those of images on their side mean the same to it.
  if (TIFFReadRGBAImageOriented(file, layout.width, layout.height, image.ptr<std::uint32_t>(), layout.orientation,
                                kStopOnError) == 0)
    return {};
  cv::cvtColor(image, image, cv::COLOR_RGBA2BGR);
  return image;
}

}  // namespace

cv::Mat decode_tiff(std::string_view bytes) {
  Source source{bytes};
  const File file = open_file(source);
  if (!file) return {};
  const Layout layout = layout_of(file.get());
  if (layout.width == 0 || layout.height == 0 || is_too_large(layout.width, layout.height, bytes.size())) return {};
  const int depth = depth_of(layout);
  const cv::Mat image = depth >= 0 ? plain_samples(file.get(), layout, depth) : converted_samples(file.get(), layout);
  return source.has_bad_jpeg ? cv::Mat() : image;
}

bool has_second_tiff_image(std::string_view bytes) {
  Source source{bytes};
  const File file = open_file(source);
  if (!file) return false;
  const Layout first = layout_of(file.get());
  if (TIFFReadDirectory(file.get()) == 0) return false;
  const Layout second = layout_of(file.get());
  return second.width == first.width && second.height == first.height;
}

}  // namespace flies::detail
