#include "flies/io/exif.hpp"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "flies/io/image_codecs.hpp"
#include "flies/io/images.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/test_data.hpp"

namespace flies {
namespace {

using namespace std::string_literals;

/// The smallest EXIF data: a directory of two entries, of which the second is the orientation.
std::string exif(int orientation, bool is_big_endian) {
  const char o = static_cast<char>(orientation);
  if (is_big_endian)
    return "MM\0*\0\0\0\x08\0\x02\x01\x0f\0\x02\0\0\0\x04"
           "abc\0\x01\x12\0\x03\0\0\0\x01\0"s +
           o + "\0\0\0\0\0\0"s;
  return "II*\0\x08\0\0\0\x02\0\x0f\x01\x02\0\x04\0\0\0"
         "abc\0\x12\x01\x03\0\x01\0\0\0"s +
         o + "\0\0\0\0\0\0\0"s;
}

std::string number(std::size_t value, int count, bool is_big_endian) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * (is_big_endian ? count - 1 - i : i) & 0xFF);
  return bytes;
}

std::string encoded(const std::string& extension, const cv::Mat& image, const std::vector<int>& how = {}) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes, how));
  return {bytes.begin(), bytes.end()};
}

std::string jpeg_with(const std::string& exif_data, const cv::Mat& image) {
  const std::string data = "Exif\0\0"s + exif_data;
  return encoded(".jpg", image).insert(2, "\xFF\xE1"s + number(data.size() + 2, 2, true) + data);
}

std::string png_with(const std::string& exif_data, const cv::Mat& image) {
  constexpr std::size_t kBehindHeader = 33;
  return encoded(".png", image)
      .insert(kBehindHeader, number(exif_data.size(), 4, true) + "eXIf"s + exif_data + "\0\0\0\0"s);
}

/// The simple format, made the extended one with EXIF data behind the image.
std::string webp_with(const std::string& exif_data, const cv::Mat& image) {
  constexpr int kLossless = 101;
  const std::string simple = encoded(".webp", image, {cv::IMWRITE_WEBP_QUALITY, kLossless});
  const std::string extended = "VP8X"s + number(10, 4, false) + "\x08\0\0\0"s +
                               number(static_cast<std::size_t>(image.cols) - 1, 3, false) +
                               number(static_cast<std::size_t>(image.rows) - 1, 3, false);
  const std::string body =
      "WEBP"s + extended + simple.substr(12) + "EXIF"s + number(exif_data.size(), 4, false) + exif_data;
  return "RIFF"s + number(body.size(), 4, false) + body;
}

std::string tiff_with(int orientation, const cv::Mat& image, const std::string& mode, int photometric) {
  const testing::TemporaryFolder folder;
  TIFF* const file = TIFFOpen(folder.file("a.tif").c_str(), mode.c_str());
  TIFFSetField(file, TIFFTAG_IMAGEWIDTH, image.cols);
  TIFFSetField(file, TIFFTAG_IMAGELENGTH, image.rows);
  TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(file, TIFFTAG_PHOTOMETRIC, photometric);
  TIFFSetField(file, TIFFTAG_ORIENTATION, orientation);
  std::vector<std::uint16_t> levels(256);
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i] = static_cast<std::uint16_t>(i * 257);
  if (photometric == PHOTOMETRIC_PALETTE)
    TIFFSetField(file, TIFFTAG_COLORMAP, levels.data(), levels.data(), levels.data());
  for (int v = 0; v < image.rows; ++v)
    TIFFWriteScanline(file, const_cast<std::uint8_t*>(image.ptr(v)), static_cast<std::uint32_t>(v), 0);
  TIFFClose(file);
  return testing::read_all(folder.file("a.tif"));
}

