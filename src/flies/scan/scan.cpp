#include "flies/scan/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/scan/blind_columns.hpp"

namespace flies {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Height and range at which a direction is looked up in the image; without roll any would do.
constexpr double kSightHeight_m = 0.8, kSightRange_m = 10.0;

/// Cells up to this height above the road count as road that is seen, and this far below it.
constexpr double kRoadHeight_m = 0.25, kRoadDepth_m = -0.4;

/// So many cells in a row that do not show the road end what is seen of it.
constexpr int kRoadGap = 3;

/// The shares of the bands below the horizon that must show the road for a direction without an obstacle to be free.
constexpr double kFreeShare = 0.3;

/// Less support than this, in cells, is none.
constexpr float kLeastSupport = 0.05F;

/// What is known of a column of cells.
struct ColumnScan {
  SectorState state = SectorState::unknown;
  double range_m = kNone, free_m = 0.0, confidence = 0.0;
};

/// What is needed to read the result off.
struct Reading {
  const CellLayout& layout;
  std::span<const CellPoint> points;
  const Evidence& evidence;
  const Projection& projection;
  const RoadPlane& road;
  const ScanOptions& options;

  double height_m(std::size_t cell) const {
    return height_above_road_m(projection.height_m() - road.height_m, layout.road_px[cell], points[cell].parallax_px);
  }
  double range_m(int band, int column, double disparity_px) const {
    const Point3 point = projection.triangulate(
        {layout.middle_u_px(column), layout.middle_v_px(band, options.cells.row_step), disparity_px});
    return std::hypot(point.x_m, point.y_m);
  }
};

/// Range of the near face of the obstacle at this disparity: that of the cells that show it, else of the disparity.
double obstacle_range_m(const Reading& r, int column, double disparity_px, std::vector<double>& ranges_m) {
  const auto& evidence = r.options.evidence;
  const double tolerance_px = evidence.tolerance_px + evidence.tolerance_share * disparity_px;
  ranges_m.clear();
  int lowest_band = 0;
  for (int band = 0; band < r.layout.bands; ++band) {
    const std::size_t cell = r.layout.cell(band, column);
    const auto& point = r.points[cell];
    if (r.layout.road_px[cell] + r.projection.disparity_offset_px() > disparity_px) lowest_band = band + 1;
    if (!(point.certainty > 0.0F) || std::abs(point.disparity_px - disparity_px) > tolerance_px) continue;
    const double height_m = r.height_m(cell);
    if (height_m < r.options.z_min_m || height_m > r.options.z_max_m) continue;
    ranges_m.push_back(r.range_m(band, column, point.disparity_px));
  }
  if (ranges_m.empty()) return r.range_m(std::min(lowest_band, r.layout.bands - 1), column, disparity_px);
  return lower_quantile(ranges_m, r.options.near_quantile);
}

/// The road as a column shows it from the bottom of the image upwards.
struct SeenRoad {
  double range_m = 0.0;  ///< up to which it is seen
  double share = 0.0;    ///< of the cells that would show it if nothing stood there
};

SeenRoad see_road(const Reading& r, int column, double limit_m) {
  SeenRoad seen;
  int missed = 0, road_cells = 0, cells = 0;
  bool goes_on = true;
  for (int band = 0; band < r.layout.bands; ++band) {
    const std::size_t cell = r.layout.cell(band, column);
    const double road_px = r.layout.road_px[cell];
    if (!(road_px > 0.0)) break;
    const double range_m = r.range_m(band, column, road_px + r.projection.disparity_offset_px());
    if (range_m > limit_m) break;
    ++cells;
    const double height_m = r.height_m(cell);
    const bool is_road = r.points[cell].certainty > 0.0F && height_m >= kRoadDepth_m && height_m <= kRoadHeight_m;
    road_cells += is_road ? 1 : 0;
    missed = is_road ? 0 : missed + 1;
    goes_on = goes_on && missed < kRoadGap;
    if (goes_on && is_road) seen.range_m = range_m;
  }
  seen.share = cells > 0 ? static_cast<double>(road_cells) / cells : 0.0;
  return seen;
}

ColumnScan read_column(const Reading& r, int column, int label, double x_far_m, std::vector<double>& memory) {
  ColumnScan result;
  const int none = r.evidence.labels() - 1;
  double limit_m = x_far_m;
  if (label != none) {
    const double range_m = obstacle_range_m(r, column, r.layout.nearest_px - label, memory);
    if (range_m <= x_far_m) {
      const double support = r.evidence.support(column)[static_cast<std::size_t>(label)];
      result = {SectorState::obstacle, range_m, 0.0, std::clamp(support / r.options.evidence.enough_support, 0.0, 1.0)};
      limit_m = range_m;
    }
  }
  const SeenRoad seen = see_road(r, column, limit_m);
  result.free_m = std::min(seen.range_m, limit_m);
  if (result.state != SectorState::obstacle && seen.share >= kFreeShare) {
    result.state = SectorState::free;
    result.confidence = seen.share;
  }
  if (result.confidence < r.options.min_confidence) result = {SectorState::unknown, kNone, result.free_m, 0.0};
  return result;
}

/// Takes obstacles back from columns that no cell supports, but for those between two supported ones of one surface: a
/// path that leaves a surface late costs no more than one that leaves it in time.
void trim_surfaces(const Evidence& evidence, const EvidenceOptions& options, std::vector<int>& labels) {
  const int none = evidence.labels() - 1, columns = static_cast<int>(labels.size());
  const auto label = [&](int column) -> int& { return labels[static_cast<std::size_t>(column)]; };
  const auto is_supported = [&](int column) {
    return evidence.support(column)[static_cast<std::size_t>(label(column))] >= kLeastSupport;
  };
  const auto goes_on = [&](int column) {
    return label(column) != none && label(column + 1) != none &&
           options.slant * std::abs(label(column) - label(column + 1)) < options.jump;
  };
  for (int first = 0; first < columns;) {
    int last = first;
    while (last + 1 < columns && goes_on(last)) ++last;
    const int next = last + 1;
    while (first <= last && !is_supported(first)) label(first++) = none;
    while (last > first && !is_supported(last)) label(last--) = none;
    first = next;
  }
}

/// Cells of these columns prove nothing.
void doubt_columns(const std::vector<bool>& columns, std::vector<CellPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (columns[i % columns.size()]) points[i].certainty = 0.0F;
}

/// What is nearer than is matched seems to stand at the near end, or a little behind it. Where something seems to, it
/// is asked whether there is something nearer; nothing is known there, then.
void forget_what_is_too_near(const RectifiedPair& pair, const Reading& r, std::vector<ColumnScan>& columns) {
  constexpr double kNearEnd = 1.4;
  const bool is_doubtful = std::ranges::any_of(
      columns, [&](const ColumnScan& column) { return column.range_m < kNearEnd * r.options.x_min_m; });
  if (!is_doubtful) return;
  const auto too_near = too_near_columns(pair, r.layout, r.projection, r.road);
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (too_near[i]) columns[i] = {};
}

/// The column of cells that looks in a direction; -1 when none does or the far end is in view of one camera alone.
int column_at(const Reading& r, double angle_rad, double x_far_m) {
  const double x_m = kSightRange_m * std::cos(angle_rad), y_m = kSightRange_m * std::sin(angle_rad);
  const Point3 point{x_m, y_m, r.road.z_m(x_m, y_m) + kSightHeight_m};
  if (!(r.projection.depth_m(point) > 0.0)) return -1;
  const double u_px = r.projection.project(point).u_px;
  if (u_px < r.projection.disparity_at_depth(x_far_m)) return -1;
  const auto column = std::floor((u_px + 0.5) / kernels::kCellColumns);
  return column >= 0.0 && column < r.layout.columns ? static_cast<int>(column) : -1;
}

}  // namespace

