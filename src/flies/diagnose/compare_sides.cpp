#include "flies/diagnose/compare_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

/// Neighbouring pixels differ by so many standard deviations of the noise that they have, in the mean.
constexpr double kNoiseGradient = 1.128;
/// What is left of gradients at least when those of noise are taken off, which are not known to more.
constexpr double kLeastOfGradient = 0.25;

/// Columns of the grid that a place may have moved by: a quarter of the width.
constexpr int kReach = kCellGridColumns / 4;

/// Patches are looked for in smaller cells: dirt on a lens, a part of an image that was lost.
constexpr int kPatchColumns = 40, kPatchRows = 16, kPatchReach = kPatchColumns / 4;
constexpr int kLeastCell_px = 8;
constexpr double kFlat_gray = 1.5, kShown_gray = 4.0;
constexpr double kWhite_gray = 230.0;  // glare, which one camera may see alone
constexpr double kBlack_gray = 2.0;    // what rectifying leaves empty
constexpr int kSharpnessColumns = 6;

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

/// The black cells that hang together with the border of the image.
PatchMask black_borders(const PatchLevels& image) {
  PatchMask black{};
  for (std::size_t cell = 0; cell < black.size(); ++cell)
    black[cell] = image[cell].mean_gray <= kBlack_gray && image[cell].deviation_gray < kFlat_gray;
  const PatchMask all = black;
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = 0; column < kPatchColumns; ++column)
      if (row == 0 || column == 0 || row == kPatchRows - 1 || column == kPatchColumns - 1)
        take_patch(black, row, column);
  PatchMask borders{};
  for (std::size_t cell = 0; cell < black.size(); ++cell) borders[cell] = all[cell] && !black[cell];
  return borders;
}

/// Whether much of the cells between two columns is marked.
bool is_in_part(const PatchMask& mask, int first, int end) {
  constexpr double kMuch = 0.1;
  int marked = 0;
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = first; column < end; ++column) marked += mask[patch_index(row, column)];
  return marked > kMuch * kPatchRows * (end - first);
}

