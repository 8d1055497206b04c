#include "flies/io/pair_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {
namespace {

// All in pixels of the reduced images, which have about 600 columns.
constexpr int kReducedWidth_px = 600;
constexpr int kPatchWidth_px = 16;
constexpr int kPatchHeight_px = 7;
constexpr int kPatchPixels = kPatchWidth_px * kPatchHeight_px;
constexpr int kGridColumns = 24;
constexpr int kGridRows = 10;
/// The search reaches a quarter of the image to both sides: nearer than any road scene, and room for indoor ones.
constexpr int kSearchFraction = 4;
constexpr double kMinDeviation_gray = 6.0;  // well above sensor noise
constexpr double kMinCorrelation = 0.9;
/// A match counts only when no other place fits almost as well.
constexpr double kUniqueness = 0.05;
constexpr int kPeakRadius_px = 3;
constexpr int kNoise_px = 1;  // disparities this close to infinity have no side

constexpr int kMinPatches = 40;  // below this the scene has too little texture to judge
constexpr double kMinFound = 0.12;
constexpr int kMinVotes = 12;
constexpr double kSwappedShare = 0.75;

/// Averages blocks of `factor` x `factor` pixels.
GrayImage reduce(const GrayView& image, int factor) {
  GrayImage reduced{image.width_px / factor, image.height_px / factor, {}};
  reduced.pixels.reserve(static_cast<std::size_t>(reduced.width_px) * static_cast<std::size_t>(reduced.height_px));
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(reduced.width_px));
  const auto area = static_cast<std::uint32_t>(factor * factor);
  for (int v = 0; v < reduced.height_px; ++v) {
    std::fill(sums.begin(), sums.end(), 0U);
    for (int j = 0; j < factor; ++j) {
      const std::uint8_t* from = image.row(v * factor + j);
      for (auto& sum : sums)
        for (int i = 0; i < factor; ++i) sum += *from++;
    }
    for (const auto sum : sums) reduced.pixels.push_back(static_cast<std::uint8_t>((sum + area / 2) / area));
  }
  return reduced;
}

struct PatchMoments {
  double mean_sum;   ///< sum of the grey levels
  double deviation;  ///< sqrt(n * sum of squares - square of the sum)
};

PatchMoments moments(const GrayView& image, int u, int v) {
  std::int32_t sum = 0, squares = 0;
  for (int j = 0; j < kPatchHeight_px; ++j) {
    const std::uint8_t* row = image.row(v + j) + u;
    for (int i = 0; i < kPatchWidth_px; ++i) {
      sum += row[i];
      squares += row[i] * row[i];
    }
  }
  const double variance = double{kPatchPixels} * squares - double(sum) * sum;
  return {double(sum), std::sqrt(std::max(variance, 0.0))};
}

/// Zero-mean normalised cross-correlation of the patches with top-left corners (u_left, v) and (u_right, v).
double correlation(const GrayView& left, const GrayView& right, int u_left, int u_right, int v,
                   const PatchMoments& left_moments) {
  std::int32_t product = 0, sum = 0, squares = 0;
  for (int j = 0; j < kPatchHeight_px; ++j) {
    const std::uint8_t* l = left.row(v + j) + u_left;
    const std::uint8_t* r = right.row(v + j) + u_right;
    for (int i = 0; i < kPatchWidth_px; ++i) {
      product += l[i] * r[i];
      sum += r[i];
      squares += r[i] * r[i];
    }
  }
  const double variance = double{kPatchPixels} * squares - double(sum) * sum;
  const double deviation = left_moments.deviation * std::sqrt(std::max(variance, 1.0));
  return (double{kPatchPixels} * product - left_moments.mean_sum * sum) / deviation;
}

