#include <cstdio>
// libjpeg's header wants the line above.
#include <jerror.h>
#include <jpeglib.h>

#include <cassert>
#include <csetjmp>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "flies/io/image_codecs.hpp"
#include "flies/io/image_decoders.hpp"

namespace flies {
namespace {

/// libjpeg would end the process on an error; it is made to leave by longjmp. What has a destructor therefore lives
/// outside of the functions that call setjmp.
struct Errors {
  jpeg_error_mgr base;
  std::jmp_buf jump;
};

void leave(j_common_ptr jpeg) { std::longjmp(reinterpret_cast<Errors*>(jpeg->err)->jump, 1); }

/// Bytes between the last row and the end of the image (marker D9), as the films of many USB cameras have in every
/// picture.
bool is_padding(j_common_ptr jpeg) {
  constexpr int kEndOfImage = 0xD9;
  if (jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA || jpeg->err->msg_parm.i[1] != kEndOfImage) return false;
  const auto* decoder = reinterpret_cast<j_decompress_ptr>(jpeg);  // only decoders look for markers
  return decoder->output_scanline > 0 && decoder->output_scanline >= decoder->output_height;
}

void count_warning(j_common_ptr jpeg, int level) {
  if (level < 0 && !is_padding(jpeg)) ++jpeg->err->num_warnings;
}

jpeg_error_mgr* silent(Errors& errors) {
  jpeg_std_error(&errors.base);
  errors.base.error_exit = leave;
  errors.base.emit_message = count_warning;
  errors.base.output_message = [](j_common_ptr) {};
  return &errors.base;
}

/// Each pass of a progressive image goes over all of it and may take a few bytes: a small file could go on for hours.
/// Cameras and programs write a dozen.
void limit_passes(j_common_ptr jpeg) {
  constexpr int kMostPasses = 100;
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number > kMostPasses) leave(jpeg);
}

struct Decoder {
  jpeg_decompress_struct jpeg{};
  Errors errors{};
  jpeg_progress_mgr progress{};
  cv::Mat image;

  Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&jpeg); }
};

struct Encoder {
  jpeg_compress_struct jpeg{};
  Errors errors{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;

  Encoder() = default;
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
};

bool read_image(Decoder& d, std::string_view bytes) {
  d.jpeg.err = silent(d.errors);
  if (setjmp(d.errors.jump) != 0) return false;
  jpeg_create_decompress(&d.jpeg);
  d.progress.progress_monitor = limit_passes;
  d.jpeg.progress = &d.progress;
  jpeg_mem_src(&d.jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&d.jpeg, TRUE);
  if (detail::is_too_large(d.jpeg.image_width, d.jpeg.image_height, bytes.size())) return false;
  // Inks of four colours have none of grey; libjpeg converts all others.
  d.jpeg.out_color_space = d.jpeg.num_components == 1 ? JCS_GRAYSCALE : d.jpeg.num_components == 4 ? JCS_CMYK : JCS_RGB;
  jpeg_start_decompress(&d.jpeg);
  d.image.create(static_cast<int>(d.jpeg.output_height), static_cast<int>(d.jpeg.output_width),
                 CV_8UC(d.jpeg.output_components));
  while (d.jpeg.output_scanline < d.jpeg.output_height) {
    JSAMPROW row = d.image.ptr(static_cast<int>(d.jpeg.output_scanline));
    jpeg_read_scanlines(&d.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&d.jpeg);
  // libjpeg fills what is missing with grey and calls that a warning.
  return d.jpeg.err->num_warnings == 0;
}

bool write_image(Encoder& e, const cv::Mat& rgb, int quality) {
  e.jpeg.err = silent(e.errors);
  if (setjmp(e.errors.jump) != 0) return false;
  jpeg_create_compress(&e.jpeg);
  jpeg_mem_dest(&e.jpeg, &e.bytes, &e.size);
  e.jpeg.image_width = static_cast<JDIMENSION>(rgb.cols);
  e.jpeg.image_height = static_cast<JDIMENSION>(rgb.rows);
  e.jpeg.input_components = rgb.channels();
  e.jpeg.in_color_space = rgb.channels() == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&e.jpeg);
  jpeg_set_quality(&e.jpeg, quality, TRUE);
  jpeg_start_compress(&e.jpeg, TRUE);
  while (e.jpeg.next_scanline < e.jpeg.image_height) {
    auto row = const_cast<JSAMPROW>(rgb.ptr(static_cast<int>(e.jpeg.next_scanline)));
    jpeg_write_scanlines(&e.jpeg, &row, 1);
  }
  jpeg_finish_compress(&e.jpeg);
  return true;
}

/// Inks as Adobe stores them, inverted: 255 is no ink.
cv::Mat bgr_of_inks(const cv::Mat& inks) {
  cv::Mat bgr(inks.size(), CV_8UC3);
  for (int v = 0; v < inks.rows; ++v) {
    for (int u = 0; u < inks.cols; ++u) {
      const auto& ink = inks.at<cv::Vec4b>(v, u);
      for (int c = 0; c < 3; ++c) bgr.at<cv::Vec3b>(v, u)[c] = static_cast<std::uint8_t>(ink[2 - c] * ink[3] / 255);
    }
  }
  return bgr;
}

}  // namespace

cv::Mat detail::decode_jpeg(std::string_view bytes) {
  Decoder decoder;
  if (!read_image(decoder, bytes)) return {};
  if (decoder.image.channels() == 4) return bgr_of_inks(decoder.image);
  if (decoder.image.channels() == 3) cv::cvtColor(decoder.image, decoder.image, cv::COLOR_RGB2BGR);
  return decoder.image;
}

std::vector<std::uint8_t> encode_jpeg(const cv::Mat& image, int quality) {
  assert(image.depth() == CV_8U && (image.channels() == 1 || image.channels() == 3));
  cv::Mat rgb = image;
  if (image.channels() == 3) cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  Encoder encoder;
  [[maybe_unused]] const bool is_written = write_image(encoder, rgb, quality);
  assert(is_written);
  return {encoder.bytes, encoder.bytes + encoder.size};
}

}  // namespace flies
