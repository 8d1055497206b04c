#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/writers.hpp"

namespace flies {
namespace {

/// RFC 4180: quoted when it holds a separator, a quote or a line break; quotes are doubled.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return {};
  return fmt::format("{:.{}f}", value, decimals);
}
std::string metres(double value_m) { return number(value_m, 3); }
std::string pixels(double value_px) { return number(value_px, 2); }
std::string score_of(double score) { return std::isfinite(score) ? fmt::format("{:.6g}", score) : std::string(); }

}  // namespace

std::string csv_header() {
  return "frame,left,right,kind,x_m,y_m,range_m,width_m,depth_m,height_m,score,probability,u_px,v_px,width_px,height_"
         "px,range_sd_m\n";
}

std::string csv_rows(const FrameRecord& record) {
  const std::string start = fmt::format("{},{},{}", record.frame, quoted(record.left), quoted(record.right));
  std::string rows;
  const auto add_row = [&](const char* kind, const auto& found, const std::string& width_m, const std::string& depth_m,
                           const std::string& score, const std::string& probability) {
    rows += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", start, kind, metres(found.x_m),
                        metres(found.y_m), metres(found.range_m), width_m, depth_m, metres(found.height_m), score,
                        probability, pixels(found.box.u_px), pixels(found.box.v_px), pixels(found.box.width_px),
                        pixels(found.box.height_px), metres(found.range_sd_m));
  };
  for (const auto& obstacle : record.obstacles)
    add_row("obstacle", obstacle, metres(obstacle.width_m), metres(obstacle.depth_m), score_of(obstacle.score), "");
  for (const auto& pedestrian : record.pedestrians)
    add_row("pedestrian", pedestrian, "", "", "", score_of(pedestrian.probability));
  return rows;
}

std::string scan_csv_header() { return "frame,angle_rad,angle_deg,state,range_m,free_m,confidence,range_sd_m\n"; }

std::string scan_csv_rows(const FrameRecord& record) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const Scan& scan = record.scan;
  std::string rows;
  for (std::size_t sector = 0; sector < scan.size(); ++sector) {
    const double angle_rad = scan.angle_rad(sector);
    const double deviation_m = record.run ? range_deviation_m(record.run->camera, scan.ranges_m[sector]) : kUnknown;
    rows += fmt::format("{},{},{},{},{},{},{},{}\n", record.frame, number(angle_rad, 6), number(degrees(angle_rad), 4),
                        kSectorStateNames[static_cast<std::size_t>(scan.states[sector])], metres(scan.ranges_m[sector]),
                        metres(scan.free_m[sector]), score_of(scan.confidence[sector]), metres(deviation_m));
  }
  return rows;
}

}  // namespace flies
