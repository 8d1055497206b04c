#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "flies/road/find_mount.hpp"
#include "flies/road/ground_plane.hpp"

namespace flies {
namespace {

/// What else than a tilt of the camera makes the road appear as if it were tilted: a pitch adds as much to the
/// disparities of all places as a principal point that is off does, a roll the more the farther to the right as another
/// width of one image does.
std::string other_causes_of_tilt(const MountFinding& finding) {
  constexpr double kAlike = 0.08, kLeastTilt_rad = radians(2.0);
  constexpr double kLeastOffset_px = 3.0, kLeastShare = 0.7;
  const GroundPlane told = plane_below(finding.told, finding.scale_px_m);
  const GroundPlane seen = plane_below(finding.mount, finding.scale_px_m);
  if (std::abs(seen.down_px / told.down_px - 1.0) > kAlike) return "";
  const bool pitches = std::abs(finding.mount.pitch_rad - finding.told.pitch_rad) >= kLeastTilt_rad;
  const bool rolls = std::abs(finding.mount.roll_rad - finding.told.roll_rad) >= kLeastTilt_rad;
  const double offset_px = seen.ahead_px - told.ahead_px;
  if (pitches && !rolls && offset_px >= kLeastOffset_px && finding.farthest_px >= kLeastShare * offset_px)
    return fmt::format(
        ". Hardly anything is seen farther away than {:.1f} m: if it looks {:.1f} degrees down, cx of one camera is "
        "some {:.0f} px off and what is seen is farther away than it is said to be",
        finding.scale_px_m / finding.farthest_px, degrees(finding.told.pitch_rad) + 0.0,
        std::min(offset_px, finding.farthest_px));  // no place has less than what cx is off by
  if (rolls && !pitches)
    return fmt::format(". If it leans {:.1f} degrees, one image is narrower than the other: were they resized alike?",
                       degrees(finding.told.roll_rad) + 0.0);
  return "";
}

}  // namespace

std::optional<std::string> mount_note(const MountFinding& finding) {
  if (finding.is_upside_down)
    return "the ground lies above the camera: the images stand on their heads; turn both by 180 degrees and give the "
           "right one as the left, unless that is a ceiling";
  if (!finding.is_replaced) return std::nullopt;
  const CameraMount &told = finding.told, &seen = finding.mount;
  const auto tilt = [](double rad) { return degrees(rad) + 0.0; };
  std::string note = fmt::format(
      "the road lies {:.2f} m below the camera, which looks {:.1f} degrees down and leans {:.1f} to the right, not "
      "{:.2f} m, {:.1f} and {:.1f}: that is used; give it as --camera-height {:.2f} --camera-pitch {:.1f} "
      "--camera-roll {:.1f}, or --mount given for the other",
      seen.height_m, tilt(seen.pitch_rad), tilt(seen.roll_rad), told.height_m, tilt(told.pitch_rad),
      tilt(told.roll_rad), seen.height_m, tilt(seen.pitch_rad), tilt(seen.roll_rad));
  // All ranges grow with the baseline, and so does the height that the road is seen at.
  constexpr double kMuch = 0.15, kNear = 0.35;
  for (const auto& [unit, metres] : {std::pair{"centimetres", 1e-2}, std::pair{"millimetres", 1e-3}})
    if (std::abs(seen.height_m / (told.height_m * metres) - 1.0) < kNear)
      return note + fmt::format(". Was {:.4g} meant in {}?", told.height_m, unit);
  if (std::abs(seen.height_m / told.height_m - 1.0) > kMuch)
    note += fmt::format(
        ". If {:.2f} m was measured, the baseline or the focal length is not that of the cameras but {:.3g} times it",
        told.height_m, seen.height_m / told.height_m);
  return note + other_causes_of_tilt(finding);
}

}  // namespace flies
