#include "flies/rig/check_solution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "flies/core/error.hpp"
#include "flies/core/plausible.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/rig/turned_images.hpp"

namespace flies {
namespace {

const std::string kSource = "calibration";

/// Corners of good sets lie within 0.1 to 0.5 px, for cameras of any size.
constexpr double kNotedError_px = 0.5, kMostError_px = 1.5;
/// A board that is not flat or a lens of another model costs a few pixels, a board of another layout far more.
constexpr double kOtherBoard_px = 20.0;
/// Where both cameras see the board in the same place, they fit together about as well as each alone: 1.0 to 1.4 times.
constexpr double kNotedApart = 2.0, kMostApart = 3.0;
constexpr double kNotedApart_px = 0.1, kMostApart_px = 0.6;
/// Standard deviation of the focal length over it.
constexpr double kNotedDeviation = 0.005, kMostDeviation = 0.03;

using Vector = std::array<double, 3>;

/// Of the right camera, in the frame of the left one.
Vector right_centre_m(const RawStereo& raw) {
  Vector centre{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) centre[i] -= raw.rotation[3 * k + i] * raw.translation_m[k];
  return centre;
}

/// By how much the right camera is turned about its own axis against the left one.
double roll_rad(const RawStereo& raw) {
  return std::atan2(raw.rotation[3] - raw.rotation[1], raw.rotation[0] + raw.rotation[4]);
}

/// By how much a range is off that is told by a disparity as wrong as the corners are.
std::string at_ten_metres(const RigSolution& solution) {
  constexpr double kTold_m = 10.0;
  const auto& t = solution.raw.translation_m;
  const double moved_m =
      kTold_m * kTold_m * solution.rms_px / (solution.raw.left.matrix[0] * std::hypot(t[0], t[1], t[2]));
  return fmt::format("{:.1f} m or more at {:.0f} m", moved_m, kTold_m);
}

[[noreturn]] void refuse_pairs(const BoardTools& tools, const Board& board, const std::vector<BoardPair>& pairs,
                               const RigSolution& solution) {
  if (const auto turned = turned_images(tools, board, pairs, solution); !turned.empty())
    throw InputError(kSource, "images", turned);
  throw InputError(kSource, "error",
                   fmt::format("corners are {:.2f} px off on average with both cameras together, {:.2f} px with each "
                               "alone: left and right images do not belong together; were they taken at the same "
                               "moment, are they in the same order, and was the board held still?",
                               solution.rms_px, solution.alone_rms_px));
}

void require_fit(const BoardTools& tools, const Board& board, const std::vector<BoardPair>& pairs,
                 const RigSolution& solution) {
  if (solution.rms_px <= kMostError_px) return;
  if (solution.alone_rms_px <= kMostError_px) refuse_pairs(tools, board, pairs, solution);
  const bool is_other_board = solution.alone_rms_px > kOtherBoard_px;
  throw InputError(
      kSource, "error",
      fmt::format("corners are {:.2f} px off on average, with one camera alone {:.2f} px, expected less than {}: {}",
                  solution.rms_px, solution.alone_rms_px, kMostError_px,
                  is_other_board
                      ? "the board has another layout or other counts than --kind and --board say"
                      : "is the board flat and printed without distortion, and are --marker and --lens right?"));
}

void require_side_by_side(const RawStereo& raw) {
  constexpr double kMostRoll_rad = 0.25 * std::numbers::pi, kUpsideDown_rad = 0.75 * std::numbers::pi;
  const double roll = std::abs(roll_rad(raw));
  const auto centre_m = right_centre_m(raw);
  if (roll > kUpsideDown_rad)
    throw InputError(kSource, "images",
                     fmt::format("those of the {} camera are upside down: turn them by 180 degrees",
                                 centre_m[0] > 0.0 ? "right" : "left"));
  if (roll > kMostRoll_rad)
    throw InputError(
        kSource, "images",
        fmt::format("right ones are turned by {:.0f} degrees against left ones: turn them all upright", degrees(roll)));
  if (std::abs(centre_m[1]) > std::abs(centre_m[0]))
    throw InputError(
        kSource, "baseline",
        fmt::format("the right camera stands {:.3f} m {} the left one and {:.3f} m beside it: cameras one above the "
                    "other are not supported; if the cameras lie on their sides, turn the images by 90 degrees",
                    std::abs(centre_m[1]), centre_m[1] > 0.0 ? "below" : "above", std::abs(centre_m[0])));
  if (std::abs(centre_m[2]) > std::abs(centre_m[0]))
    throw InputError(
        kSource, "baseline",
        fmt::format("the right camera stands {:.3f} m {} the left one and {:.3f} m beside it: they must "
                    "stand side by side",
                    std::abs(centre_m[2]), centre_m[2] > 0.0 ? "before" : "behind", std::abs(centre_m[0])));
  if (centre_m[0] < 0.0)
    throw InputError(
        kSource, "baseline",
        "left and right are swapped, or all images are upside down or mirrored: the right camera stands to the left");
}

/// A board that moves between both shots is seen in two places.
void check_moment(const RigSolution& solution, std::vector<std::string>& notes) {
  const double apart = solution.rms_px / std::max(solution.alone_rms_px, 1e-6);
  const auto sentence = [&] {
    return fmt::format(
        "corners are {:.2f} px off with both cameras together, only {:.2f} px with each alone, rows {:.2f} "
        "px apart: the board or the cameras moved between left and right images; ranges are wrong by {}",
        solution.rms_px, solution.alone_rms_px, solution.row_px, at_ten_metres(solution));
  };
  if (apart > kMostApart && solution.rms_px > kMostApart_px)
    throw InputError(kSource, "error", sentence() + "; hold the board still, or fix it, and take the pairs again");
  if (apart > kNotedApart && solution.rms_px > kNotedApart_px) {
    notes.push_back(sentence());
  } else if (solution.rms_px > kNotedError_px) {
    notes.push_back(
        fmt::format("corners are {:.2f} px off (0.1 to {} in good sets): is the board flat, were images blurred, did "
                    "the board move between left and right? Ranges may be wrong by {}",
                    solution.rms_px, kNotedError_px, at_ten_metres(solution)));
  }
}

double most_lean_deg(const RigSolution& solution) {
  double most_deg = 0.0;
  for (const auto& view : solution.views)
    most_deg = std::max({most_deg, std::abs(view.tilt_across_deg), std::abs(view.tilt_down_deg)});
  return most_deg;
}

/// Of both cameras as they are: rectification, which makes pixels square, would hide it.
void check_each_camera(const RawStereo& raw, std::vector<std::string>& notes) {
  for (const auto* camera : {&raw.left, &raw.right}) {
    StereoCamera alone;
    alone.fx_px = camera->matrix[0];
    alone.fy_px = camera->matrix[4];
    alone.width_px = raw.width_px;
    const char* name = camera == &raw.left ? "left camera" : "right camera";
    for (const auto& note : detail::check_focal_length(alone, kSource, name, camera->lens != Lens::brown))
      notes.push_back(fmt::format("{}: {}", name, note));
  }
}

void check_deviation(const RigSolution& solution, std::vector<std::string>& notes) {
  if (solution.focal_deviation <= kNotedDeviation) return;
  const auto known = fmt::format("known to {:.1f} % only", 100.0 * solution.focal_deviation);
  constexpr double kEnough_deg = 15.0;
  const double lean_deg = most_lean_deg(solution);
  const auto lean = lean_deg < kEnough_deg ? fmt::format("the board was tilted by {:.0f} degrees at most", lean_deg)
                                           : std::string("the views are too much alike");
  if (solution.focal_deviation > kMostDeviation)
    throw InputError(kSource, "focal length",
                     fmt::format("is {}, expected {} %, and so are all ranges: {}; tilt the board, do not only hold it "
                                 "straight before the cameras",
                                 known, 100.0 * kMostDeviation, lean));
  notes.push_back(
      fmt::format("the focal length is {}, and all ranges may be as wrong: {}; take more views with the board tilted",
                  known, lean));
}

}  // namespace

std::vector<std::string> check_solution(const BoardTools& tools, const Board& board,
                                        const std::vector<BoardPair>& pairs, const RigSolution& solution) {
  std::vector<std::string> notes;
  require_fit(tools, board, pairs, solution);
  check_moment(solution, notes);
  check_deviation(solution, notes);
  check_each_camera(solution.raw, notes);
  require_side_by_side(solution.raw);
  return notes;
}

}  // namespace flies
