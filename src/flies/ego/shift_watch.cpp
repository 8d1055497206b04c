#include "flies/ego/shift_watch.hpp"

#include <fmt/format.h>

#include <cmath>

#include "flies/core/quantile.hpp"

namespace flies {
namespace {

constexpr std::size_t kMostPairs = 200;  // of a long run, the latest
constexpr double kSure = 3.0;            // times the spread from pair to pair

/// From where on a shift is told. What moves along with the camera stays in view for a while, and pairs that follow
/// each other are wrong alike (docs/adr/0021).
double told_px(std::size_t pairs) {
  constexpr std::size_t kMany = 40;
  return pairs < kMany ? 2.5 : 1.5;
}

/// What is said to be so far away, as an example: the farthest that is not beyond infinity in truth.
double example_m(double scale_px_m, double shift_px) {
  constexpr double kLeast = 0.25;  // of the disparity, in truth
  for (const double range_m : {20.0, 10.0, 5.0, 2.0})
    if (scale_px_m / range_m + shift_px > kLeast * scale_px_m / range_m) return range_m;
  return 1.0;
}

}  // namespace

std::string note_on_shift(const DisparityShift& shift, std::size_t pairs, const StereoCamera& camera) {
  if (std::abs(shift.px) < told_px(pairs) || std::abs(shift.px) < kSure * shift.deviation_px) return {};
  const double scale_px_m = camera.fx_px * camera.baseline_m;
  const double said_m = example_m(scale_px_m, shift.px), true_px = scale_px_m / said_m + shift.px;
  const auto truth =
      true_px > 0.0 ? fmt::format("is really at {:.1f} m", scale_px_m / true_px) : "is really far beyond that";
  return fmt::format(
      "judged by how corners move from pair to pair, all disparities are {:.1f} px too {} ({} pairs, which differ by "
      "{:.1f} px): the cameras are turned against each other, or a principal point is wrong; what is reported at {:g} "
      "m {}. Calibrate again; until then --disparity-shift {:.1f} corrects it, if everything else is right (cx of the "
      "right camera should be {:.1f})",
      std::abs(shift.px), shift.px > 0.0 ? "small" : "large", pairs, shift.deviation_px, said_m, truth, shift.px,
      camera.cx_right_px + shift.px);
}

void DisparityShiftWatch::look(const EgoMotion& ego) {
  if (!ego.disparity_shift) return;
  if (shifts_px_.size() == kMostPairs) shifts_px_.erase(shifts_px_.begin());
  shifts_px_.push_back(ego.disparity_shift->px);
}

std::optional<DisparityShift> DisparityShiftWatch::shift() const {
  constexpr double kBelow = 1.0 / 6.0;
  if (shifts_px_.size() < kLeastPairs) return std::nullopt;
  return DisparityShift{*median(shifts_px_), 0.5 * (quantile(shifts_px_, 1.0 - kBelow) - quantile(shifts_px_, kBelow))};
}

std::string DisparityShiftWatch::first_note(const StereoCamera& camera) {
  const auto found = shift();
  if (is_told_ || !found) return {};
  auto note = note_on_shift(*found, pairs(), camera);
  is_told_ = !note.empty();
  return note;
}

}  // namespace flies
