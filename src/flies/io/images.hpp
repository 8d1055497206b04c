#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flies/io/gray_image.hpp"
#include "flies/io/mosaic.hpp"
#include "flies/io/pair_source.hpp"

namespace flies {

/// The smallest image in which the method's neighbourhoods find anything.
inline constexpr int kMinImageWidth_px = 64;
inline constexpr int kMinImageHeight_px = 48;

/// Reads one image as 8-bit grey: PNG, JPEG, PGM/PPM, TIFF, WebP or BMP with 8 to 16 bits, grey or colour, with or
/// without alpha (ignored). It is turned as its EXIF orientation says. Colour becomes grey with the weights of ITU-R
/// BT.601; 16 bits are scaled as in `load_pair`.
/// @throws InputError naming the file: missing, a folder, not an image, truncated or damaged, floating point, smaller
///         than the least size, a single grey level throughout
GrayImage load_gray_image(const std::string& path, int min_width_px = kMinImageWidth_px,
                          int min_height_px = kMinImageHeight_px);

/// Reads the two images of a pair. Files with 16 bits hold anything from 9 to 16 significant ones; both images are
/// shifted by the same number of bits, the smallest that fits the larger maximum of the two into 8, so that equal
/// light stays equal grey. Where fewer than 160 grey levels are left, also of files with 8 bits, because of a hot pixel
/// or because the scene fills a narrow band of levels (fog, thermal cameras), both are stretched alike from the 0.1 %
/// darkest to the 0.1 % brightest pixels; fewer than 16, and images that are mostly noise, are left as they are. Each
/// is stretched by its own levels where those of both hardly overlap: cameras with different offsets or significant
/// bits.
/// @throws InputError for the faults of `load_gray_image`, for sizes or bit depths that differ, and for one image given
///         twice
GrayPair load_pair(const std::string& left_path, const std::string& right_path);

/// Stretches both images of a pair of 8 bits that was not read here, such as a camera's, as `load_pair` does.
void stretch_faint(GrayPair& images);

/// What to tell the user of a pair as it was read, before it is rectified: that it is the raw mosaic of colour cameras,
/// or has borders as padding adds them.
std::vector<std::string> notes_on_images(const RectifiedPair& images);

/// How one file holds both images of a pair.
enum class Split { none, side_by_side, top_bottom };

/// "none", "side" (also "side-by-side", "lr") or "top" (also "top-bottom", "tb"). @returns nothing for other words
std::optional<Split> split_of(const std::string& word);

/// How the files of a pair hold its images.
struct PairReading {
  Split split = Split::none;  ///< of one file, left and right of the paths; the left (upper) half is left
  std::optional<BayerPattern> bayer =
      {};  ///< the files are mosaics of this pattern: of whole files, as they are turned
};

/// Reads a pair as `load_pair(left, right)` does, from files that hold it in this way.
/// @throws InputError as that, when halves differ in size, and when a mosaic has colours
GrayPair load_pair(const PairPaths& paths, const PairReading& reading);

}  // namespace flies