/// The column in the other image where the patch fits well and nowhere else nearly as well.
std::optional<int> find_along_row(const GrayView& from, const GrayView& to, int u, int v, int center_u, int reach) {
  const auto patch = moments(from, u, v);
  if (patch.deviation < kMinDeviation_gray * kPatchPixels) return std::nullopt;
  const int first = std::max(0, center_u - reach);
  const int last = std::min(to.width_px - kPatchWidth_px, center_u + reach);
  if (first > last) return std::nullopt;
  std::vector<double> scores(static_cast<std::size_t>(last - first + 1));
  for (int candidate = first; candidate <= last; ++candidate)
    scores[static_cast<std::size_t>(candidate - first)] = correlation(from, to, u, candidate, v, patch);
  const auto best = std::max_element(scores.begin(), scores.end());
  if (*best < kMinCorrelation) return std::nullopt;
  const auto at = best - scores.begin();
  for (std::ptrdiff_t other = 0; other < std::ssize(scores); ++other)
    if (std::abs(other - at) > kPeakRadius_px && scores[static_cast<std::size_t>(other)] > *best - kUniqueness)
      return std::nullopt;
  return first + static_cast<int>(at);
}

/// The corner of the patch around the strongest vertical edge of a cell, where columns can be told apart best.
int strongest_edge(const GrayView& image, int first_u, int last_u, int v) {
  const std::uint8_t* row = image.row(v + kPatchHeight_px / 2) + kPatchWidth_px / 2;
  int best_u = first_u, best = -1;
  for (int u = first_u; u < last_u; ++u) {
    const int gradient = std::abs(row[u + 1] - row[u - 1]);
    if (gradient > best) {
      best = gradient;
      best_u = u;
    }
  }
  return best_u;
}

void check_same_scene(const PairEvidence& evidence, const std::string& left_name, const std::string& right_name) {
  const int found = evidence.nearer + evidence.beyond + evidence.distant;
  if (evidence.patches < kMinPatches || found >= kMinFound * evidence.patches) return;
  throw InputError(
      right_name, "",
      fmt::format("not a pair with {}: only {} of {} places of the left image are found on the same row of "
                  "the right one (another scene, or not rectified)",
                  left_name, found, evidence.patches));
}

void check_order(const PairEvidence& evidence, const std::string& left_name, const std::string& right_name) {
  const int votes = evidence.nearer + evidence.beyond;
  if (votes < kMinVotes || evidence.beyond < kSwappedShare * votes) return;
  throw InputError(left_name, "",
                   fmt::format("left and right seem to be swapped (with {}): {} of {} places would lie beyond infinity",
                               right_name, evidence.beyond, votes));
}

}  // namespace

PairEvidence gather_pair_evidence(const RectifiedPair& pair, const StereoCamera& camera) {
  const int factor = std::max(1, (pair.left.width_px + kReducedWidth_px / 2) / kReducedWidth_px);
  const GrayImage left_image = reduce(pair.left, factor), right_image = reduce(pair.right, factor);
  const GrayView left = left_image.view(), right = right_image.view();
  const int infinity_px = static_cast<int>(std::lround((camera.cx_px - camera.cx_right_px) / factor));
  const int reach_px = left.width_px / kSearchFraction;

  PairEvidence evidence;
  const int columns_px = left.width_px - kPatchWidth_px, rows_px = left.height_px - kPatchHeight_px;
  for (int row = 0; row < kGridRows; ++row) {
    const int v = rows_px * (2 * row + 1) / (2 * kGridRows);
    for (int column = 0; column < kGridColumns; ++column) {
      const int u =
          strongest_edge(left, columns_px * column / kGridColumns, columns_px * (column + 1) / kGridColumns, v);
      if (moments(left, u, v).deviation < kMinDeviation_gray * kPatchPixels) continue;
      ++evidence.patches;
      const auto u_right = find_along_row(left, right, u, v, u - infinity_px, reach_px);
      if (!u_right) continue;
      // Chance finds a fit somewhere; it rarely leads back to where the search started.
      const auto u_back = find_along_row(right, left, *u_right, v, *u_right + infinity_px, reach_px);
      if (!u_back || std::abs(*u_back - u) > kNoise_px) continue;
      const int disparity_px = u - *u_right - infinity_px;
      ++(std::abs(disparity_px) <= kNoise_px ? evidence.distant : disparity_px > 0 ? evidence.nearer : evidence.beyond);
    }
  }
  return evidence;
}

void check_true_pair(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                     const std::string& right_name) {
  const auto evidence = gather_pair_evidence(pair, camera);
  check_same_scene(evidence, left_name, right_name);
  check_order(evidence, left_name, right_name);
}

void check_not_swapped(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                       const std::string& right_name) {
  check_order(gather_pair_evidence(pair, camera), left_name, right_name);
}

}  // namespace flies
