#include "flies/io/image_borders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>

#include "flies/core/error.hpp"

namespace flies {
namespace {

/// Levels of a border that was compressed, as JPEG does it.
constexpr int kOneLevel_gray = 6;

bool is_of_one_level(const GrayView& image, int first_u, int end_u, int first_v, int end_v) {
  std::uint8_t least = 255, most = 0;
  for (int v = first_v; v < end_v; ++v) {
    const auto [low, high] = std::minmax_element(image.row(v) + first_u, image.row(v) + end_u);
    least = std::min(least, *low);
    most = std::max(most, *high);
  }
  return most - least <= kOneLevel_gray;
}

/// Whether a line is of the one level that the nearer edge of the image begins with: what is behind a border may be
/// plain, too, as sky is.
bool is_level_row(const GrayView& image, int v, int) {
  const int edge_v = 2 * v < image.height_px ? 0 : image.height_px - 1;
  return std::abs(image.row(v)[0] - image.row(edge_v)[0]) <= kOneLevel_gray &&
         is_of_one_level(image, 0, image.width_px, v, v + 1);
}
bool is_level_column(const GrayView& image, int u, int, int first_v, int end_v) {
  const int edge_u = 2 * u < image.width_px ? 0 : image.width_px - 1;
  return std::abs(image.row(first_v)[u] - image.row(first_v)[edge_u]) <= kOneLevel_gray &&
         is_of_one_level(image, u, u + 1, first_v, end_v);
}

/// Whether a line is the same as the next one towards the middle.
bool is_repeated_row(const GrayView& image, int v, int next_v) {
  return std::equal(image.row(v), image.row(v) + image.width_px, image.row(next_v));
}
bool is_repeated_column(const GrayView& image, int u, int next_u, int first_v, int end_v) {
  for (int v = first_v; v < end_v; ++v)
    if (image.row(v)[u] != image.row(v)[next_u]) return false;
  return true;
}

/// Borders of lines that are empty in both images, by what says so of a line and the next one towards the middle.
template <class IsEmptyRow, class IsEmptyColumn>
ImageBorders borders_of(const RectifiedPair& pair, const IsEmptyRow& is_empty_row,
                        const IsEmptyColumn& is_empty_column) {
  const int last_u = pair.left.width_px - 1, last_v = pair.left.height_px - 1;
  ImageBorders borders;
  const auto row_is_empty = [&](int v, int next_v) {
    return is_empty_row(pair.left, v, next_v) && is_empty_row(pair.right, v, next_v);
  };
  while (borders.top_px < last_v && row_is_empty(borders.top_px, borders.top_px + 1)) ++borders.top_px;
  if (borders.top_px == last_v) return {};
  while (row_is_empty(last_v - borders.bottom_px, last_v - borders.bottom_px - 1) &&
         borders.top_px + borders.bottom_px < last_v)
    ++borders.bottom_px;
  const int first_v = borders.top_px, end_v = last_v + 1 - borders.bottom_px;
  const auto column_is_empty = [&](int u, int next_u) {
    return is_empty_column(pair.left, u, next_u, first_v, end_v) &&
           is_empty_column(pair.right, u, next_u, first_v, end_v);
  };
  while (borders.left_px < last_u && column_is_empty(borders.left_px, borders.left_px + 1)) ++borders.left_px;
  if (borders.left_px == last_u) return {};
  while (borders.left_px + borders.right_px < last_u &&
         column_is_empty(last_u - borders.right_px, last_u - borders.right_px - 1))
    ++borders.right_px;
  return borders;
}

/// One side of an image, seen from outside: `along` its edge and `inwards` from it.
struct ImageSide {
  int border_px = 0;
  int length_px = 0;  ///< of its edge
  std::function<int(int along, int inwards)> level;
};

/// Left, right, top and bottom.
std::array<ImageSide, 4> sides_of(const GrayView& image, const ImageBorders& borders) {
  const int last_u = image.width_px - 1, last_v = image.height_px - 1;
  return {
      ImageSide{borders.left_px, image.height_px, [=](int along, int inwards) { return image.row(along)[inwards]; }},
      ImageSide{borders.right_px, image.height_px,
                [=](int along, int inwards) { return image.row(along)[last_u - inwards]; }},
      ImageSide{borders.top_px, image.width_px, [=](int along, int inwards) { return image.row(inwards)[along]; }},
      ImageSide{borders.bottom_px, image.width_px,
                [=](int along, int inwards) { return image.row(last_v - inwards)[along]; }}};
}

/// Whether the picture begins along all of a border's inner edge.
/// @param from, end of the edge, without the borders at its ends
bool is_straight(const ImageSide& side, int from, int end) {
  constexpr int kDeep_px = 6;
  constexpr double kMost = 0.75;  // dark places touch the border too
  const int border_level = side.level(from, 0);
  int begun = 0;
  for (int along = from; along < end; ++along) {
    bool differs = false;
    for (int inwards = side.border_px; inwards < side.border_px + kDeep_px; ++inwards)
      differs = differs || std::abs(side.level(along, inwards) - border_level) > kOneLevel_gray;
    begun += differs;
  }
  return begun > kMost * (end - from);
}

/// Whether both of two opposite sides have a straight border of this level.
bool are_bars(const ImageSide& one, const ImageSide& other, int from, int end, int across_px, int level) {
  constexpr double kLeast = 0.01;  // of the image, at each side
  constexpr int kStep_px = 8;
  const auto is_bar = [&](const ImageSide& side) {
    for (int along = from; along < end; along += kStep_px)
      for (int inwards = 0; inwards < side.border_px; ++inwards)
        if (std::abs(side.level(along, inwards) - level) > kOneLevel_gray) return false;
    return is_straight(side, from, end);
  };
  const int thinner_px = std::min(one.border_px, other.border_px);
  return thinner_px >= std::max(2.0, kLeast * across_px) && is_bar(one) && is_bar(other);
}

}  // namespace

ImageBorders find_borders(const RectifiedPair& pair) {
  // Coarse pictures repeat lines of their own, so that such are borders only where nothing else is one.
  const ImageBorders of_one_level = borders_of(pair, is_level_row, is_level_column);
  return of_one_level.any() ? of_one_level : borders_of(pair, is_repeated_row, is_repeated_column);
}

std::optional<std::string> borders_note(const RectifiedPair& images) {
  const ImageBorders borders = find_borders(images);
  if (!borders.any()) return std::nullopt;
  const auto inner = detail::inside(borders, {images.left.width_px, images.left.height_px});
  bool at_left_and_right = true, at_top_and_bottom = true;
  for (const GrayView* image : {&images.left, &images.right}) {
    constexpr int kLeft = 0, kRight = 1, kTop = 2, kBottom = 3;
    const auto sides = sides_of(*image, borders);
    const int level = image->row(0)[0];
    at_left_and_right = at_left_and_right && are_bars(sides[kLeft], sides[kRight], borders.top_px,
                                                      borders.top_px + inner.height_px, image->width_px, level);
    at_top_and_bottom = at_top_and_bottom && are_bars(sides[kTop], sides[kBottom], borders.left_px,
                                                      borders.left_px + inner.width_px, image->height_px, level);
  }
  if (!at_left_and_right && !at_top_and_bottom) return std::nullopt;
  const auto wrong = at_left_and_right && at_top_and_bottom
                         ? fmt::format("ranges are up to {:.3g} times too large",
                                       static_cast<double>(images.left.width_px) / inner.width_px)
                         : std::string("ranges or heights are wrong");
  return fmt::format(
      "both images have straight borders of one grey level (left {}, right {}, top {}, bottom {} px): if the pictures "
      "were shrunk to make room for these after the calibration, as letterboxing does, {}; then cut the borders off. "
      "If "
      "the borders only cover parts of the pictures, or were there when the cameras were calibrated, all is well",
      borders.left_px, borders.right_px, borders.top_px, borders.bottom_px, wrong);
}

detail::PixelSize detail::inside(const ImageBorders& borders, const PixelSize& images) {
  return {images.width_px - borders.left_px - borders.right_px, images.height_px - borders.top_px - borders.bottom_px};
}

void detail::check_not_padded(const ImageBorders& borders, const PixelSize& images, const PixelSize& calibrated,
                              const std::string& source) {
  constexpr double kOfWhole_px = 1.0, kOfInside_px = 2.0;  // by which heights may miss a scale
  if (!borders.any() || calibrated.width_px <= 0 || images == calibrated) return;
  const PixelSize inner = inside(borders, images);
  const auto is_scaled = [&](const PixelSize& size, double within_px) {
    const double height_px = static_cast<double>(calibrated.height_px) * size.width_px / calibrated.width_px;
    return std::abs(size.height_px - height_px) <= within_px;
  };
  if (inner != calibrated && (is_scaled(images, kOfWhole_px) || !is_scaled(inner, kOfInside_px))) return;
  throw InputError(
      source, "image size",
      fmt::format("the calibration is for {} x {} px, the images have {} x {} px with borders that show nothing (left "
                  "{}, right {}, top {}, bottom {} px): both images were padded or letterboxed. What is inside the "
                  "borders, {} x {} px, has the shape of the calibration's size: cut the borders off",
                  calibrated.width_px, calibrated.height_px, images.width_px, images.height_px, borders.left_px,
                  borders.right_px, borders.top_px, borders.bottom_px, inner.width_px, inner.height_px));
}

}  // namespace flies
