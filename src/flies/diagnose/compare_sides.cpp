#include "flies/diagnose/compare_sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

constexpr double kBlindShare = 0.1;
constexpr double kBlurred = 0.6, kDimmed = 0.5;

/// Columns of the grid that a place may have moved by: a quarter of the width.
constexpr int kReach = kCellGridColumns / 4;

/// Patches are looked for in smaller cells: dirt on a lens, a part of an image that was lost.
constexpr int kPatchColumns = 40, kPatchRows = 16, kPatchReach = kPatchColumns / 4;
constexpr int kLeastCell_px = 8;
constexpr double kFlat_gray = 1.5, kShown_gray = 4.0;
constexpr double kWhite_gray = 230.0;  // glare, which one camera may see alone
constexpr double kBlindPatch = 0.007, kLostRows = 0.005;
constexpr int kSharpnessColumns = 6;
constexpr double kBlurredPart = 0.3;

struct Level {
  double mean_gray = 0.0, deviation_gray = 0.0;
};

Level level_of(const GrayView& image, int first_u, int end_u, int first_v, int end_v) {
  double sum = 0.0, squares = 0.0;
  for (int v = first_v; v < end_v; ++v) {
    const std::uint8_t* row = image.row(v);
    std::uint32_t row_sum = 0, row_squares = 0;
    for (int u = first_u; u < end_u; ++u) {
      const std::uint32_t level = row[u];
      row_sum += level;
      row_squares += level * level;
    }
    sum += row_sum;
    squares += row_squares;
  }
  const double pixels = static_cast<double>(end_u - first_u) * (end_v - first_v), mean = sum / pixels;
  return {mean, std::sqrt(std::max(0.0, squares / pixels - mean * mean))};
}

constexpr std::size_t patch_index(int row, int column) {
  return static_cast<std::size_t>(row) * kPatchColumns + static_cast<std::size_t>(column);
}
using PatchLevels = std::array<Level, static_cast<std::size_t>(kPatchColumns) * kPatchRows>;
using PatchMask = std::array<bool, static_cast<std::size_t>(kPatchColumns) * kPatchRows>;

PatchLevels patch_levels(const GrayView& image) {
  PatchLevels levels{};
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = 0; column < kPatchColumns; ++column)
      levels[patch_index(row, column)] =
          level_of(image, image.width_px * column / kPatchColumns, image.width_px * (column + 1) / kPatchColumns,
                   image.height_px * row / kPatchRows, image.height_px * (row + 1) / kPatchRows);
  return levels;
}

/// Takes a cell and all that hang together with it out of the mask. @returns how many they were
int take_patch(PatchMask& mask, int row, int column) {
  if (row < 0 || row >= kPatchRows || column < 0 || column >= kPatchColumns) return 0;
  if (!std::exchange(mask[patch_index(row, column)], false)) return 0;
  return 1 + take_patch(mask, row - 1, column) + take_patch(mask, row + 1, column) + take_patch(mask, row, column - 1) +
         take_patch(mask, row, column + 1);
}

/// Of the cells, those of the largest patch of one level where the other image shows something between two columns
/// beside each of them.
double blind_patch(const PatchLevels& image, const PatchLevels& other, int from, int to) {
  PatchMask blind{};
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = 0; column < kPatchColumns; ++column) {
      const Level& here = image[patch_index(row, column)];
      bool is_blind = here.deviation_gray < kFlat_gray && here.mean_gray < kWhite_gray;
      for (int c = std::max(0, column + from); c <= std::min(kPatchColumns - 1, column + to); ++c)
        is_blind = is_blind && other[patch_index(row, c)].deviation_gray > kShown_gray;
      blind[patch_index(row, column)] = is_blind;
    }
  int largest = 0;
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = 0; column < kPatchColumns; ++column) largest = std::max(largest, take_patch(blind, row, column));
  return static_cast<double>(largest) / static_cast<double>(blind.size());
}

std::vector<double> row_deviations(const GrayView& image) {
  std::vector<double> deviations;
  for (int v = 0; v < image.height_px; ++v)
    deviations.push_back(level_of(image, 0, image.width_px, v, v + 1).deviation_gray);
  return deviations;
}