/// Where the top left corner of an image is stored and along what its first row runs (EXIF 2.3, table of tag 0x0112).
cv::Mat stored_as(int orientation) {
  switch (orientation) {
    case 2:
      return (cv::Mat_<std::uint8_t>(2, 3) << 3, 2, 1, 6, 5, 4);
    case 3:
      return (cv::Mat_<std::uint8_t>(2, 3) << 6, 5, 4, 3, 2, 1);
    case 4:
      return (cv::Mat_<std::uint8_t>(2, 3) << 4, 5, 6, 1, 2, 3);
    case 5:
      return (cv::Mat_<std::uint8_t>(3, 2) << 1, 4, 2, 5, 3, 6);
    case 6:
      return (cv::Mat_<std::uint8_t>(3, 2) << 3, 6, 2, 5, 1, 4);
    case 7:
      return (cv::Mat_<std::uint8_t>(3, 2) << 6, 3, 5, 2, 4, 1);
    case 8:
      return (cv::Mat_<std::uint8_t>(3, 2) << 4, 1, 5, 2, 6, 3);
    default:
      return (cv::Mat_<std::uint8_t>(2, 3) << 1, 2, 3, 4, 5, 6);
  }
}

cv::Mat first_channel(const cv::Mat& image) {
  cv::Mat channel;
  cv::extractChannel(image, channel, 0);
  return channel;
}

void expect_seen(const std::string& bytes, int orientation, const std::string& what) {
  ASSERT_EQ(detail::stored_orientation(bytes), orientation) << what;
  const cv::Mat seen = decode_image(bytes);
  ASSERT_EQ(seen.size(), cv::Size(3, 2)) << what;
  constexpr double kCompression_gray = 2.0;  // of JPEG; neighbours differ by 40
  EXPECT_LE(cv::norm(first_channel(seen), 40 * stored_as(1), cv::NORM_INF), kCompression_gray)
      << what << " orientation " << orientation;
}

TEST(DecodeImage, TurnsWhatIsStoredOtherwiseThanSeen) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const cv::Mat stored = 40 * stored_as(orientation);
    for (const bool is_big_endian : {false, true}) {
      const auto data = exif(orientation, is_big_endian);
      expect_seen(jpeg_with(data, stored), orientation, "JPEG");
      expect_seen(webp_with(data, stored), orientation, "WebP");
    }
    for (const int photometric : {PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_PALETTE})
      for (const char* const mode : {"wb", "wl", "w8"})
        expect_seen(tiff_with(orientation, stored, mode, photometric), orientation, "TIFF");
  }
}

TEST(StoredOrientation, IsReadFromPng) {
  for (int orientation = 1; orientation <= 8; ++orientation)
    expect_seen(png_with(exif(orientation, true), 40 * stored_as(orientation)), orientation, "PNG");
}

TEST(StoredOrientation, IsAsSeenWhereExifDataAreBroken) {
  const cv::Mat image = stored_as(1);
  for (std::size_t length = 0; length < exif(6, true).size() - 4; length += 3)
    EXPECT_EQ(detail::stored_orientation(jpeg_with(exif(6, true).substr(0, length), image)), length < 32 ? 1 : 6)
        << length;
  EXPECT_EQ(detail::stored_orientation(jpeg_with(exif(9, false), image)), 1);
  EXPECT_EQ(detail::stored_orientation(jpeg_with("MM\0*\xFF\xFF\xFF\xF0"s, image)), 1);
  EXPECT_EQ(detail::stored_orientation("\xFF\xD8\xFF\xE1\xFF"s), 1);
  EXPECT_EQ(detail::stored_orientation("RIFF\0\0\0\0WEBPEXIF\xFF\xFF\xFF\xFF"s), 1);
}

TEST(LoadPair, TurnsPicturesOfCamerasThatHangOtherwise) {
  const auto folder = testing::find_data("reports/pictures");
  if (!folder) GTEST_SKIP() << testing::absence("reports/pictures");
  const auto pair = [&](const std::string& ending) {
    return load_pair((*folder / ("left" + ending)).string(), (*folder / ("right" + ending)).string());
  };
  const auto upside_down = pair("-exif3.jpg"), on_its_side = pair("-exif6.jpg");
  ASSERT_EQ(upside_down.left.width_px, on_its_side.left.width_px);
  ASSERT_EQ(upside_down.left.height_px, on_its_side.left.height_px);
  double difference = 0.0;
  for (std::size_t i = 0; i < upside_down.left.pixels.size(); ++i)
    difference += std::abs(upside_down.left.pixels[i] - on_its_side.left.pixels[i]);
  constexpr double kCompression_gray = 3.0;
  EXPECT_LT(difference / static_cast<double>(upside_down.left.pixels.size()), kCompression_gray);
}

}  // namespace
}  // namespace flies
