#pragma once

#include <string>

#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// Where the size of a camera's images is looked for.
struct SizeQuery {
  std::string camera_key;                     ///< of a number of the camera: sizes beside it are its own
  double cx_px = 0.0, cy_px = 0.0;            ///< sizes of other things, as of a board, do not have it within
  int said_width_px = 0, said_height_px = 0;  ///< of several sizes the user says this one; 0: none
};

/// width and height, or both in one: resolution: [640, 480], image_size: 640x480, image_shape: [480, 640]; 0 x 0 when
/// the file has none.
/// @throws InputError when it has only one, when two places say different things, or no size can be read
ImageSize size_in(const NumberTable& table, const SizeQuery& query);

/// The size that a file was found to have, unless its other keys say another.
/// @throws InputError when they do, and the user does not say which is meant
ImageSize agreed_size(const NumberTable& table, ImageSize found, const SizeQuery& query);

}  // namespace flies::detail