void check_scan_options(const ScanOptions& options, const std::string& source) {
  check_options(options, source);
  if (!(options.x_min_m < options.x_max_m))
    throw InputError(source, "scan.x_min_m",
                     fmt::format("the interval {}..{} m is empty", options.x_min_m, options.x_max_m));
  if (!(options.z_min_m < options.z_max_m))
    throw InputError(source, "scan.z_min_m",
                     fmt::format("the interval {}..{} m is empty", options.z_min_m, options.z_max_m));
}

Scan Scanner::scan(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road,
                   const Population& flies, const FieldOptions& field, const ScanOptions& options,
                   const std::optional<PlanarMotion>& motion) {
  look(pair, projection, road, flies, field, options);
  return decide(pair, projection, road, field, options, motion);
}

void Scanner::look(const RectifiedPair& given, const Projection& projection, const RoadPlane& road,
                   const Population& flies, const FieldOptions& field, const ScanOptions& options) {
  check_scan_options(options, "scan options");
  check_field(field, "field options");
  if (!options.enable) return;
  const RectifiedPair pair = detail::usable_pair(given);
  lay_out_cells(pair, projection, road, options, layout_);
  if (layout_.bands > 0)
    kernels::match_cells({.pair = pair,
                          .columns = layout_.columns,
                          .bands = layout_.bands,
                          .bottom_row = layout_.bottom_row,
                          .row_step = options.cells.row_step,
                          .nearest_px = layout_.nearest_px,
                          .disparities = layout_.disparities,
                          .reach = layout_.reach,
                          .recede = layout_.recede,
                          .weights = {.max_gradient = options.cells.max_gradient,
                                      .max_cost = options.cells.max_cost,
                                      .slant_across = options.cells.slant_across,
                                      .slant_upward = options.cells.slant_upward,
                                      .jump = options.cells.jump}},
                         memory_, matches_);
  else
    matches_.clear();
  read_points(layout_, matches_, memory_.left, projection.disparity_offset_px(), options.cells, points_);
  doubt_columns(blind_columns(pair, layout_, options.cells.row_step), points_);
  std::swap(evidence_, before_);
  evidence_.collect(layout_, points_, flies, projection, road, options);
}