/// Of the rows, those of one level where the other image has more. Rows at the edges are what rectifying leaves empty.
double lost_rows(const std::vector<double>& image, const std::vector<double>& other) {
  constexpr double kOneLevel_gray = 0.5, kMore_gray = 2.0;
  const auto shows = [](double deviation_gray) { return deviation_gray >= kOneLevel_gray; };
  const auto first = std::find_if(image.begin(), image.end(), shows);
  const auto end = std::find_if(image.rbegin(), image.rend(), shows).base();
  int lost = 0;
  for (auto row = first; row < end; ++row)
    lost += !shows(*row) && other[static_cast<std::size_t>(row - image.begin())] >= kMore_gray;
  return static_cast<double>(lost) / static_cast<double>(image.size());
}

/// Gradients over contrast of the columns between two.
double sharpness_between(const GrayView& image, int first_u, int end_u) {
  double differences = 0.0;
  for (int v = 0; v < image.height_px; ++v) {
    const std::uint8_t* row = image.row(v);
    int row_differences = 0;
    for (int u = first_u + 1; u < end_u; ++u) row_differences += std::abs(row[u] - row[u - 1]);
    differences += row_differences;
  }
  const double pixels = static_cast<double>(end_u - first_u) * image.height_px;
  return differences / pixels / std::max(level_of(image, first_u, end_u, 0, image.height_px).deviation_gray, 1.0);
}

/// What parts of the images say.
void compare_parts(const RectifiedPair& pair, SideDifference& difference) {
  if (pair.left.width_px < kPatchColumns * kLeastCell_px || pair.left.height_px < kPatchRows * kLeastCell_px) return;
  const PatchLevels left = patch_levels(pair.left), right = patch_levels(pair.right);
  difference.left_blind_patch = blind_patch(left, right, -kPatchReach, 0);
  difference.right_blind_patch = blind_patch(right, left, 0, kPatchReach);
  const auto left_rows = row_deviations(pair.left), right_rows = row_deviations(pair.right);
  difference.left_lost_rows = lost_rows(left_rows, right_rows);
  difference.right_lost_rows = lost_rows(right_rows, left_rows);
  for (int part = 0; part < kSharpnessColumns; ++part) {
    const int first_u = pair.left.width_px * part / kSharpnessColumns,
              end_u = pair.left.width_px * (part + 1) / kSharpnessColumns;
    const double ratio =
        sharpness_between(pair.right, first_u, end_u) / std::max(sharpness_between(pair.left, first_u, end_u), 1e-3);
    difference.least_sharpness = std::min(difference.least_sharpness, ratio);
    difference.most_sharpness = std::max(difference.most_sharpness, ratio);
  }
}

struct Side {
  CellGrid textured{};
  double deviation_gray = 0.0, gradient_gray = 0.0;  ///< of all pixels; the mean difference of neighbouring columns

  explicit Side(const GrayView& image) : textured(textured_cells(image)) {
    double sum = 0.0, squares = 0.0, differences = 0.0;
    for (int v = 0; v < image.height_px; ++v) {
      const auto* row = image.row(v);
      for (int u = 0; u < image.width_px; ++u) {
        sum += row[u];
        squares += row[u] * row[u];
        differences += u == 0 ? 0 : std::abs(row[u] - row[u - 1]);
      }
    }
    const double pixels = static_cast<double>(image.width_px) * image.height_px, mean = sum / pixels;
    deviation_gray = std::sqrt(std::max(0.0, squares / pixels - mean * mean));
    gradient_gray = differences / pixels;
  }
  double sharpness() const { return gradient_gray / std::max(deviation_gray, 1e-3); }
};

/// Of the cells that one image shows something in, those where the other has nothing between two columns beside them.
double blind_share(const CellGrid& seen, const CellGrid& other, int from, int to) {
  int cells = 0, blind = 0;
  for (int row = 0; row < kCellGridRows; ++row)
    for (int column = 0; column < kCellGridColumns; ++column) {
      if (!seen[cell_index(row, column)]) continue;
      ++cells;
      bool is_blind = true;
      for (int c = std::max(0, column + from); c <= std::min(kCellGridColumns - 1, column + to); ++c)
        is_blind = is_blind && !other[cell_index(row, c)];
      blind += is_blind;
    }
  return cells == 0 ? 0.0 : static_cast<double>(blind) / cells;
}

}  // namespace