/// Of the cells, those of the largest patch of one level where the other image shows something between two columns
/// beside each of them. Deviations are those of images of one contrast.
double blind_patch(const PatchLevels& image, const PatchLevels& other, int from, int to) {
  PatchMask blind{};
  const PatchMask borders = black_borders(image);
  for (int row = 0; row < kPatchRows; ++row)
    for (int column = 0; column < kPatchColumns; ++column) {
      const Level& here = image[patch_index(row, column)];
      bool is_blind =
          here.deviation_gray < kFlat_gray && here.mean_gray < kWhite_gray && !borders[patch_index(row, column)];
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

std::vector<double> column_deviations(const GrayView& image) {
  const auto width = static_cast<std::size_t>(image.width_px);
  std::vector<double> sums(width), squares(width), deviations;
  for (int v = 0; v < image.height_px; ++v) {
    const std::uint8_t* row = image.row(v);
    for (std::size_t u = 0; u < width; ++u) {
      sums[u] += row[u];
      squares[u] += row[u] * row[u];
    }
  }
  for (std::size_t u = 0; u < width; ++u) {
    const double mean = sums[u] / image.height_px;
    deviations.push_back(std::sqrt(std::max(0.0, squares[u] / image.height_px - mean * mean)));
  }
  return deviations;
}

/// Of the rows or columns, those of one level where the other image has more. Those at the edges are what rectifying
/// leaves empty.
double lost_lines(const std::vector<double>& image, const std::vector<double>& other) {
  constexpr double kOneLevel_gray = 0.5, kMore_gray = 2.0;
  const auto shows = [](double deviation_gray) { return deviation_gray >= kOneLevel_gray; };
  const auto first = std::find_if(image.begin(), image.end(), shows);
  const auto end = std::find_if(image.rbegin(), image.rend(), shows).base();
  int lost = 0;
  for (auto line = first; line < end; ++line)
    lost += !shows(*line) && other[static_cast<std::size_t>(line - image.begin())] >= kMore_gray;
  return static_cast<double>(lost) / static_cast<double>(image.size());
}

/// Mean differences of neighbouring columns without what noise makes of them.
double without_noise(double gradient_gray, double noise_gray) {
  const double by_noise_gray = kNoiseGradient * noise_gray;
  return std::sqrt(std::max(gradient_gray * gradient_gray - by_noise_gray * by_noise_gray,
                            kLeastOfGradient * gradient_gray * kLeastOfGradient * gradient_gray));
}

/// Gradients over contrast of the columns between two.
double sharpness_between(const GrayView& image, int first_u, int end_u, double noise_gray) {
  double differences = 0.0;
  for (int v = 0; v < image.height_px; ++v) {
    const std::uint8_t* row = image.row(v);
    int row_differences = 0;
    for (int u = first_u + 1; u < end_u; ++u) row_differences += std::abs(row[u] - row[u - 1]);
    differences += row_differences;
  }
  const double pixels = static_cast<double>(end_u - first_u) * image.height_px;
  return without_noise(differences / pixels, noise_gray) /
         std::max(level_of(image, first_u, end_u, 0, image.height_px).deviation_gray, 1.0);
}

/// A fainter image shows less of a patch than the other one does, but no fewer patches.
void bring_to_one_contrast(PatchLevels& left, PatchLevels& right, double contrast) {
  PatchLevels& fainter = contrast < 1.0 ? right : left;
  for (auto& level : fainter) level.deviation_gray /= std::max(std::min(contrast, 1.0 / contrast), 0.01);
}

/// What parts of the images say.
void compare_parts(const RectifiedPair& pair, SideDifference& difference) {
  if (pair.left.width_px < kPatchColumns * kLeastCell_px || pair.left.height_px < kPatchRows * kLeastCell_px) return;
  PatchLevels left = patch_levels(pair.left), right = patch_levels(pair.right);
  bring_to_one_contrast(left, right, std::max(difference.contrast, 1e-3));
  difference.left_blind_patch = blind_patch(left, right, -kPatchReach, 0);
  difference.right_blind_patch = blind_patch(right, left, 0, kPatchReach);
  const auto left_rows = row_deviations(pair.left), right_rows = row_deviations(pair.right);
  difference.left_lost_rows = lost_lines(left_rows, right_rows);
  difference.right_lost_rows = lost_lines(right_rows, left_rows);
  const auto left_columns = column_deviations(pair.left), right_columns = column_deviations(pair.right);
  difference.left_lost_columns = lost_lines(left_columns, right_columns);
  difference.right_lost_columns = lost_lines(right_columns, left_columns);
  const PatchMask left_borders = black_borders(left), right_borders = black_borders(right);
  for (int part = 0; part < kSharpnessColumns; ++part) {
    const int first = kPatchColumns * part / kSharpnessColumns, end = kPatchColumns * (part + 1) / kSharpnessColumns;
    if (is_in_part(left_borders, first, end) || is_in_part(right_borders, first, end))
      continue;  // which cost sharpness
    const int first_u = pair.left.width_px * part / kSharpnessColumns,
              end_u = pair.left.width_px * (part + 1) / kSharpnessColumns;
    const double ratio = sharpness_between(pair.right, first_u, end_u, difference.right_noise.noise_gray) /
                         std::max(sharpness_between(pair.left, first_u, end_u, difference.left_noise.noise_gray), 1e-3);
    difference.least_sharpness = std::min(difference.least_sharpness, ratio);
    difference.most_sharpness = std::max(difference.most_sharpness, ratio);
  }
}

struct Side {
  CellGrid textured{};
  ImageNoise noise;
  double mean_gray = 0.0, deviation_gray = 0.0, gradient_gray = 0.0;  ///< mean difference of neighbouring columns

  explicit Side(const GrayView& image) : textured(textured_cells(image)), noise(measure_noise(image)) {
    double sum = 0.0, squares = 0.0, differences = 0.0;
    for (int v = 0; v < image.height_px; ++v) {
      const auto* row = image.row(v);
      for (int u = 0; u < image.width_px; ++u) {
        sum += row[u];
        squares += row[u] * row[u];
        differences += u == 0 ? 0 : std::abs(row[u] - row[u - 1]);
      }
    }
    const double pixels = static_cast<double>(image.width_px) * image.height_px;
    mean_gray = sum / pixels;
    deviation_gray = std::sqrt(std::max(0.0, squares / pixels - mean_gray * mean_gray));
    gradient_gray = differences / pixels;
  }
  double sharpness() const { return without_noise(gradient_gray, noise.noise_gray) / std::max(deviation_gray, 1e-3); }
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
  difference.brightness = right.mean_gray / std::max(left.mean_gray, 1e-3);
  difference.left_noise = left.noise;
  difference.right_noise = right.noise;
  compare_parts(pair, difference);
  return difference;
}

SideDifference median_side_difference(const std::vector<SideDifference>& pairs) {
  if (pairs.empty()) return {};
  SideDifference median;
  for (double SideDifference::*member :
       {&SideDifference::left_blind_share, &SideDifference::right_blind_share, &SideDifference::sharpness,
        &SideDifference::contrast, &SideDifference::brightness, &SideDifference::left_blind_patch,
        &SideDifference::right_blind_patch, &SideDifference::left_lost_rows, &SideDifference::right_lost_rows,
        &SideDifference::left_lost_columns, &SideDifference::right_lost_columns, &SideDifference::least_sharpness,
        &SideDifference::most_sharpness}) {
    std::vector<double> values;
    for (const auto& pair : pairs) values.push_back(pair.*member);
    median.*member = upper_median(std::move(values));
  }
  for (ImageNoise SideDifference::*member : {&SideDifference::left_noise, &SideDifference::right_noise}) {
    std::vector<ImageNoise> values;
    for (const auto& pair : pairs) values.push_back(pair.*member);
    median.*member = median_noise(std::move(values));
  }
  return median;
}

}  // namespace flies
