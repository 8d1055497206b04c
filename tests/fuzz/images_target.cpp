#include <opencv2/core.hpp>

#include "flies/io/image_codecs.hpp"
#include "tests/fuzz/target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  flies::decode_image({reinterpret_cast<const char*>(data), size});
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  const auto text = [](const std::vector<std::uint8_t>& bytes) { return std::string(bytes.begin(), bytes.end()); };
  std::vector<std::string> seeds;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    cv::Mat image(9, 13, type);
    cv::randu(image, 0, 256);
    seeds.push_back(text(flies::encode_png(image)));
    if (image.depth() == CV_8U) seeds.push_back(text(flies::encode_jpeg(image, 80)));
  }
  const std::string pixels = "0123456789abcdef0123456789abcdef";
  seeds.insert(seeds.end(), {"P5\n4 3\n255\n" + pixels, "P6\n2 2\n65535\n" + pixels, "P4\n9 2\n" + pixels,
                             "P2\n2 2\n9\n1 2 3 4\n", "P1\n3 1\n101\n",
                             // 40 bytes that asked for gigabytes before the first pixel was read.
                             "P3\n32000 32000\n255\n1 2 3 4 5 6 7 8 9\n"});
  // A little-endian TIFF of 2 x 2 grey pixels: width, height, bits, compression, photometric, strip, rows, bytes.
  std::string tiff("II*\0\x08\0\0\0\x08\0", 10);
  const auto entry = [&](int tag, int type, int value) {
    for (const int part : {tag & 255, tag >> 8, type, 0, 1, 0, 0, 0, value & 255, value >> 8, 0, 0})
      tiff.push_back(static_cast<char>(part));
  };
  entry(256, 3, 2), entry(257, 3, 2), entry(258, 3, 8), entry(259, 3, 1), entry(262, 3, 1), entry(273, 4, 110);
  entry(278, 3, 2), entry(279, 4, 4);
  seeds.push_back(tiff + std::string("\0\0\0\0abcd", 8));
  // A bitmap of Windows of 2 x 2 pixels, 24 bits each.
  std::string bitmap = "BM";
  for (const int number : {70, 0, 54, 40, 2, 2, 1 | 24 << 16, 0, 16, 0, 0, 0, 0})
    for (int i = 0; i < 4; ++i) bitmap.push_back(static_cast<char>(number >> 8 * i & 255));
  seeds.push_back(bitmap + pixels);
  // A JPEG with an orientation.
  std::string turned = seeds[1];
  turned.insert(2, std::string("\xFF\xE1\0\x22"
                               "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
                               36));
  seeds.push_back(turned);
  return seeds;
}
