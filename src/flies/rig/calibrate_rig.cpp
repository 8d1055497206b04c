#include "flies/rig/calibrate_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"
#include "flies/core/quantile.hpp"
#include "flies/rig/check_solution.hpp"
#include "flies/rig/coverage.hpp"

namespace flies {
namespace {

constexpr std::size_t kLeastViews = 5;
/// Fewer corners say little of a pose, and OpenCV wants six where the board is not flat to it.
constexpr std::size_t kLeastCorners = 8;
/// A view is blurred when its edges are this much wider than those of the others, and wide.
constexpr double kBlurRatio = 2.0, kBlur_px = 4.0;
/// A view is inconsistent when its error is larger than that of the others, and large, and the others agree better
/// without it: one such view bends the whole solution.
constexpr double kErrorRatio = 1.5, kError_px = 0.6, kBetter = 0.75;

const std::string kSource = "calibration";

template <class Value>
double median(const std::vector<Value>& values, double (*of)(const Value&)) {
  std::vector<double> numbers(values.size());
  std::transform(values.begin(), values.end(), numbers.begin(), of);
  return upper_median(std::move(numbers));
}

double blur_of(const BoardPair& pair) { return std::max(pair.left.blur_px, pair.right.blur_px); }

std::string first_reason(const std::vector<DroppedView>& dropped) {
  return dropped.empty() ? "" : fmt::format(", first {} ({})", dropped.front().name, dropped.front().reason);
}

void require_views(const RigReport& report, const std::string& state) {
  if (report.used.size() >= kLeastViews) return;
  throw InputError(kSource, "views",
                   fmt::format("{} {} left, expected at least {}; {} dropped{}", report.used.size(), state, kLeastViews,
                               report.dropped.size(), first_reason(report.dropped)));
}

void drop_poor_views(RigReport& report) {
  std::erase_if(report.used, [&](const BoardPair& pair) {
    const bool is_small = pair.left.corners.size() < kLeastCorners;
    if (is_small)
      report.dropped.push_back({pair.name, fmt::format("only {} corners in both images", pair.left.corners.size())});
    return is_small;
  });
  require_views(report, "with a board in both images are");
  const double usual_px = median(report.used, blur_of);
  std::erase_if(report.used, [&](const BoardPair& pair) {
    const double blur_px = blur_of(pair);
    const bool is_blurred = blur_px > kBlur_px && blur_px > kBlurRatio * usual_px;
    if (is_blurred)
      report.dropped.push_back(
          {pair.name, fmt::format("blurred: edges are {:.1f} px wide, usually {:.1f} px", blur_px, usual_px)});
    return is_blurred;
  });
  require_views(report, "sharp views are");
}

/// Solves, and again without the worst view as long as that one fits the others badly.
void solve(const BoardTools& tools, const Board& board, int width_px, int height_px, Lens lens, RigReport& report) {
  const auto solved = [&](const std::vector<BoardPair>& pairs) {
    auto solution = tools.solve(pairs, board, width_px, height_px, lens);
    if (!solution.failure.empty())
      throw InputError(kSource, "views", fmt::format("give no solution ({})", solution.failure));
    return solution;
  };
  report.solution = solved(report.used);
  for (const std::size_t all = report.used.size(); 2 * report.used.size() > all && report.used.size() > kLeastViews;) {
    const auto& views = report.solution.views;
    const auto worst = std::max_element(views.begin(), views.end(),
                                        [](const ViewError& a, const ViewError& b) { return a.rms_px < b.rms_px; });
    const double usual_px = median(
        views, +[](const ViewError& view) { return view.rms_px; });
    if (worst->rms_px < kError_px || worst->rms_px < kErrorRatio * usual_px) return;
    auto others = report.used;
    others.erase(others.begin() + (worst - views.begin()));
    auto solution = solved(others);
    if (solution.rms_px > kBetter * report.solution.rms_px) return;
    report.dropped.push_back({report.used[static_cast<std::size_t>(worst - views.begin())].name,
                              fmt::format("does not fit the others, whose corners are {:.2f} px off with it and {:.2f} "
                                          "px without it; did both cameras take it at the same moment?",
                                          report.solution.rms_px, solution.rms_px)});
    report.used = std::move(others);
    report.solution = std::move(solution);
  }
}

}  // namespace

RigReport calibrate_rig(const BoardTools& tools, const Board& board, std::vector<BoardPair> pairs, int width_px,
                        int height_px, Lens lens) {
  RigReport report;
  report.used = std::move(pairs);
  drop_poor_views(report);
  solve(tools, board, width_px, height_px, lens, report);
  for (auto& note : check_solution(tools, board, report.used, report.solution)) report.notes.push_back(std::move(note));
  report.calibration.rectifier.emplace(report.solution.raw, kSource);
  report.calibration.camera = report.calibration.rectifier->camera();
  for (auto& note : detail::check_plausible(report.calibration.camera, kSource))
    report.notes.push_back(std::move(note));
  for (auto& missing : missing_views(report.used, report.solution)) report.notes.push_back(std::move(missing));
  return report;
}

}  // namespace flies
