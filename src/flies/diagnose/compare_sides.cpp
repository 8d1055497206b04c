#include "flies/diagnose/compare_sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "flies/core/quantile.hpp"
#include "flies/diagnose/image_cells.hpp"

namespace flies {
namespace {

constexpr double kBlindShare = 0.1;
constexpr double kBlurred = 0.6, kDimmed = 0.5;

/// Columns of the grid that a place may have moved by: a quarter of the width.
constexpr int kReach = kCellGridColumns / 4;

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
  return {.left_blind_share = blind_share(right.textured, left.textured, 0, kReach),
          .right_blind_share = blind_share(left.textured, right.textured, -kReach, 0),
          .sharpness = right.sharpness() / std::max(left.sharpness(), 1e-6),
          .contrast = right.deviation_gray / std::max(left.deviation_gray, 1e-3)};
}

SideDifference median_side_difference(const std::vector<SideDifference>& pairs) {
  if (pairs.empty()) return {};
  const auto median = [&](double SideDifference::*member) {
    std::vector<double> values;
    for (const auto& pair : pairs) values.push_back(pair.*member);
    return upper_median(std::move(values));
  };
  return {median(&SideDifference::left_blind_share), median(&SideDifference::right_blind_share),
          median(&SideDifference::sharpness), median(&SideDifference::contrast)};
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
  return found;
}

}  // namespace flies
