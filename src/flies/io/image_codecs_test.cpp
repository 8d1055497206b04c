#include "flies/io/image_codecs.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>
// libjpeg's header wants <cstdio> before it.
#include <jpeglib.h>

#include "flies/io/image_decoders.hpp"
#include "flies/io/image_file.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::read_all;
using flies::testing::TemporaryFolder;

cv::Mat noise(int type, int width_px = 61, int height_px = 40) {
  cv::Mat image(height_px, width_px, type);
  cv::RNG random(5);
  random.fill(image, cv::RNG::UNIFORM, 0.0, image.depth() == CV_16U ? 65536.0 : 256.0);
  return image;
}

std::string_view view_of(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void expect_equal(const cv::Mat& found, const cv::Mat& expected, const std::string& what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  ASSERT_EQ(found.type(), expected.type()) << what;
  EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0) << what;
}

TEST(DecodeImage, ReadsWhatOpencvReads) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4, CV_32FC1}) {
    for (const std::string format : {".png", ".jpg", ".pgm", ".ppm", ".pbm", ".tif", ".bmp", ".webp"}) {
      const cv::Mat image = noise(type);
      if ((format == ".pgm" || format == ".pbm") && image.channels() != 1) continue;
      if (format == ".ppm" && image.channels() != 3) continue;
      if ((format == ".jpg" || format == ".pbm" || format == ".bmp" || format == ".webp") && image.depth() != CV_8U)
        continue;
      if (image.depth() == CV_32F && format != ".tif") continue;
      std::vector<std::uint8_t> bytes;
      ASSERT_TRUE(cv::imencode(format, image, bytes)) << format << type;
      cv::Mat expected = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
      if (format != ".tif" && expected.channels() == 4) cv::cvtColor(expected, expected, cv::COLOR_BGRA2BGR);
      expect_equal(decode_image(view_of(bytes)), expected, format + " of type " + std::to_string(type));
    }
  }
}

TEST(DecodeJpeg, BearsBytesBehindTheLastRow) {
  constexpr std::size_t kEnd = 2, kPadding = 64;  // FF D9; more than a decoder reads ahead
  const cv::Mat image = noise(CV_8UC1);
  const auto bytes = encode_jpeg(image, 90);
  auto padded = bytes;
  padded.insert(padded.end() - kEnd, kPadding, 0);
  expect_equal(decode_image(view_of(padded)), decode_image(view_of(bytes)), "padded");
  auto cut = bytes;
  cut.erase(cut.end() - 400, cut.end() - kEnd);
  EXPECT_TRUE(decode_image(view_of(cut)).empty());
  cut.insert(cut.end() - kEnd, kPadding, 0);
  EXPECT_TRUE(decode_image(view_of(cut)).empty());
}

