#include "flies/synth/paste_places.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "flies/core/box_overlap.hpp"
#include "flies/core/random.hpp"

namespace flies::synth {
namespace {

constexpr std::uint32_t kPlacePurpose = 130;
constexpr int kTries = 60;  // to find a place for one person
constexpr double kLeastHeight_m = 1.55, kMostHeight_m = 1.9;
constexpr int kMargin_px = 3;        // that people keep from the border of both images
constexpr double kApart = 0.4;       // of two people's boxes that may overlap, of the smaller one
constexpr double kMostHidden = 0.4;  // of a person by what is nearer; people hidden by half need not be found
// Roads are not quite where they should be: feet are put on ground so many rows up or down at most.
constexpr int kGroundRows = 18, kBelowFeet_px = 10;
constexpr float kSteeper_px = 0.8F;  // least rise of disparity over `kBelowFeet_px`: it is ground, not a wall

/// Row of ground that is seen at this disparity in column `u`, near row `v`; nothing where there is none.
std::optional<int> ground_row(const Surroundings& around, int u, double v, double disparity_px) {
  const auto expected = static_cast<int>(std::lround(v));
  std::optional<int> best;
  float least_px = kSameSurface_px;
  for (int row = expected - kGroundRows; row <= expected + kGroundRows; ++row) {
    if (row < 0 || row + kBelowFeet_px >= around.left.rows || around.measured.at<std::uint8_t>(row, u) == 0) continue;
    const float here_px = around.left.at<float>(row, u), below_px = around.left.at<float>(row + kBelowFeet_px, u);
    const float gap_px = std::abs(here_px - static_cast<float>(disparity_px));
    if (gap_px >= least_px || below_px - here_px < kSteeper_px) continue;
    least_px = gap_px;
    best = row;
  }
  return best;
}

double share_hidden(const Surroundings& around, const Place& place) {
  const ImageBox box = place.box();
  int hidden = 0, all = 0;
  for (int v = static_cast<int>(box.v_px); v < static_cast<int>(box.v_px + 0.95 * box.height_px); v += 2)
    for (int u = static_cast<int>(box.u_px + 0.2 * box.width_px); u < box.u_px + 0.8 * box.width_px; u += 2) {
      ++all;
      hidden += around.left.at<float>(v, u) > static_cast<float>(place.disparity_px) + kSameSurface_px;
    }
  return all == 0 ? 1.0 : static_cast<double>(hidden) / all;
}

bool is_in_both_images(const ImageBox& box, double disparity_px, const StereoCamera& camera) {
  return box.v_px >= kMargin_px && box.v_px + box.height_px <= camera.height_px - kMargin_px &&
         box.u_px - std::max(0.0, disparity_px) >= kMargin_px &&
         box.u_px + box.width_px - std::min(0.0, disparity_px) <= camera.width_px - kMargin_px;
}

/// Draws a person and a place for him; nothing where nobody can stand.
std::optional<Place> draw_place(const RealPair& pair, const Surroundings& around, std::span<const CutOut> cut_outs,
                                const PasteOptions& options, FlyRandom& random) {
  const Projection projection(pair.camera);
  Place place;
  place.cut = &cut_outs[random.below(static_cast<std::uint32_t>(cut_outs.size()))];
  place.height_m = random.uniform(kLeastHeight_m, kMostHeight_m);
  const double x_m = random.uniform(options.people_min_range_m, options.people_max_range_m);
  place.u_px = random.uniform(0.0, pair.camera.width_px);
  const double y_m = x_m * (pair.camera.cx_px - place.u_px) / pair.camera.fx_px;
  place.depth_m = projection.depth_m({x_m, y_m, 0.0});
  if (place.depth_m <= 0.0) return std::nullopt;
  place.disparity_px = projection.disparity_at_depth(place.depth_m);
  place.height_px = pair.camera.fy_px * place.height_m / place.depth_m;
  const auto row = ground_row(around, std::min(static_cast<int>(place.u_px), pair.camera.width_px - 1),
                              projection.project({x_m, y_m, 0.0}).v_px, place.disparity_px);
  if (!row) return std::nullopt;
  place.foot_v_px = *row;
  if (!is_in_both_images(place.box(), place.disparity_px, pair.camera)) return std::nullopt;
  if (share_hidden(around, place) > kMostHidden) return std::nullopt;
  return place;
}

bool is_clear(const Place& place, const std::vector<Place>& others, const std::vector<ImageBox>& keep_clear) {
  const ImageBox box = place.box();
  const auto overlaps = [&](const ImageBox& other, double share) {
    return intersection_px2(box, other) > share * std::min(area_px2(box), area_px2(other));
  };
  return std::ranges::none_of(keep_clear, [&](const ImageBox& other) { return overlaps(other, 0.0); }) &&
         std::ranges::none_of(others, [&](const Place& other) { return overlaps(other.box(), kApart); });
}

}  // namespace

std::vector<Place> draw_places(const RealPair& pair, const Surroundings& around, std::span<const CutOut> cut_outs,
                               const PasteOptions& options, std::uint32_t frame) {
  std::vector<Place> places;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(options.people); ++i) {
    FlyRandom random(options.seed, kPlacePurpose, frame, i);
    for (int k = 0; k < kTries; ++k) {
      const auto place = draw_place(pair, around, cut_outs, options, random);
      if (!place || !is_clear(*place, places, pair.keep_clear)) continue;
      places.push_back(*place);
      break;
    }
  }
  std::ranges::stable_sort(places, std::ranges::greater(), &Place::depth_m);
  return places;
}

}  // namespace flies::synth
