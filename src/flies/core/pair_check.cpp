#include "flies/core/pair_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/kernels/patch_products.hpp"
#include "flies/core/quantile.hpp"

namespace flies {
namespace {

// All in pixels of the reduced images, which have about 600 columns.
constexpr int kReducedWidth_px = 600;
constexpr int kMinReducedHeight_px = 40;
constexpr int kPatchWidth_px = kernels::kProductColumns;
constexpr int kPatchHeight_px = kernels::kProductRows;
constexpr int kPatchPixels = kPatchWidth_px * kPatchHeight_px;
constexpr int kGridColumns = 20;
constexpr int kGridRows = 8;
constexpr int kThirdOfRows = 3;
/// The search reaches a quarter of the image to both sides: nearer than any road scene, and room for indoor ones.
constexpr int kSearchFraction = 4;
constexpr double kMinDeviation_gray = 6.0;  // well above sensor noise
/// Low enough for noise of 8 grey levels and rows 2 px apart, both measured on real pairs.
constexpr float kMinCorrelation = 0.85F;
/// A match counts only when no other place fits almost as well.
constexpr float kUniqueness = 0.05F;
constexpr int kPeakRadius_px = 3;
constexpr int kNoise_px = 1;  // disparities this close to infinity have no side

constexpr int kMinPatches = 40;  // below this the scene has too little texture to judge
/// Real road pairs reach 0.30, with strong noise and rows 2 px apart still 0.05; 19 of 20 unrelated images stay below.
constexpr double kMinConsistent = 0.045;
constexpr int kMinVotes = 12;
constexpr double kSwappedShare = 0.75;
constexpr double kPartnersOfSwapped = 0.3;  // good pairs of streets have 0.32 and more

struct Reduced {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> pixels;