/// A progressive grey image, each coefficient in two passes of its own.
std::string jpeg_of_passes(int coefficients) {
  std::vector<jpeg_scan_info> passes = {{1, {0}, 0, 0, 0, 0}};
  for (int k = 1; k <= coefficients; ++k) {
    passes.push_back({1, {0}, k, k, 0, 1});
    passes.push_back({1, {0}, k, k, 1, 0});
  }
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = jpeg.image_height = 8;
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg.scan_info = passes.data();
  jpeg.num_scans = static_cast<int>(passes.size());
  jpeg_start_compress(&jpeg, TRUE);
  std::array<JSAMPLE, 8> row = {0, 200, 30, 170, 60, 140, 90, 110};
  for (int v = 0; v < 8; ++v) {
    JSAMPROW pixels = row.data();
    jpeg_write_scanlines(&jpeg, &pixels, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string file(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return file;
}

TEST(DecodeJpeg, RefusesPassesWithoutEnd) {
  EXPECT_FALSE(decode_image(jpeg_of_passes(40)).empty());
  EXPECT_TRUE(decode_image(jpeg_of_passes(63)).empty()) << "127 passes";
}

TEST(DecodePnm, TakesTheShortestTextsAndNoneThatPromisesMore) {
  EXPECT_EQ(decode_image("P1\n3 2\n101010").size(), cv::Size(3, 2));
  EXPECT_EQ(decode_image("P2\n2 2\n9\n1 2 3 4").size(), cv::Size(2, 2));
  EXPECT_EQ(decode_image("P3\n1 1\n9\n1 2 3").size(), cv::Size(1, 1));
  EXPECT_TRUE(decode_image("P1\n3 2\n10101").empty());
  EXPECT_TRUE(decode_image("P3\n32000 32000\n255\n1 2 3 4 5 6 7 8 9\n").empty());
}

TEST(DecodePnm, StretchesLevelsWhoseMaximumIsLower) {
  expect_equal(decode_image("P2\n3 1\n100\n0 50 100"), (cv::Mat_<std::uint8_t>(1, 3) << 0, 128, 255), "text");
  expect_equal(decode_image("P5 3 1 100 \x01\x32\xFF"), (cv::Mat_<std::uint8_t>(1, 3) << 3, 128, 255), "bytes");
  expect_equal(decode_image("P5 2 1 255 \x01\x32"), (cv::Mat_<std::uint8_t>(1, 2) << 1, 50), "as they are");
}

std::string number(std::size_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i, value >>= 8) text += static_cast<char>(value & 255U);
  return text;
}

/// A grey bitmap of 5 x 2 px, packed.
std::string packed_bmp(const std::string& rows, int packing = 1, int bits = 8) {
  std::string palette;
  const std::size_t colors = std::size_t{1} << bits;
  for (std::size_t i = 0; i < colors; ++i) palette += number(i * 0x010101U, 4);
  const std::size_t pixels_at = 14 + 40 + palette.size();
  return "BM" + number(pixels_at + rows.size(), 4) + number(0, 4) + number(pixels_at, 4) + number(40, 4) +
         number(5, 4) + number(2, 4) + number(1, 2) + number(static_cast<std::size_t>(bits), 2) +
         number(static_cast<std::size_t>(packing), 4) + number(rows.size(), 4) + number(0, 16) + palette + rows;
}

/// A bitmap of 2 x 1 px without a palette.
std::string plain_bmp(int bits, int packing, const std::string& behind_header, const std::string& row,
                      std::size_t header = 40) {
  const std::size_t pixels_at = 14 + 40 + behind_header.size();
  return "BM" + number(pixels_at + row.size(), 4) + number(0, 4) + number(pixels_at, 4) + number(header, 4) +
         number(2, 4) + number(1, 4) + number(1, 2) + number(static_cast<std::size_t>(bits), 2) +
         number(static_cast<std::size_t>(packing), 4) + number(row.size(), 4) + number(0, 16) + behind_header + row;
}

TEST(DecodeBmp, ReadsPixelsOf16Bits) {
  cv::Mat_<cv::Vec3b> expected(1, 2);
  expected(0, 0) = {0, 0, 255};
  expected(0, 1) = {8, 255, 0};
  const std::string masks_565 = number(0xF800, 4) + number(0x7E0, 4) + number(0x1F, 4);
  const std::string row_565 = number(0xF800, 2) + number(0x7E1, 2);
  const std::string row_555 = number(0x7C00, 2) + number(0x3E1, 2);
  expect_equal(decode_image(plain_bmp(16, 3, masks_565, row_565)), expected, "565");
  expect_equal(decode_image(plain_bmp(16, 0, "", row_555)), expected, "555");
  const std::string longer = masks_565 + number(0, 124 - 40 - 12);
  expect_equal(decode_image(plain_bmp(16, 3, longer, row_565, 124)), expected, "header of 124 bytes");
  const std::string with_alpha = number(0x7C00, 4) + number(0x3E0, 4) + number(0x1F, 4) + number(0x8000, 4);
  expect_equal(decode_image(plain_bmp(16, 6, with_alpha, row_555)), expected, "1555");
  EXPECT_TRUE(decode_image(plain_bmp(16, 3, number(0, 12), row_565)).empty());
  EXPECT_TRUE(decode_image(plain_bmp(16, 3, masks_565, row_565.substr(0, 3))).empty());
}

TEST(DecodeBmp, ReadsPixelsOf32BitsInTheOrderOfTheirMasks) {
  cv::Mat_<cv::Vec3b> expected(1, 2);
  expected(0, 0) = {3, 2, 1};
  expected(0, 1) = {6, 5, 4};
  const std::string rgba = number(0xFF, 4) + number(0xFF00, 4) + number(0xFF0000, 4);
  expect_equal(decode_image(plain_bmp(32, 3, rgba, "\x01\x02\x03\xFF\x04\x05\x06\xFF")), expected, "RGBA");
  expect_equal(decode_image(plain_bmp(32, 0, "", "\x03\x02\x01\xFF\x06\x05\x04\xFF")), expected, "BGRA");
}

TEST(DecodeBmp, ReadsTheOldestHeader) {
  // Two colours of three bytes, two pixels: the second and the first.
  const std::string file = "BM" + number(36, 4) + number(0, 4) + number(32, 4) + number(12, 4) + number(2, 2) +
                           number(1, 2) + number(1, 2) + number(1, 2) + "\x0A\x0A\x0A\xF0\xF0\xF0" + number(0x80, 4);
  EXPECT_EQ(detail::image_file_fault(file), "");
  expect_equal(decode_image(file), (cv::Mat_<std::uint8_t>(1, 2) << 0xF0, 0x0A), "OS/2");
}

TEST(DecodeBmp, ReadsRunLengths) {
  using namespace std::string_literals;
  // From the bottom: four of 7, one of 9; then one step to the right, three as they are.
  const std::string rows = "\x04\x07\x01\x09\0\0\0\x02\x01\0\0\x03\x21\x22\x23\0\0\x01"s;
  expect_equal(decode_image(packed_bmp(rows)), (cv::Mat_<std::uint8_t>(2, 5) << 0, 0x21, 0x22, 0x23, 0, 7, 7, 7, 7, 9),
               "RLE8");
  // From the bottom: three of 7 and 1 by turns, two of 9; then one step to the right, three as they are.
  const std::string half_rows = "\x03\x71\x02\x99\0\0\0\x02\x01\0\0\x03\x12\x30\0\x01"s;
  expect_equal(decode_image(packed_bmp(half_rows, 2, 4)),
               (cv::Mat_<std::uint8_t>(2, 5) << 0, 1, 2, 3, 0, 7, 1, 7, 9, 9), "RLE4");
}

TEST(DecodeBmp, RefusesRunsThatLeaveTheImageOrBreakOff) {
  using namespace std::string_literals;
  for (const std::string& rows : {"\x06\x07\0\x01"s, "\x05\x07"s, "\0\x05\x01\x02"s, "\0\x02\x01"s,
                                  "\0\x02\0\x02\x01\x07\0\x01"s, "\0\x02\x09\0\x01\x07\0\x01"s})
    EXPECT_TRUE(decode_image(packed_bmp(rows)).empty());
}

TEST(ImageFileFault, NamesACompressionThatIsNotRead) {
  EXPECT_EQ(detail::image_file_fault(packed_bmp("", 2)),
            "is a bitmap of a compression that is not read, expected none, RLE4 or RLE8");
  EXPECT_EQ(detail::image_file_fault(packed_bmp("", 1)), "");
}

TEST(IsTooLarge, KnowsWhatBytesCanHold) {
  EXPECT_FALSE(detail::is_too_large(1242.0, 375.0, 100)) << "one level, deflated";
  EXPECT_TRUE(detail::is_too_large(1242.0, 375.0, 50));
  EXPECT_TRUE(detail::is_too_large(30000.0, 30000.0, 114)) << "found by fuzzing: a TIFF that asked for 3.5 GB";
  EXPECT_TRUE(detail::is_too_large(1e5, 1e5, std::size_t{1} << 30));
}

TEST(DecodeImage, ReadsTextPixmaps) {
  const cv::Mat bits = decode_image("P1\n3 2\n101\n0 1 0\n");
  expect_equal(bits, (cv::Mat_<std::uint8_t>(2, 3) << 0, 255, 0, 255, 0, 255), "P1");
  const cv::Mat colors = decode_image("P3 # red, then blue\n2 1 255\n250 1 2  3 4 240\n");
  EXPECT_EQ(colors.at<cv::Vec3b>(0, 0), (cv::Vec3b{2, 1, 250}));
  EXPECT_EQ(colors.at<cv::Vec3b>(0, 1), (cv::Vec3b{240, 4, 3}));
}

/// A file of libpng's with a palette of four greens, two bits a pixel.
std::vector<std::uint8_t> palette_png(const std::vector<std::uint8_t>& indices, int width, int height) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::vector<std::uint8_t> bytes;
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, std::size_t count) {
        auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
        out.insert(out.end(), data, data + count);
      },
      nullptr);
  const std::vector<png_color> palette{{0, 10, 1}, {0, 20, 1}, {0, 30, 1}, {0, 40, 1}};
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 2, PNG_COLOR_TYPE_PALETTE,
               PNG_INTERLACE_ADAM7, PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
  png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  png_set_packing(png);
  std::vector<png_bytep> rows;
  for (int v = 0; v < height; ++v) rows.push_back(const_cast<png_bytep>(indices.data() + v * width));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

