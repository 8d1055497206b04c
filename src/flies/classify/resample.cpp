#include "flies/classify/resample.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "flies/classify/kernels/mix.hpp"

namespace flies {
namespace {

using kernels::kMixedRows;
using kernels::Taps;

/// @returns sources inside the image; of an output pixel the weights sum to 1
Taps taps_of(double start_px, double length_px, int outputs, int size_px) {
  const double scale = length_px / outputs;
  const bool shrinks = scale > 1.0;
  const int count = shrinks ? static_cast<int>(std::ceil(scale)) + 1 : 2;
  const auto size = static_cast<std::size_t>(outputs * count);
  Taps taps{static_cast<std::size_t>(count), std::vector<int>(size), std::vector<float>(size)};
  int* sources = taps.source.data();
  float* weights = taps.weights.data();
  for (int i = 0; i < outputs; ++i, sources += count, weights += count) {
    const double from_px = start_px + i * scale, to_px = from_px + scale, centre_px = from_px + 0.5 * scale - 0.5;
    const auto first = static_cast<int>(std::floor(shrinks ? from_px : centre_px));
    for (int t = 0; t < count; ++t) {
      const double source = first + t;
      const double covered = std::min(source + 1.0, to_px) - std::max(source, from_px);
      sources[t] = std::clamp(first + t, 0, size_px - 1);
      weights[t] = static_cast<float>(shrinks ? std::max(covered, 0.0) / scale : 1.0 - std::abs(centre_px - source));
    }
  }
  return taps;
}

}  // namespace

FloatImage resample(const GrayView& image, const ImageBox& region, int width_px, int height_px) {
  assert(region.width_px > 0.0 && region.height_px > 0.0 && width_px > 0 && height_px > 0);
  Taps across = taps_of(region.u_px, region.width_px, width_px, image.width_px);
  const Taps down = taps_of(region.v_px, region.height_px, height_px, image.height_px);
  const auto [left, right] = std::minmax_element(across.source.begin(), across.source.end());
  const int first_u = *left, columns = *right - *left + 1;
  for (int& source : across.source) source -= first_u;

  const auto width = static_cast<std::size_t>(width_px), height = static_cast<std::size_t>(height_px);
  FloatImage result{width_px, height_px, {}};
  result.values.reserve(width * height + kSparePixels);
  result.values.resize(width * height);
  std::vector<float> mixed(kMixedRows * static_cast<std::size_t>(columns)), aside(kMixedRows * width), nobody(width);
  std::vector<const std::uint8_t*> sources(kMixedRows * down.count);
  std::vector<float> weights(sources.size());
  for (std::size_t v = 0; v < height; v += kMixedRows) {
    std::array<float*, kMixedRows> rows{};
    for (std::size_t r = 0; r < kMixedRows; ++r) {
      const std::size_t row = std::min(v + r, height - 1);  // rows below the last are nobody's
      rows[r] = v + r < height ? result.row(static_cast<int>(row)) : nobody.data();
      for (std::size_t t = 0; t < down.count; ++t) {
        sources[r * down.count + t] = image.row(down.source[row * down.count + t]) + first_u;
        weights[r * down.count + t] = down.weights[row * down.count + t];
      }
    }
    kernels::mix_rows(sources.data(), weights.data(), down.count, static_cast<std::size_t>(columns), mixed.data());
    kernels::mix_columns(mixed.data(), across, width, aside.data(), rows);
  }
  return result;
}

}  // namespace flies
