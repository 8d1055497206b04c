#include "flies/core/usable_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

void pack(GrayView& image, const char* name) {
  if (image.stride == 0) image.stride = image.width_px;
  if (image.stride < image.width_px)
    throw InputError(name, "stride",
                     fmt::format("found {} bytes, expected at least the width of {}, or 0 for rows without a gap",
                                 image.stride, image.width_px));
}

}  // namespace

RectifiedPair usable_pair(RectifiedPair pair) {
  pack(pair.left, "left image");
  pack(pair.right, "right image");
  check_pair(pair);
  return pair;
}

bool is_one_image_twice(const RectifiedPair& pair) {
  for (int v = 0; v < pair.left.height_px; ++v)
    if (std::memcmp(pair.left.row(v), pair.right.row(v), static_cast<std::size_t>(pair.left.width_px)) != 0)
      return false;
  const GrayView& image = pair.left;
  for (int v = 0; v < image.height_px; ++v)
    if (std::any_of(image.row(v), image.row(v) + image.width_px,
                    [&](std::uint8_t level) { return level != *image.data; }))
      return true;
  return false;
}

}  // namespace flies::detail
