#include "flies/road/see_places.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "flies/core/convert.hpp"
#include "flies/road/correlate_disparities.hpp"

namespace flies {
namespace {

constexpr int kColumnStep_px = 16, kRowStep_px = 8;
constexpr double kMinCorrelation = 0.6;
/// Disparities that are looked through, as a share of the width.
constexpr double kMaxParallaxShare = 0.25;
/// Disparity per row by which the right image is sheared. Neighbourhoods of five rows bear a quarter more or less.
constexpr double kShearStep = 0.5;

struct OwnImage {
  std::vector<std::uint8_t> pixels;
  int width_px = 0, height_px = 0;

  GrayView view() const { return {pixels.data(), width_px, height_px, width_px}; }
};

OwnImage halved(const GrayView& image) {
  OwnImage half{{}, image.width_px / 2, image.height_px / 2};
  half.pixels.reserve(static_cast<std::size_t>(half.width_px) * static_cast<std::size_t>(half.height_px));
  for (int v = 0; v < half.height_px; ++v) {
    const std::uint8_t *upper = image.row(2 * v), *lower = image.row(2 * v + 1);
    for (int u = 0; u < half.width_px; ++u)
      half.pixels.push_back(
          static_cast<std::uint8_t>((upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1] + 2) / 4));
  }
  return half;
}

/// Every row moved to the right by `shear` pixels more than the one above it; columns are added to the right for that.
OwnImage sheared(const GrayView& image, double shear) {
  OwnImage result{{}, image.width_px + static_cast<int>(std::ceil(shear * image.height_px)) + 1, image.height_px};
  const auto width = static_cast<std::size_t>(result.width_px);
  result.pixels.resize(width * static_cast<std::size_t>(image.height_px), 0);
  for (int v = 0; v < image.height_px; ++v) {
    const double move = shear * v;
    const auto whole = static_cast<int>(move);
    const int part = static_cast<int>(256.0 * (move - whole));
    const std::uint8_t* from = image.row(v);
    std::uint8_t* to = result.pixels.data() + static_cast<std::size_t>(v) * width + whole;
    to[0] = from[0];
    for (int u = 1; u < image.width_px; ++u)
      to[u] = static_cast<std::uint8_t>((from[u] * (256 - part) + from[u - 1] * part + 128) / 256);
  }
  return result;
}

struct Match {
  double disparity_px = 0.0;
  float correlation = 0.0F;  ///< 0: none
};

/// Whether the place of the right image that was found leads back to where the search started: chance hardly does, and
/// what only one camera sees does not.
/// @param moved_px what the right image is sheared by in this row
bool leads_back(const RectifiedPair& pair, const StereoPoint& found, double lowest_px, double moved_px,
                std::vector<float>& correlation) {
  constexpr double kSamePlace_px = 1.5;
  const RectifiedPair back{pair.right, pair.left};
  const StereoPoint place{found.u_px - (found.disparity_px - moved_px), found.v_px, 0.0};
  // Disparities of the swapped pair are negative: from the largest one to the smallest.
  const double most_px = moved_px - lowest_px, least_px = most_px - static_cast<double>(correlation.size() - 1);
  correlate_disparities(back, place, least_px, correlation);
  const double best = unambiguous_best(correlation, kMinCorrelation);
  return best >= 0.0 && std::abs(least_px + best - (moved_px - found.disparity_px)) < kSamePlace_px;
}

/// Matches all places of a grid with one shear; keeps what matches better than before.
void match_grid(const RectifiedPair& pair, double shear, double offset_px, int columns, int rows,
                std::vector<Match>& matches) {
  tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const auto& part) {
    std::vector<float> correlation;
    for (int row = part.begin(); row < part.end(); ++row)
      for (int column = 0; column < columns; ++column) {
        const StereoPoint place{static_cast<double>((column + 0.5) * kColumnStep_px),
                                static_cast<double>(row * kRowStep_px + kRowStep_px / 2), 0.0};
        const double moved_px = shear * place.v_px;
        const double lowest_px = offset_px - 2.0;
        const double highest_px = std::min(place.u_px, offset_px + kMaxParallaxShare * pair.left.width_px);
        if (highest_px - lowest_px < 4.0) continue;
        correlation.resize(static_cast<std::size_t>(highest_px - lowest_px) + 1);
        correlate_disparities(pair, place, lowest_px - moved_px, correlation);
        const double best = unambiguous_best(correlation, kMinCorrelation);
        if (best < 0.0) continue;
        const float value = correlation[static_cast<std::size_t>(std::lrint(best))];
        Match& match = matches[static_cast<std::size_t>(row * columns + column)];
        const double disparity_px = lowest_px + best;
        if (value > match.correlation &&
            leads_back(pair, {place.u_px, place.v_px, disparity_px}, lowest_px, moved_px, correlation))
          match = {disparity_px, value};
      }
  });
}

}  // namespace

SeenPlaces see_places(const RectifiedPair& pair, const StereoCamera& camera, double max_shear, int max_width_px) {
  RectifiedPair used = pair;
  OwnImage left, right;
  double factor = 1.0;
  while (used.left.width_px > max_width_px) {
    left = halved(used.left);
    right = halved(used.right);
    used = {left.view(), right.view()};
    factor *= 2.0;
  }
  // The middle of a pixel of half the size is half a pixel off that of its upper left one.
  const auto full_px = [&](double half) { return (half + 0.5) * factor - 0.5; };

  SeenPlaces seen{camera.fy_px / factor, camera.fx_px * camera.baseline_m / factor, {}};
  const int columns = used.left.width_px / kColumnStep_px, rows = used.left.height_px / kRowStep_px;
  if (columns < 2 || rows < 2) return seen;
  const double offset_px = (camera.cx_px - camera.cx_right_px) / factor;
  std::vector<Match> matches(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (double shear = 0.0; shear <= max_shear; shear += kShearStep) {
    if (shear == 0.0) {
      match_grid(used, 0.0, offset_px, columns, rows, matches);
      continue;
    }
    const OwnImage moved = sheared(used.right, shear);
    match_grid({used.left, moved.view()}, shear, offset_px, columns, rows, matches);
  }
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Match& match = matches[static_cast<std::size_t>(row * columns + column)];
      if (match.correlation <= 0.0F) continue;
      const double u_px = full_px((column + 0.5) * kColumnStep_px);
      const double v_px = full_px(row * kRowStep_px + kRowStep_px / 2);
      seen.places.push_back(
          {(u_px - camera.cx_px) / camera.fx_px, (v_px - camera.cy_px) / camera.fy_px, match.disparity_px - offset_px});
    }
  return seen;
}

}  // namespace flies