TEST(DecodeImage, ReadsInterlacedPngWithPalette) {
  const auto bytes = palette_png({0, 1, 2, 3, 3, 2, 1, 0, 1, 1, 2, 2}, 4, 3);
  const cv::Mat image = decode_image(view_of(bytes));
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.at<cv::Vec3b>(1, 0), (cv::Vec3b{1, 40, 0}));
  EXPECT_EQ(image.at<cv::Vec3b>(2, 3), (cv::Vec3b{1, 30, 0}));
}

/// Writes a TIFF file of one grey channel, in tiles of 16 x 16 px where `tiled`.
void write_tiff(const std::string& path, const cv::Mat& image, int photometric, bool tiled) {
  TIFF* const file = TIFFOpen(path.c_str(), "w");
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, image.cols);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, image.rows);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, static_cast<int>(8 * image.elemSize1()));
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, photometric);
  TIFFSetField(file, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
  constexpr int kTile_px = 16;
  if (tiled) {
    TIFFSetField(file, TIFFTAG_TILEWIDTH, kTile_px);
    TIFFSetField(file, TIFFTAG_TILELENGTH, kTile_px);
    for (int v = 0; v < image.rows; v += kTile_px)
      for (int u = 0; u < image.cols; u += kTile_px) {
        cv::Mat tile(kTile_px, kTile_px, image.type(), cv::Scalar(0));
        const cv::Rect inside(u, v, std::min(kTile_px, image.cols - u), std::min(kTile_px, image.rows - v));
        image(inside).copyTo(tile(cv::Rect(0, 0, inside.width, inside.height)));
        TIFFWriteTile(file, tile.data, static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v), 0, 0);
      }
  } else {
    for (int v = 0; v < image.rows; ++v)
      TIFFWriteScanline(file, const_cast<std::uint8_t*>(image.ptr(v)), static_cast<std::uint32_t>(v), 0);
  }
  TIFFClose(file);
}

