#include <png.h>
#include <zlib.h>

#include <cassert>
#include <cstring>
#include <opencv2/core.hpp>

#include "flies/io/image_codecs.hpp"
#include "flies/io/image_decoders.hpp"
#include "flies/io/output_file.hpp"

namespace flies {
namespace {

// libpng leaves a function by longjmp on an error. What has a destructor therefore lives outside of the functions that
// call setjmp: in these structs.

struct Source {
  std::string_view bytes;
  std::size_t at = 0;
};

void read_bytes(png_structp png, png_bytep out, std::size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (count > source.bytes.size() - source.at) png_error(png, "truncated");
  std::memcpy(out, source.bytes.data() + source.at, count);
  source.at += count;
}

void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  out.insert(out.end(), bytes, bytes + count);
}

void be_silent(png_structp, png_const_charp) {}
[[noreturn]] void leave(png_structp png, png_const_charp) { png_longjmp(png, 1); }

struct Reader {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, be_silent);
  png_infop info = png_create_info_struct(png);
  Source source;
  cv::Mat image;
  std::vector<png_bytep> rows;

  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Writer {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, be_silent);
  png_infop info = png_create_info_struct(png);
  std::vector<std::uint8_t> bytes;
  std::vector<png_bytep> rows;

  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

void point_to_rows(const cv::Mat& image, std::vector<png_bytep>& rows) {
  for (int v = 0; v < image.rows; ++v) rows.push_back(const_cast<png_bytep>(image.ptr(v)));
}

bool read_image(Reader& r) {
  if (setjmp(png_jmpbuf(r.png)) != 0) return false;
  png_set_read_fn(r.png, &r.source, read_bytes);
  png_read_info(r.png, r.info);
  const png_uint_32 width = png_get_image_width(r.png, r.info), height = png_get_image_height(r.png, r.info);
  if (detail::is_too_large(width, height, r.source.bytes.size())) return false;
  // Levels as they are in the file, palettes and fractions of a byte apart. Nothing is seen through.
  png_set_expand(r.png);
  png_set_strip_alpha(r.png);
  png_set_bgr(r.png);
  png_set_swap(r.png);
  png_set_interlace_handling(r.png);
  png_read_update_info(r.png, r.info);
  const int depth = png_get_bit_depth(r.png, r.info) == 16 ? CV_16U : CV_8U;
  r.image.create(static_cast<int>(height), static_cast<int>(width),
                 CV_MAKETYPE(depth, png_get_channels(r.png, r.info)));
  point_to_rows(r.image, r.rows);
  png_read_image(r.png, r.rows.data());
  return true;
}

bool write_image(Writer& w, const cv::Mat& image, bool is_small) {
  if (setjmp(png_jmpbuf(w.png)) != 0) return false;
  png_set_write_fn(w.png, &w.bytes, write_bytes, nullptr);
  const int color = image.channels() == 1   ? PNG_COLOR_TYPE_GRAY
                    : image.channels() == 3 ? PNG_COLOR_TYPE_RGB
                                            : PNG_COLOR_TYPE_RGB_ALPHA;
  if (is_small) {
    png_set_compression_level(w.png, Z_BEST_COMPRESSION);
  } else {  // as OpenCV does it: quick, and good enough for photographs
    png_set_compression_level(w.png, Z_BEST_SPEED);
    png_set_compression_strategy(w.png, Z_RLE);
    png_set_filter(w.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  }
  png_set_IHDR(w.png, w.info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
               image.depth() == CV_16U ? 16 : 8, color, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
               PNG_FILTER_TYPE_BASE);
  png_write_info(w.png, w.info);
  png_set_bgr(w.png);
  if (image.depth() == CV_16U) png_set_swap(w.png);
  png_write_image(w.png, w.rows.data());
  png_write_end(w.png, w.info);
  return true;
}

}  // namespace

cv::Mat detail::decode_png(std::string_view bytes) {
  Reader reader;
  reader.source.bytes = bytes;
  return read_image(reader) ? reader.image : cv::Mat();
}

std::vector<std::uint8_t> encode_png(const cv::Mat& image, bool is_small) {
  assert(image.depth() == CV_8U || image.depth() == CV_16U);
  Writer writer;
  point_to_rows(image, writer.rows);
  [[maybe_unused]] const bool is_written = write_image(writer, image, is_small);
  assert(is_written);
  return std::move(writer.bytes);
}

void write_png(const std::string& path, const cv::Mat& image) {
  const auto bytes = encode_png(image);
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace flies
