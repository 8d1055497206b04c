#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "flies/core/gray_view.hpp"

/// Pictures of pairs that the targets make up.
namespace flies::testing {

struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> pixels;

  GrayView view() const { return {pixels.data(), width_px, height_px, width_px}; }
};

/// Of one of several kinds: noise, blocks that stand out, one level, a slope.
inline Picture picture(unsigned kind, int width_px, int height_px, std::mt19937& random) {
  Picture made{width_px, height_px, {}};
  made.pixels.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  const auto level = static_cast<std::uint8_t>(random() & 255U);
  for (std::size_t i = 0; i < made.pixels.size(); ++i) {
    const auto u = static_cast<unsigned>(i) % static_cast<unsigned>(width_px);
    const auto v = static_cast<unsigned>(i) / static_cast<unsigned>(width_px);
    if (kind % 4 == 0)
      made.pixels[i] = static_cast<std::uint8_t>(random() & 255U);
    else if (kind % 4 == 1)
      made.pixels[i] = static_cast<std::uint8_t>(((u / 16 + v / 8) % 2) * 120 + (random() & 31U));
    else if (kind % 4 == 2)
      made.pixels[i] = level;
    else
      made.pixels[i] = static_cast<std::uint8_t>(u + v);
  }
  return made;
}

/// Moved to the left, as the right camera sees it.
/// @param disparity_px of the pixel (u, v)
template <class Disparity>
Picture moved(const Picture& from, const Disparity& disparity_px) {
  Picture to = from;
  for (int v = 0; v < from.height_px; ++v)
    for (int u = 0; u < from.width_px; ++u)
      to.pixels[static_cast<std::size_t>(v * from.width_px + u)] =
          from.view().at(std::min(u + disparity_px(u, v), from.width_px - 1), v);
  return to;
}

/// As a wall shows that stands across the line of sight.
inline Picture moved(const Picture& from, int disparity_px) {
  return moved(from, [=](int, int) { return disparity_px; });
}

/// As a road shows, and a thing of this disparity on it, as high as half the picture.
inline Picture moved_as_road(const Picture& from, int disparity_px) {
  return moved(from, [&](int u, int v) {
    const int on_road_px = std::max(0, (v - from.height_px / 2) * 2 * disparity_px / from.height_px);
    const bool is_thing = u > from.width_px / 3 && u < from.width_px / 2 && v > from.height_px / 3;
    return is_thing ? std::max(disparity_px * 2 / 3, on_road_px) : on_road_px;
  });
}

}  // namespace flies::testing
