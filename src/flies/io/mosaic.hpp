#pragma once

#include <optional>
#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/io/gray_image.hpp"

namespace cv {
class Mat;
}

namespace flies {

/// Colours of the first two pixels of the first two rows of a Bayer mosaic.
enum class BayerPattern { rggb, bggr, grbg, gbrg };

/// "rggb", "bggr", "grbg" or "gbrg". @returns nothing for other words
std::optional<BayerPattern> bayer_pattern_of(const std::string& word);

/// Grey levels of a mosaic, each pixel by its neighbours (OpenCV's bilinear interpolation).
/// @param mosaic one channel of 8 or 16 bits
cv::Mat demosaiced(const cv::Mat& mosaic, BayerPattern pattern);
GrayImage demosaiced(GrayImage mosaic, BayerPattern pattern);

/// Which two patterns the mosaic of an image can have: red and blue look the same.
enum class MosaicGreens {
  beside,  ///< green on the second pixel of the first row: rggb or bggr
  first,   ///< green on the first pixel: grbg or gbrg
};

MosaicGreens greens_of(BayerPattern pattern);

/// The two patterns with these greens, in words.
const char* patterns_of(MosaicGreens greens);

/// Whether the image is a Bayer mosaic that was taken for a grey image. In squares of 2 x 2 pixels the difference of
/// the diagonals then goes on from square to square, because colours do; in images it changes at random (correlations
/// over 300 images below 0.1, of mosaics made from 16 colour images above 0.2).
std::optional<MosaicGreens> recognise_mosaic(const GrayView& image);

/// What to tell the user of a pair as it was read, before it is rectified; nothing when neither image is a mosaic.
std::optional<std::string> mosaic_note(const RectifiedPair& pair);

}  // namespace flies
