#include "flies/rig/coverage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace flies {
namespace {

constexpr const char* kParts[] = {"top left", "top",         "top right", "left",        "middle",
                                  "right",    "bottom left", "bottom",    "bottom right"};

/// A board that leans less leaves focal length and distance one number.
constexpr double kLeast_deg = 15.0;
constexpr double kLeastRatio = 1.3;

}  // namespace

Coverage coverage_of(const std::vector<BoardPair>& pairs, bool is_right, int width_px, int height_px) {
  Coverage coverage;
  for (const auto& pair : pairs)
    for (const auto& corner : (is_right ? pair.right : pair.left).corners) {
      const auto column =
          std::clamp(static_cast<int>(corner.u_px * Coverage::kColumns / width_px), 0, Coverage::kColumns - 1);
      const auto row = std::clamp(static_cast<int>(corner.v_px * Coverage::kRows / height_px), 0, Coverage::kRows - 1);
      ++coverage.corners[static_cast<std::size_t>(row * Coverage::kColumns + column)];
    }
  return coverage;
}

std::vector<std::string> missing_views(const std::vector<BoardPair>& pairs, const RigSolution& solution) {
  std::vector<std::string> missing;
  for (const bool is_right : {false, true}) {
    const auto coverage = coverage_of(pairs, is_right, solution.raw.width_px, solution.raw.height_px);
    std::vector<std::string> parts;
    for (int row = 0; row < Coverage::kRows; ++row)
      for (int column = 0; column < Coverage::kColumns; ++column)
        if (!coverage.covers(column, row)) parts.emplace_back(kParts[row * Coverage::kColumns + column]);
    if (!parts.empty())
      missing.push_back(fmt::format("hold the board in these parts of the {} image: {}", is_right ? "right" : "left",
                                    fmt::join(parts, ", ")));
  }
  double across_deg = 0.0, down_deg = 0.0, nearest_m = 1e9, farthest_m = 0.0;
  for (const auto& view : solution.views) {
    across_deg = std::max(across_deg, std::abs(view.tilt_across_deg));
    down_deg = std::max(down_deg, std::abs(view.tilt_down_deg));
    nearest_m = std::min(nearest_m, view.distance_m);
    farthest_m = std::max(farthest_m, view.distance_m);
  }
  const auto tell_tilt = [&](double most_deg, const char* sides) {
    if (most_deg < kLeast_deg)
      missing.push_back(
          fmt::format("turn the board's {} side away by 30 degrees; {:.0f} is the most so far", sides, most_deg));
  };
  tell_tilt(across_deg, "left or right");
  tell_tilt(down_deg, "upper or lower");
  if (farthest_m < kLeastRatio * nearest_m)
    missing.push_back(fmt::format("hold the board nearer and farther away: all views are {:.2f} to {:.2f} m away",
                                  nearest_m, farthest_m));
  return missing;
}

}  // namespace flies
