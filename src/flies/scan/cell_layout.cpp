#include "flies/scan/cell_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "flies/core/parabola.hpp"

namespace flies {
namespace {

/// Where the uppermost row of cells is chosen.
constexpr double kTopRange_m = 5.0;

/// A road that dips this much below its plane is still matched.
constexpr double kBelowRoad_px = 3.0;

/// A cell that may have fewer disparities than this proves nothing by the one it has. Where partners of the nearest
/// ones lie outside of the right image, those of the next cell do, too, and more choice is needed.
constexpr int kMinChoice = 6, kMinChoiceAtTheEdge = 32;

/// A cell with less contrast of its own than this, half a grey level of gradient a pixel, takes its disparity from its
/// neighbours and proves nothing.
constexpr int kMinContrast = 16;

/// More disparities than any camera in use has between its nearest and its farthest place.
constexpr int kMaxDisparities = 1024;

/// The uppermost row on which something as tall as `top_m` may show.
int top_row(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, double top_m) {
  double top = pair.left.height_px;
  for (const double u_px : {0.0, pair.left.width_px - 1.0}) {
    const Point3 beside =
        projection.triangulate({u_px, projection.cy_px(), projection.disparity_at_depth(kTopRange_m)});
    if (beside.x_m <= 0.0) continue;
    top = std::min(top, projection.project({beside.x_m, beside.y_m, road.z_m(beside.x_m, beside.y_m) + top_m}).v_px);
  }
  return std::max(1, static_cast<int>(std::min(top, 1e6)));
}

/// Grey levels of clipped gradient in a cell, summed.
int contrast(const std::uint8_t* cell, std::size_t stride, int flat) {
  int sum = 0;
  for (int row = 0; row < kernels::kCellRows; ++row)
    for (int i = 0; i < kernels::kCellColumns; ++i)
      sum += std::abs(cell[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(i)] - flat);
  return sum;
}

}  // namespace

void lay_out_cells(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                   const ScanOptions& options, CellLayout& layout) {
  const int width = pair.left.width_px, height = pair.left.height_px;
  const int band_height = kernels::kCellRows * options.cells.row_step;
  layout.columns = width / kernels::kCellColumns;
  layout.bottom_row = height - 2;
  const int rows = layout.bottom_row - std::max(1, top_row(pair, projection, road, options.top_m)) + 1;
  layout.bands = std::max(0, rows / band_height);

  const double nearest = std::min<double>(projection.disparity_at_depth(options.x_min_m), width - 1);
  const double farthest = std::max<double>(projection.disparity_at_depth(options.x_max_m), -width);
  // Where there are too many, the nearest are left out: without the far end all that is far would be a ghost.
  const int farthest_px = static_cast<int>(std::floor(farthest));
  layout.nearest_px = std::min(static_cast<int>(std::ceil(nearest)), farthest_px + kMaxDisparities - 1);
  layout.disparities = std::max(layout.nearest_px - farthest_px + 1, 1);

  const double offset_px = projection.disparity_offset_px();
  layout.reach.resize(static_cast<std::size_t>(layout.bands));
  layout.recede.resize(static_cast<std::size_t>(layout.bands));
  layout.road_px.resize(static_cast<std::size_t>(layout.bands) * static_cast<std::size_t>(layout.columns));
  for (int band = 0; band < layout.bands; ++band) {
    // The parallax of a plane is linear in the image.
    const double v_px = layout.middle_v_px(band, options.cells.row_step);
    const double first = projection.road_parallax_px(layout.middle_u_px(0), v_px, road);
    const double last = projection.road_parallax_px(layout.middle_u_px(layout.columns - 1), v_px, road);
    for (int column = 0; column < layout.columns; ++column)
      layout.road_px[layout.cell(band, column)] =
          static_cast<float>(std::lerp(first, last, layout.columns > 1 ? column / (layout.columns - 1.0) : 0.0));
    const double lowest_px = std::clamp(std::min(first, last) + offset_px - kBelowRoad_px, -1e6, 1e6);
    const auto i = static_cast<std::size_t>(band);
    layout.reach[i] =
        std::clamp(layout.nearest_px - static_cast<int>(std::floor(lowest_px)) + 1, 1, layout.disparities);
    const double above_px = projection.road_parallax_px(layout.middle_u_px(layout.columns / 2),
                                                        layout.middle_v_px(band + 1, options.cells.row_step), road);
    const double here_px = projection.road_parallax_px(layout.middle_u_px(layout.columns / 2), v_px, road);
    layout.recede[i] = std::max(0, static_cast<int>(std::lround(std::clamp(here_px - above_px, 0.0, 1e6))));
  }
}

void read_points(const CellLayout& layout, const std::vector<kernels::CellMatch>& matches,
                 std::span<const std::uint8_t> gradients, double offset_px, const CellOptions& options,
                 std::vector<CellPoint>& points) {
  const std::size_t stride =
      gradients.size() /
      std::max<std::size_t>(
          1, matches.size() / static_cast<std::size_t>(std::max(1, layout.columns)) * kernels::kCellRows);
  points.resize(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto& match = matches[i];
    const bool has_neighbours = match.disparity > 0 && match.disparity + 1 < layout.disparities;
    const double before = match.before, here = match.cost, after = match.after;
    const double between = has_neighbours ? std::clamp(parabola_vertex(-before, -here, -after), -0.5, 0.5) : 0.0;
    const double disparity_px = layout.nearest_px - match.disparity - between;
    points[i].disparity_px = static_cast<float>(disparity_px);
    points[i].parallax_px = static_cast<float>(disparity_px - offset_px);
    // Of a few disparities one would always be the best.
    const int column = static_cast<int>(i) % layout.columns, band = static_cast<int>(i) / layout.columns;
    const int out_of_view = std::max(0, layout.nearest_px - (column - 1) * kernels::kCellColumns);
    const bool has_choice = layout.reach[static_cast<std::size_t>(band)] - out_of_view >=
                            (out_of_view > 0 ? kMinChoiceAtTheEdge : kMinChoice);
    // What one step of a path costs tells the disparities of a plain surface apart, which proves nothing.
    const double margin =
        static_cast<double>(match.second - match.cost - options.slant_upward) / options.certain_margin;
    const std::uint8_t* cell = gradients.data() + static_cast<std::size_t>(band) * kernels::kCellRows * stride +
                               static_cast<std::size_t>(column) * kernels::kCellColumns;
    points[i].certainty = has_choice && contrast(cell, stride, options.max_gradient) >= kMinContrast
                              ? static_cast<float>(std::clamp(margin, 0.0, 1.0))
                              : 0.0F;
  }
}

}  // namespace flies
