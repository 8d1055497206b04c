#include "flies/core/gray_view.hpp"

#include <fmt/format.h>

#include "flies/core/error.hpp"

namespace flies {

void check_pair(const RectifiedPair& pair, const std::string& left_name, const std::string& right_name) {
  const auto check_image = [](const GrayView& image, const std::string& name) {
    if (image.data == nullptr || image.width_px <= 0 || image.height_px <= 0)
      throw InputError(name, "size", "the image is empty");
    assert(image.stride >= image.width_px);
  };
  check_image(pair.left, left_name);
  check_image(pair.right, right_name);
  if (pair.left.width_px != pair.right.width_px || pair.left.height_px != pair.right.height_px)
    throw InputError(right_name, "size",
                     fmt::format("found {} x {} px, expected {} x {} px as in {}", pair.right.width_px,
                                 pair.right.height_px, pair.left.width_px, pair.left.height_px, left_name));
}

}  // namespace flies
