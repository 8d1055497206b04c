#include "flies/io/formats/camera_modes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"

namespace flies::detail {
namespace {

std::string size_of(const CameraMode& mode) { return fmt::format("{} x {}", mode.width_px, mode.height_px); }

std::string sizes_of(const std::vector<CameraMode>& modes) {
  std::vector<std::string> sizes(modes.size());
  std::ranges::transform(modes, sizes.begin(), size_of);
  return modes.empty() ? "none known" : fmt::format("{}", fmt::join(sizes, ", "));
}

bool is_of_size(const CameraMode& mode, int width_px, int height_px) {
  return mode.width_px == width_px && mode.height_px == height_px;
}

/// How many pixels of a mode lie along one of the images; more than any where that is no whole number: people halve
/// images more often than they take a third of them, and that more often than 0.43.
int divisor(const CameraMode& mode, const CalibrationRequest& request) {
  constexpr int kNone = 1000;
  const int across = mode.width_px / request.width_px;
  return is_of_size(mode, across * request.width_px, across * request.height_px) ? across : kNone;
}

/// That images which were resized may be of another mode; nothing where that would leave ranges as they are.
CalibrationNotes notes_on_others(const std::vector<CameraMode>& modes, const std::vector<std::size_t>& fitting,
                                 std::size_t taken, const CalibrationRequest& request) {
  constexpr double kSame = 0.01;
  const auto share = [&](std::size_t i) { return modes[i].focal_px / modes[i].width_px; };
  std::vector<std::string> others, factors;
  for (const std::size_t i : fitting) {
    const double factor = share(i) / share(taken);
    if (i == taken || std::abs(factor - 1.0) <= kSame) continue;
    others.push_back(size_of(modes[i]));
    factors.push_back(fmt::format("{:.3g}", factor));
  }
  if (others.empty()) return {};
  return {
      {fmt::format("images of {} x {} px are taken as resized from the mode of {} px; if they come from {} instead, "
                   "ranges are {} times those printed: choose the mode with --calib-size W,H",
                   request.width_px, request.height_px, size_of(modes[taken]), fmt::join(others, " or "),
                   fmt::join(factors, " or "))}};
}

std::size_t mode_that_is_said(const std::vector<CameraMode>& modes, const CalibrationRequest& request,
                              const std::string& source) {
  const auto said = std::ranges::find_if(modes, [&](const CameraMode& mode) {
    return is_of_size(mode, request.calibrated_width_px, request.calibrated_height_px);
  });
  if (said == modes.end())
    throw InputError(source, "image size",
                     fmt::format("found {} x {} px in --calib-size, which is none of the modes of this file: {}",
                                 request.calibrated_width_px, request.calibrated_height_px, sizes_of(modes)));
  return static_cast<std::size_t>(said - modes.begin());
}

}  // namespace

ChosenMode choose_mode(const std::vector<CameraMode>& modes, const CalibrationRequest& request,
                       const std::string& source) {
  if (request.calibrated_width_px > 0) return {mode_that_is_said(modes, request, source)};
  if (request.width_px == 0 && !modes.empty()) return {};
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (is_of_size(modes[i], request.width_px, request.height_px)) return {i};
    if (one_scale(modes[i].width_px, modes[i].height_px, request.width_px, request.height_px)) fitting.push_back(i);
  }
  if (fitting.empty())
    throw InputError(
        source, "image size",
        fmt::format("found {} x {} px, which is none of the modes of this file: {}; if the images were resized by "
                    "different factors horizontally and vertically, choose the mode with --resized --calib-size W,H",
                    request.width_px, request.height_px, sizes_of(modes)));
  const auto taken = *std::ranges::min_element(fitting, {}, [&](std::size_t i) { return divisor(modes[i], request); });
  return {taken, notes_on_others(modes, fitting, taken, request)};
}

}  // namespace flies::detail
