#include "shared/result_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "flies/core/free_space.hpp"

namespace {

std::string plural(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// A car's half width: what stands nearer to the line straight ahead is in its way.
constexpr double kHalfLane_m = 1.0;

std::string scan_line(const flies::Scan& scan) {
  std::optional<double> nearest_m;
  std::size_t unknown = 0;
  for (std::size_t sector = 0; sector < scan.size(); ++sector) {
    if (scan.states[sector] == flies::SectorState::unknown) ++unknown;
    if (scan.states[sector] != flies::SectorState::obstacle || !std::isfinite(scan.ranges_m[sector])) continue;
    const double range_m = scan.ranges_m[sector];
    if (std::abs(range_m * std::sin(scan.angle_rad(sector))) <= kHalfLane_m)
      nearest_m = std::min(nearest_m.value_or(range_m), range_m);
  }
  const auto ahead = flies::sector_at(scan, 0.0);
  return fmt::format(
      "scan: {} within {:.0f} m of straight ahead, ground ahead seen free to {:.1f} m, {:.0f} % of {} unknown\n",
      nearest_m ? fmt::format("nearest obstacle at {:.1f} m", *nearest_m) : "no obstacle", kHalfLane_m,
      ahead ? flies::drivable_m(scan, *ahead) : 0.0,
      100.0 * static_cast<double>(unknown) / static_cast<double>(scan.size()), plural(scan.size(), "sector"));
}

}  // namespace

std::string result_table(const flies::FrameRecord& record) {
  std::string table = fmt::format("{}: {}, {}\n", record.left, plural(record.obstacles.size(), "obstacle"),
                                  plural(record.pedestrians.size(), "pedestrian"));
  if (!record.obstacles.empty() || !record.pedestrians.empty())
    table += fmt::format("{:<12}{:>8}{:>8}{:>11}{:>7}{:>11}{:>12}{:>9}\n", "", "x [m]", "y [m]", "range [m]", "+-",
                         "width [m]", "height [m]", "score");
  for (const auto& o : record.obstacles)
    table += fmt::format("{:<12}{:>8.2f}{:>8.2f}{:>11.2f}{:>7.2f}{:>11.2f}{:>12.2f}{:>9.3g}\n", "obstacle", o.x_m,
                         o.y_m, o.range_m, o.range_sd_m, o.width_m, o.height_m, o.score);
  for (const auto& p : record.pedestrians)
    table += fmt::format("{:<12}{:>8.2f}{:>8.2f}{:>11.2f}{:>7.2f}{:>11}{:>12.2f}{:>9.3g}\n", "pedestrian", p.x_m, p.y_m,
                         p.range_m, p.range_sd_m, "", p.height_m, p.probability);
  if (!record.scan.empty()) table += scan_line(record.scan);
  table += fmt::format("{:.0f} ms:", std::accumulate(record.stage_ms.begin(), record.stage_ms.end(), 0.0));
  for (std::size_t i = 0; i < flies::kStageCount; ++i)
    table += fmt::format(" {} {:.1f}", flies::kStageNames[i], record.stage_ms[i]);
  return table + "\n";
}
