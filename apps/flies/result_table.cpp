#include "result_table.hpp"

#include <fmt/format.h>

#include <numeric>

namespace {

std::string plural(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

std::string result_table(const flies::FrameRecord& record) {
  std::string table = fmt::format("{}: {}, {}\n", record.left, plural(record.obstacles.size(), "obstacle"),
                                  plural(record.pedestrians.size(), "pedestrian"));
  if (!record.obstacles.empty() || !record.pedestrians.empty())
    table += fmt::format("{:<12}{:>8}{:>8}{:>11}{:>11}{:>12}{:>9}\n", "", "x [m]", "y [m]", "range [m]", "width [m]",
                         "height [m]", "score");
  for (const auto& o : record.obstacles)
    table += fmt::format("{:<12}{:>8.2f}{:>8.2f}{:>11.2f}{:>11.2f}{:>12.2f}{:>9.3g}\n", "obstacle", o.x_m, o.y_m,
                         o.range_m, o.width_m, o.height_m, o.score);
  for (const auto& p : record.pedestrians)
    table += fmt::format("{:<12}{:>8.2f}{:>8.2f}{:>11.2f}{:>11}{:>12.2f}{:>9.3g}\n", "pedestrian", p.x_m, p.y_m,
                         p.range_m, "", p.height_m, p.probability);
  table += fmt::format("{:.0f} ms:", std::accumulate(record.stage_ms.begin(), record.stage_ms.end(), 0.0));
  for (std::size_t i = 0; i < flies::kStageCount; ++i)
    table += fmt::format(" {} {:.1f}", flies::kStageNames[i], record.stage_ms[i]);
  return table + "\n";
}