Scan Scanner::decide(const RectifiedPair& given, const Projection& projection, const RoadPlane& road,
                     const FieldOptions& field, const ScanOptions& options, const std::optional<PlanarMotion>& motion) {
  if (!options.enable) return {};
  const RectifiedPair pair = detail::usable_pair(given);
  if (motion) evidence_.recall(before_, *motion);
  auto& labels =
      find_best_path({evidence_.costs(), evidence_.columns(), evidence_.labels()}, options.evidence, path_memory_);
  trim_surfaces(evidence_, options.evidence, labels);

  const Reading reading{layout_, points_, evidence_, projection, road, options};
  std::vector<ColumnScan> columns;
  columns.reserve(static_cast<std::size_t>(layout_.columns));
  std::vector<double> memory;
  for (int column = 0; column < layout_.columns; ++column)
    columns.push_back(read_column(reading, column, labels[static_cast<std::size_t>(column)], field.x_max_m, memory));
  forget_what_is_too_near(pair, reading, columns);

  Scan result;
  result.angle_increment_rad = radians(options.angle_increment_deg);
  const int most = static_cast<int>(std::ceil(std::numbers::pi / 2.0 / result.angle_increment_rad));
  for (int i = -most; i < most; ++i) {
    const double angle_rad = (i + 0.5) * result.angle_increment_rad;
    const int column = column_at(reading, angle_rad, field.x_max_m);
    if (column < 0) continue;
    if (result.empty()) result.angle_min_rad = angle_rad;
    const ColumnScan& seen = columns[static_cast<std::size_t>(column)];
    result.states.push_back(seen.state);
    result.ranges_m.push_back(seen.range_m);
    result.free_m.push_back(seen.free_m);
    result.confidence.push_back(seen.confidence);
  }
  return result;
}

Scan scan(const RectifiedPair& pair, const Projection& projection, const RoadPlane& road, const Population& flies,
          const FieldOptions& field, const ScanOptions& options) {
  return Scanner().scan(pair, projection, road, flies, field, options);
}

}  // namespace flies