  GrayView view() const { return {pixels.data(), width_px, height_px, width_px}; }
};

/// Averages blocks of `factor` x `factor` pixels.
Reduced reduce(const GrayView& image, int factor) {
  Reduced reduced{image.width_px / factor, image.height_px / factor, {}};
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

/// The rows that one row of patches covers, with what the correlation needs of every patch in it.
struct Band {
  int width_px;
  std::vector<std::int16_t> pixels;  ///< kPatchHeight_px rows
  std::vector<float> sum;            ///< of the grey levels of the patch whose left column is u
  std::vector<float> deviation;      ///< sqrt(n * sum of squares - square of the sum) of the same patch

  Band(const GrayView& image, int v) : width_px(image.width_px) {
    const auto width = static_cast<std::size_t>(width_px);
    std::vector<std::int32_t> column_sum(width), column_squares(width);
    pixels.reserve(width * kPatchHeight_px);
    for (int j = 0; j < kPatchHeight_px; ++j)
      for (std::size_t u = 0; u < width; ++u) {
        const std::int16_t level = image.row(v + j)[u];
        pixels.push_back(level);
        column_sum[u] += level;
        column_squares[u] += level * level;
      }
    for (auto u = column_sum.begin(), q = column_squares.begin(); column_sum.end() - u >= kPatchWidth_px; ++u, ++q) {
      const double total = std::accumulate(u, u + kPatchWidth_px, 0);
      const double squares = std::accumulate(q, q + kPatchWidth_px, 0);
      sum.push_back(static_cast<float>(total));
      deviation.push_back(static_cast<float>(std::sqrt(std::max(kPatchPixels * squares - total * total, 0.0))));
    }
  }

  int patches() const { return static_cast<int>(sum.size()); }
  bool is_textured(int u) const { return deviation[static_cast<std::size_t>(u)] >= kMinDeviation_gray * kPatchPixels; }
};

/// Zero-mean normalised cross-correlation of the patch at column `u` with those at so many columns of the other image,
/// from `first_u` on.
std::vector<float> correlations(const Band& band, int u, const Band& other, int first_u, std::size_t places) {
  std::vector<std::int32_t> products(places);
  kernels::patch_products({.patch = band.pixels.data() + u,
                           .others = other.pixels.data() + first_u,
                           .patch_stride = band.width_px,
                           .others_stride = other.width_px,
                           .places = static_cast<int>(places)},
                          products.data());
  const double sum = band.sum[static_cast<std::size_t>(u)], deviation = band.deviation[static_cast<std::size_t>(u)];
  const float* other_sums = other.sum.data() + first_u;
  const float* other_deviations = other.deviation.data() + first_u;
  std::vector<float> scores(places);
  for (std::size_t i = 0; i < places; ++i) {
    const double covariance = double{kPatchPixels} * products[i] - sum * double{other_sums[i]};
    scores[i] = static_cast<float>(covariance / (deviation * double{std::max(other_deviations[i], 1.0F)}));
  }
  return scores;
}

/// Where a patch was found along its row.
struct Match {
  bool fits = false;    ///< somewhere it fits well
  bool unique = false;  ///< and nowhere else nearly as well
  int u = 0;            ///< its left column there
};

Match find_along_row(const Band& band, int u, const Band& other, int center_u, int reach) {
  const int first = std::max(0, center_u - reach);
  const int last = std::min(other.patches() - 1, center_u + reach);
  if (first > last || !band.is_textured(u)) return {};
  const auto scores = correlations(band, u, other, first, static_cast<std::size_t>(last - first + 1));
  const auto best = std::max_element(scores.begin(), scores.end());
  if (*best < kMinCorrelation) return {};
  const auto is_rival = [&](const float& score) {
    return std::abs(&score - &*best) > kPeakRadius_px && score > *best - kUniqueness;
  };
  return {true, std::none_of(scores.begin(), scores.end(), is_rival), first + static_cast<int>(best - scores.begin())};
}

/// The patch around the strongest vertical edge of a cell, where columns can be told apart best.
int strongest_edge(const Band& band, int first_u, int last_u) {
  const std::int16_t* row = band.pixels.data() + kPatchHeight_px / 2 * band.width_px + kPatchWidth_px / 2;
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

double nearness_px(std::vector<double> disparities_px) {
  constexpr std::size_t kFewest = 10;
  return disparities_px.size() < kFewest ? 0.0 : quantile(std::move(disparities_px), 0.8);
}

bool is_swapped(const PairEvidence& evidence) {
  const int votes = evidence.nearer + evidence.beyond;
  return votes >= kMinVotes && evidence.beyond >= kSwappedShare * votes;
}

bool is_another_scene(const PairEvidence& evidence) {
  if (evidence.patches < kMinPatches) return false;
  const double fewest = kMinConsistent * evidence.patches;
  // Matches by chance fall on both sides of infinity alike and cancel; those of a pair, swapped or not, do not.
  const bool is_by_chance = std::abs(evidence.nearer - evidence.beyond) + evidence.distant < fewest;
  // Too few beyond infinity to be swapped, and hardly any before it: by chance all the same.
  const bool is_nothing = evidence.nearer + evidence.distant < fewest && !is_swapped(evidence);
  return is_by_chance || is_nothing;
}

void check_same_scene(const PairEvidence& evidence, const std::string& left_name, const std::string& right_name,
                      RectifiedBy by) {
  if (!is_another_scene(evidence)) return;
  const bool is_by_calibration = by == RectifiedBy::calibration;
  throw InputError(
      right_name, "",
      fmt::format("not a pair with {}: {}hardly any place of the left image is found on the same row of "
                  "the right one ({})",
                  left_name, is_by_calibration ? "rectified with the calibration, " : "",
                  is_by_calibration ? "another scene or moment, the calibration of other cameras or sizes, left and "
                                      "right swapped in images or calibration, or images that are rectified already"
                                    : "another scene, or not rectified"));
}

void check_order(const PairEvidence& evidence, const std::string& left_name, const std::string& right_name) {
  if (!is_swapped(evidence)) return;
  const int votes = evidence.nearer + evidence.beyond;
  // Swapped images of one moment have partners for most of their places; of two moments while the camera turns, few.
  const auto found = fmt::format("{} of {} places would lie beyond infinity", evidence.beyond, votes);
  if (votes + evidence.distant < kPartnersOfSwapped * evidence.patches)
    throw InputError(
        left_name, "",
        fmt::format("is hardly a pair with {}: only {} of {} places are found there, and {}: were they taken "
                    "at different moments, or are left and right swapped?",
                    right_name, votes + evidence.distant, evidence.patches, found));
  throw InputError(left_name, "",
                   fmt::format("left and right seem to be swapped (with {}), or both images mirrored or turned by 180 "
                               "degrees: {}",
                               right_name, found));
}

/// By how much images are reduced. Panoramas of few rows must keep enough of them.
int reduction_of(const RectifiedPair& pair) {
  return std::clamp((pair.left.width_px + kReducedWidth_px / 2) / kReducedWidth_px, 1,
                    std::max(1, pair.left.height_px / kMinReducedHeight_px));
}

/// A place of the left image that was found in the right one.
struct FoundPlace {
  int row = 0, column = 0;  ///< of the grid of patches
  int disparity_px = 0;     ///< of the reduced images, infinity being 0
};

/// Gathers the evidence of a pair, one row of patches after the other.
class EvidenceOfRows {
 public:
  /// @param first_px, last_px disparities that are searched, in the reduced images, infinity being 0
  EvidenceOfRows(const RectifiedPair& pair, int infinity_px, int first_px, int last_px)
      : pair_(pair),
        factor_(reduction_of(pair)),
        height_px_(pair.left.height_px / factor_),
        infinity_px_(infinity_px),
        middle_px_(infinity_px + (first_px + last_px) / 2),
        reach_px_((last_px - first_px) / 2) {}

  /// @param first_column, step of the patches in this row
  void add_row(int row, int first_column = 0, int step = 1) {
    if (pair_.left.width_px / factor_ < kPatchWidth_px || height_px_ < kPatchHeight_px) return;  // nothing to compare
    const Band left_band = band(pair_.left, row), right_band = band(pair_.right, row);
    for (int column = first_column; column < kGridColumns; column += step) {
      const int u = strongest_edge(left_band, left_band.patches() * column / kGridColumns,
                                   left_band.patches() * (column + 1) / kGridColumns);
      if (!left_band.is_textured(u)) continue;
      const auto match = find_along_row(left_band, u, right_band, u - middle_px_, reach_px_);
      if (match.fits && !match.unique) continue;  // a fence, a grid: says nothing either way
      ++evidence_.patches;
      if (!match.fits) continue;
      // Chance finds a fit somewhere; it rarely leads back to where the search started.
      const auto back = find_along_row(right_band, match.u, left_band, match.u + middle_px_, reach_px_);
      if (!back.unique || std::abs(back.u - u) > kNoise_px) continue;
      const int disparity_px = u - match.u - infinity_px_;
      places_.push_back({row, column, disparity_px});
      ++(std::abs(disparity_px) <= kNoise_px ? evidence_.distant
         : disparity_px > 0                  ? evidence_.nearer
                                             : evidence_.beyond);
    }
  }

  const PairEvidence& counts() const { return evidence_; }
  const std::vector<FoundPlace>& places() const { return places_; }

  PairEvidence evidence() const {
    std::vector<double> upper_px, lower_px;
    for (const auto& place : places_) {
      if (place.row < kThirdOfRows) upper_px.push_back(place.disparity_px * factor_);
      if (place.row >= kGridRows - kThirdOfRows) lower_px.push_back(place.disparity_px * factor_);
    }
    PairEvidence evidence = evidence_;
    evidence.upper_px = nearness_px(std::move(upper_px));
    evidence.lower_px = nearness_px(std::move(lower_px));
    return evidence;
  }

 private:
  /// Only the rows that the patches cover are reduced.
  Band band(const GrayView& image, int row) const {
    const int v = (height_px_ - kPatchHeight_px) * (2 * row + 1) / (2 * kGridRows);
    const GrayView rows{image.row(v * factor_), image.width_px, kPatchHeight_px * factor_, image.stride};
    return Band(reduce(rows, factor_).view(), 0);
  }

  RectifiedPair pair_;
  int factor_, height_px_, infinity_px_, middle_px_, reach_px_;
  PairEvidence evidence_;
  std::vector<FoundPlace> places_;
};

/// As far to both sides of infinity.
EvidenceOfRows around_infinity(const RectifiedPair& pair, const StereoCamera& camera) {
  const int factor = reduction_of(pair);
  const int reach_px = pair.left.width_px / factor / kSearchFraction;
  return {pair, static_cast<int>(std::lround((camera.cx_px - camera.cx_right_px) / factor)), -reach_px, reach_px};
}

}  // namespace

double PairEvidence::matched_share() const {
  return patches == 0 ? 0.0 : static_cast<double>(nearer + distant) / patches;
}

PairEvidence gather_pair_evidence(const RectifiedPair& pair, const StereoCamera& camera) {
  EvidenceOfRows rows = around_infinity(pair, camera);
  for (int row = 0; row < kGridRows; ++row) rows.add_row(row);
  return rows.evidence();
}

PairOrder order_of_pair(const RectifiedPair& pair, const StereoCamera& camera) {
  // From the road up: near places tell left from right.
  constexpr int kRows[] = {5, 4, 6, 3, 7, 2, 1, 0};
  static_assert(std::size(kRows) == kGridRows);
  constexpr int kEnough = 6;
  EvidenceOfRows rows = around_infinity(pair, camera);
  for (const int row : kRows) {
    rows.add_row(row);
    const auto& found = rows.counts();
    if (found.nearer + found.distant >= kEnough && 4 * found.beyond <= found.nearer) return PairOrder::good;
  }
  if (is_another_scene(rows.counts())) return PairOrder::unrelated;
  return is_swapped(rows.counts()) ? PairOrder::swapped : PairOrder::good;
}

double nearer_than_road_px(const Projection& projection, const RoadPlane& road, int width_px, double v_px) {
  constexpr double kRough = 1.2;
  const double road_px =
      std::max(projection.road_parallax_px(0.0, v_px, road), projection.road_parallax_px(width_px - 1.0, v_px, road));
  return kRough * road_px + projection.disparity_offset_px();
}

std::vector<bool> parts_nearer_than(const RectifiedPair& pair, const std::function<double(double v_px)>& disparity_px) {
  constexpr int kStanding = 5, kHanging = 3;  // rows that are looked at first: what stands on the ground, what does not
  constexpr int kFewest = 2;
  const int factor = reduction_of(pair);
  EvidenceOfRows rows(pair, 0, -kPatchWidth_px, pair.left.width_px / factor / 2);
  std::array<double, kGridRows> limits_px{};
  for (int row = 0; row < kGridRows; ++row)
    limits_px[static_cast<std::size_t>(row)] =
        disparity_px(pair.left.height_px * (2.0 * row + 1.0) / (2.0 * kGridRows));
  const auto counts = [&] {
    std::array<int, kGridColumns> places{};
    for (const auto& place : rows.places())
      places[static_cast<std::size_t>(place.column)] +=
          (place.disparity_px - kNoise_px) * factor > limits_px[static_cast<std::size_t>(place.row)];
    return places;
  };
  // What is near is wide: every other patch will do.
  rows.add_row(kStanding, 0, 2);
  rows.add_row(kHanging, 1, 2);
  if (std::ranges::count(counts(), 0) == kGridColumns) return std::vector<bool>(kGridColumns, false);
  rows.add_row(kStanding, 1, 2);
  rows.add_row(kHanging, 0, 2);
  for (int row = 0; row < kGridRows; ++row)
    if (row != kStanding && row != kHanging) rows.add_row(row);
  std::vector<bool> nearer;
  for (const int found : counts()) nearer.push_back(found >= kFewest);
  return nearer;
}

void check_true_pair(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                     const std::string& right_name, RectifiedBy by) {
  const auto evidence = gather_pair_evidence(pair, camera);
  check_same_scene(evidence, left_name, right_name, by);
  check_order(evidence, left_name, right_name);
}

void check_not_swapped(const RectifiedPair& pair, const StereoCamera& camera, const std::string& left_name,
                       const std::string& right_name) {
  if (order_of_pair(pair, camera) != PairOrder::swapped) return;  // which takes less time
  check_order(gather_pair_evidence(pair, camera), left_name, right_name);
}

}  // namespace flies