SideDifference compare_sides(const RectifiedPair& pair) {
  const Side left(pair.left), right(pair.right);
  SideDifference difference;
  difference.left_blind_share = blind_share(right.textured, left.textured, 0, kReach);
  difference.right_blind_share = blind_share(left.textured, right.textured, -kReach, 0);
  difference.sharpness = right.sharpness() / std::max(left.sharpness(), 1e-6);
  difference.contrast = right.deviation_gray / std::max(left.deviation_gray, 1e-3);
  compare_parts(pair, difference);
  return difference;
}

SideDifference median_side_difference(const std::vector<SideDifference>& pairs) {
  if (pairs.empty()) return {};
  SideDifference median;
  for (double SideDifference::*member :
       {&SideDifference::left_blind_share, &SideDifference::right_blind_share, &SideDifference::sharpness,
        &SideDifference::contrast, &SideDifference::left_blind_patch, &SideDifference::right_blind_patch,
        &SideDifference::left_lost_rows, &SideDifference::right_lost_rows, &SideDifference::least_sharpness,
        &SideDifference::most_sharpness}) {
    std::vector<double> values;
    for (const auto& pair : pairs) values.push_back(pair.*member);
    median.*member = upper_median(std::move(values));
  }
  return median;
}

std::vector<std::string> complaints(const SideDifference& d) {
  const auto tell_blind = [](double share, const char* blind, const char* other) {
    return fmt::format(
        "the {} image shows nothing in {:.0f} % of what the {} one sees: is that camera covered, or a part of its "
        "image missing?",
        blind, 100.0 * share, other);
  };
  std::vector<std::string> found;
  if (d.right_blind_share > kBlindShare) found.push_back(tell_blind(d.right_blind_share, "right", "left"));
  if (d.left_blind_share > kBlindShare) found.push_back(tell_blind(d.left_blind_share, "left", "right"));
  if (!found.empty()) return found;  // which contrast and sharpness follow from
  for (const auto& [image, other, rows, patch] : {std::tuple("right", "left", d.right_lost_rows, d.right_blind_patch),
                                                  std::tuple("left", "right", d.left_lost_rows, d.left_blind_patch)})
    if (rows > kLostRows)
      found.push_back(
          fmt::format("{:.0f} % of the rows of the {} image have one grey level throughout: were lines lost "
                      "on the way from that camera?",
                      std::max(1.0, 100.0 * rows), image));
    else if (patch > kBlindPatch)
      found.push_back(
          fmt::format("a patch of {:.0f} % of the {} image shows nothing where the {} one sees something: "
                      "is there dirt on that lens, or a part of its image missing?",
                      std::max(1.0, 100.0 * patch), image, other));
  if (!found.empty()) return found;
  const double dimmed = std::min(d.contrast, 1.0 / std::max(d.contrast, 1e-6));
  if (dimmed < kDimmed)
    found.push_back(
        fmt::format("the {} image has {:.2g} times the contrast of the other: are exposure and gain of "
                    "both cameras the same?",
                    d.contrast < 1.0 ? "right" : "left", dimmed));
  if (!found.empty()) return found;
  const double blurred = std::min(d.sharpness, 1.0 / std::max(d.sharpness, 1e-6));
  if (blurred < kBlurred)
    found.push_back(fmt::format(
        "the {} image is {:.2g} times as sharp as the other: is that camera out of focus, or its lens dirty?",
        d.sharpness < 1.0 ? "right" : "left", blurred));
  if (!found.empty()) return found;
  const double blurred_part = std::min(d.least_sharpness, 1.0 / std::max(d.most_sharpness, 1e-6));
  if (blurred_part < kBlurredPart)
    found.push_back(fmt::format(
        "a part of the {} image is {:.2g} times as sharp as in the other: is there a drop or dirt on that lens?",
        d.least_sharpness <= blurred_part ? "right" : "left", blurred_part));
  return found;
}

}  // namespace flies