TEST(DecodeImage, ReadsTiledAndInvertedTiff) {
  const TemporaryFolder folder;
  for (const int type : {CV_8UC1, CV_16UC1}) {
    const cv::Mat image = noise(type);
    write_tiff(folder.file("tiled.tif"), image, PHOTOMETRIC_MINISBLACK, true);
    expect_equal(decode_image(read_all(folder.file("tiled.tif"))), image, "tiled");
    write_tiff(folder.file("inverted.tif"), image, PHOTOMETRIC_MINISWHITE, false);
    cv::Mat inverted;
    cv::bitwise_not(image, inverted);
    expect_equal(decode_image(read_all(folder.file("inverted.tif"))), inverted, "inverted");
  }
}

/// A TIFF file of one grey channel with so many bits, one pixel behind the other.
void write_packed_tiff(const std::string& path, const cv::Mat& image, int bits, int photometric) {
  TIFF* const file = TIFFOpen(path.c_str(), "w");
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, image.cols);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, image.rows);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, bits);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, photometric);
  TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, 7);
  for (int v = 0; v < image.rows; ++v) {
    std::vector<std::uint8_t> row(static_cast<std::size_t>((image.cols * bits + 7) / 8));
    for (int bit = 0; bit < image.cols * bits; ++bit) {
      const int level = image.at<std::uint16_t>(v, bit / bits);
      if ((level >> (bits - 1 - bit % bits) & 1) != 0)
        row[static_cast<std::size_t>(bit / 8)] |= static_cast<std::uint8_t>(128 >> bit % 8);
    }
    TIFFWriteScanline(file, row.data(), static_cast<std::uint32_t>(v), 0);
  }
  TIFFClose(file);
}

TEST(DecodeImage, ReadsTiffOfTenToFourteenBits) {
  const TemporaryFolder folder;
  for (const int bits : {10, 12, 14}) {
    cv::Mat image = noise(CV_16UC1);
    image /= 1 << (16 - bits);
    cv::min(image, (1 << bits) - 1, image);
    write_packed_tiff(folder.file("a.tif"), image, bits, PHOTOMETRIC_MINISBLACK);
    expect_equal(decode_image(read_all(folder.file("a.tif"))), image, std::to_string(bits));
    write_packed_tiff(folder.file("b.tif"), image, bits, PHOTOMETRIC_MINISWHITE);
    const cv::Mat inverted = cv::Scalar((1 << bits) - 1) - image;
    expect_equal(decode_image(read_all(folder.file("b.tif"))), inverted, std::to_string(bits));
  }
}

