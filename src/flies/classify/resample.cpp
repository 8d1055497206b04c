#include "flies/classify/resample.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace flies {
namespace {

/// What every output pixel is made of along one axis: `count` source pixels each, with their weights.
struct Taps {
  int count = 0;
  std::vector<int> source;     ///< `count` per output pixel, inside the image
  std::vector<float> weights;  ///< likewise; of an output pixel they sum to 1
};

Taps taps_of(double start_px, double length_px, int outputs, int size_px) {
  const double scale = length_px / outputs;
  const bool shrinks = scale > 1.0;
  Taps taps;
  taps.count = shrinks ? static_cast<int>(std::ceil(scale)) + 1 : 2;
  const auto last = static_cast<double>(size_px - 1);
  for (int i = 0; i < outputs; ++i) {
    const double from_px = start_px + i * scale, centre_px = from_px + 0.5 * scale - 0.5;
    const double first = std::floor(shrinks ? from_px : centre_px);
    for (int t = 0; t < taps.count; ++t) {
      const double source = first + t;
      const double covered = std::min(source + 1.0, from_px + scale) - std::max(source, from_px);
      taps.source.push_back(static_cast<int>(std::clamp(source, 0.0, last)));
      taps.weights.push_back(
          static_cast<float>(shrinks ? std::max(covered, 0.0) / scale : 1.0 - std::abs(centre_px - source)));
    }
  }
  return taps;
}

}  // namespace

FloatImage resample(const GrayView& image, const ImageBox& region, int width_px, int height_px) {
  assert(region.width_px > 0.0 && region.height_px > 0.0 && width_px > 0 && height_px > 0);
  const Taps across = taps_of(region.u_px, region.width_px, width_px, image.width_px);
  const Taps down = taps_of(region.v_px, region.height_px, height_px, image.height_px);
  const auto [left, right] = std::minmax_element(across.source.begin(), across.source.end());
  const int first_u = *left, columns = *right - *left + 1;

  FloatImage result{width_px, height_px, std::vector<float>(static_cast<std::size_t>(width_px * height_px))};
  std::vector<float> mixed(static_cast<std::size_t>(columns));
  for (int v = 0; v < height_px; ++v) {
    // Rows first: neighbours in memory, so that the compiler makes vectors of them.
    for (int t = 0; t < down.count; ++t) {
      const auto tap = static_cast<std::size_t>(v * down.count + t);
      const float weight = down.weights[tap];
      const std::uint8_t* const source = image.row(down.source[tap]) + first_u;
      float* const mix = mixed.data();
      if (t == 0)
        for (int u = 0; u < columns; ++u) mix[u] = weight * static_cast<float>(source[u]);
      else if (weight != 0.0F)
        for (int u = 0; u < columns; ++u) mix[u] += weight * static_cast<float>(source[u]);
    }
    float* const out = result.row(v);
    const float* const mix = mixed.data() - first_u;
    const int* source = across.source.data();
    const float* weight = across.weights.data();
    for (int u = 0; u < width_px; ++u, source += across.count, weight += across.count) {
      float sum = weight[0] * mix[source[0]];
      for (int t = 1; t < across.count; ++t) sum += weight[t] * mix[source[t]];
      out[u] = sum;
    }
  }
  return result;
}

}  // namespace flies
