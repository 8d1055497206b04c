#pragma once

#include <optional>
#include <string>

#include "flies/core/gray_view.hpp"

namespace flies {

/// Rows and columns at the edges of both images that show nothing, as padding and letterboxing add them: of one level
/// throughout, or all like the outermost one of the picture.
struct ImageBorders {
  int left_px = 0, right_px = 0, top_px = 0, bottom_px = 0;

  bool any() const { return left_px + right_px + top_px + bottom_px > 0; }
};

/// @returns none for a pair that is of one level altogether
ImageBorders find_borders(const RectifiedPair& pair);

/// What to tell the user of a pair as it was read that has straight borders of one level at opposite sides: nothing
/// that lenses and rectification leave, but what is added to a picture that was calibrated without, maybe.
std::optional<std::string> borders_note(const RectifiedPair& images);

namespace detail {

struct PixelSize {
  int width_px = 0, height_px = 0;
  bool operator==(const PixelSize&) const = default;
};

/// What is left of images between their borders.
PixelSize inside(const ImageBorders& borders, const PixelSize& images);

/// Refuses images with borders without which they would be of the shape that the calibration is for: scaled with these,
/// all ranges would be wrong, and nothing would tell.
/// @param source of the calibration. @throws InputError
void check_not_padded(const ImageBorders& borders, const PixelSize& images, const PixelSize& calibrated,
                      const std::string& source);

}  // namespace detail

}  // namespace flies
