#pragma once

#include <string>
#include <vector>

namespace flies {

/// The files of one pair.
struct PairPaths {
  std::string left;
  std::string right;
};

/// Finds the pairs: two files are one pair; the images of two folders pair up by equal names, else by times that the
/// names are, else in name order, in which numbers count as numbers (frame_9 before frame_10). Files that are not
/// images by their extension (png, jpg, jpeg, pgm, ppm, pnm, tif, tiff, webp, bmp) and hidden files are passed over.
/// @throws InputError when one is a file and the other a folder, a folder cannot be read or holds no images, the counts
///         differ, or either does not exist
std::vector<PairPaths> find_pairs(const std::string& left, const std::string& right);

/// Files that hold both images of a pair each: `path`, or the images of that folder in name order. Left and right are
/// the same file (`PairReading::split`).
/// @throws InputError when it does not exist, or is a folder that cannot be read or holds no images
std::vector<PairPaths> find_joined_pairs(const std::string& path);

}  // namespace flies