/// A bitmap of Windows with a palette of as many greys, from black to white, as its bits have room for.
std::string palette_bmp(const cv::Mat& indices, int bits) {
  const int colors = 1 << bits, row_bytes = (indices.cols * bits + 31) / 32 * 4, start = 54 + 4 * colors;
  const auto number = [](int value, int bytes) { return flies::number(static_cast<std::size_t>(value), bytes); };
  std::string file = "BM" + number(start + row_bytes * indices.rows, 4) + number(0, 4) + number(start, 4) +
                     number(40, 4) + number(indices.cols, 4) + number(indices.rows, 4) + number(1, 2) +
                     number(bits, 2) + number(0, 24);
  for (int i = 0; i < colors; ++i) {
    const int level = 255 * i / (colors - 1);
    file += number(level, 1) + number(level, 1) + number(level, 1) + number(0, 1);
  }
  for (int v = indices.rows - 1; v >= 0; --v) {
    std::string row(static_cast<std::size_t>(row_bytes), '\0');
    for (int u = 0; u < indices.cols; ++u)
      row[static_cast<std::size_t>(u * bits / 8)] |=
          static_cast<char>(indices.at<std::uint8_t>(v, u) << (8 - bits - u * bits % 8));
    file += row;
  }
  return file;
}

TEST(DecodeImage, ReadsBitmapsWithPaletteAsGray) {
  for (const int bits : {1, 4, 8}) {
    const cv::Mat indices = noise(CV_8UC1) / (1 << (8 - bits)) & ((1 << bits) - 1);
    const std::string file = palette_bmp(indices, bits);
    const cv::Mat found = decode_image(file);
    cv::Mat opencv = cv::imdecode(std::vector<char>(file.begin(), file.end()), cv::IMREAD_GRAYSCALE);
    expect_equal(found, opencv, std::to_string(bits));
    EXPECT_TRUE(decode_image(file.substr(0, file.size() - 1)).empty()) << bits;
  }
}

TEST(DecodeImage, OfAWebpThatBreaksOffIsEmpty) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".webp", noise(CV_8UC3), bytes));
  EXPECT_TRUE(decode_image(view_of(bytes).substr(0, bytes.size() / 2)).empty());
}

TEST(DecodeImage, IsEmptyForWhatNobodyCanRead) {
  ::testing::internal::CaptureStderr();
  for (const char* const bytes : {"", "text", "\x89PNG\r\n\x1a\n and no more", "\xFF\xD8\xFF and no more",
                                  "P5 0 0 255 ", "P5 5 5 70000 ", "II*", "MM and no more"})
    EXPECT_TRUE(decode_image(bytes).empty()) << bytes;
  using namespace std::string_view_literals;
  EXPECT_TRUE(decode_image("II*\0 and no directory"sv).empty());
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(EncodePng, LosesNothing) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3}) {
    const cv::Mat image = noise(type);
    for (const bool is_small : {false, true})
      expect_equal(cv::imdecode(encode_png(image, is_small), cv::IMREAD_UNCHANGED), image, std::to_string(type));
  }
}

TEST(EncodeJpeg, IsWhatOpencvWrites) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    cv::Mat image;
    cv::GaussianBlur(noise(type), image, {0, 0}, 3.0);
    std::vector<std::uint8_t> theirs;
    cv::imencode(".jpg", image, theirs, {cv::IMWRITE_JPEG_QUALITY, 90});
    expect_equal(cv::imdecode(encode_jpeg(image, 90), cv::IMREAD_UNCHANGED), cv::imdecode(theirs, cv::IMREAD_UNCHANGED),
                 std::to_string(type));
  }
}

TEST(DecodeImage, RefusesAJpegWhoseDataBrokeOffBeforeItsEnd) {
  cv::Mat image(96, 128, CV_8U);
  cv::randu(image, 0, 256);
  const auto bytes = encode_jpeg(image, 90);
  const std::string whole(bytes.begin(), bytes.end());
  ASSERT_FALSE(decode_image(whole).empty());
  const std::string cut = whole.substr(0, whole.size() / 2) + "\xFF\xD9";
  EXPECT_TRUE(decode_image(cut).empty());
}

TEST(DecodeImage, OfAPnmThatBreaksOffIsEmpty) {
  for (const char* start :
       {"P5 4 4 255 abc", "P6 2 2 255 abcdef", "P5 2 2 65535 abcdefg", "P4 9 3 abcde", "P5 4 4 255"})
    EXPECT_TRUE(decode_image(start).empty()) << start;
}

}  // namespace
}  // namespace flies
