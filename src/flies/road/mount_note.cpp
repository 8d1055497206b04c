#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "flies/road/find_mount.hpp"
#include "flies/road/ground_plane.hpp"

namespace flies {
namespace {

/// Degrees as they are printed, to a tenth; no negative zero.
double tenths_deg(double tilt_rad) { return std::round(10.0 * degrees(tilt_rad)) / 10.0 + 0.0; }

std::string pitch_words(double pitch_rad) {
  const double down_deg = tenths_deg(pitch_rad);
  return fmt::format("{:.1f} degrees {}", std::abs(down_deg), down_deg < 0.0 ? "up" : "down");
}

std::string roll_words(double roll_rad) {
  const double right_deg = tenths_deg(roll_rad);
  return fmt::format("{:.1f} to the {}", std::abs(right_deg), right_deg < 0.0 ? "left" : "right");
}

/// What a principal point that is off does where the road bears it: nothing lies far away, and the road rises. Of 134
/// good pairs none but of rooms have more than 9.8 px everywhere; 11 px are 35 m for the camera of a car.
std::optional<std::string> doubt_on_offset(const MountFinding& finding) {
  constexpr double kLeastFarthest_px = 11.0, kRoom_m = 15.0;
  const double offset_px = finding.rise_px(), farthest_px = finding.farthest_px;
  if (offset_px < kDoubtfulRise_px || farthest_px < kLeastFarthest_px) return std::nullopt;
  const double farthest_m = finding.scale_px_m / farthest_px;
  if (farthest_m < kRoom_m) return std::nullopt;
  return fmt::format(
      "hardly anything is seen farther away than {:.0f} m, and the road seems to rise as if the camera looked {:.1f} "
      "degrees farther down: is the view blocked there? If not, cx of one camera is some {:.0f} to {:.0f} px off, and "
      "everything is farther away than reported",
      farthest_m, degrees(std::atan(offset_px * finding.told.height_m / finding.scale_px_m)),
      std::min(offset_px, farthest_px), std::max(offset_px, farthest_px));
}

/// Ranges, and the height above the ground with them, grow with the baseline.
std::string deep_ground_note(const MountFinding& finding) {
  constexpr double kNear = 0.25;
  const double factor = finding.deep_ground_m / finding.told.height_m;
  std::string note = fmt::format(
      "the road is not where cameras of vehicles see it, but {0:.1f} m below this camera: if it is that high, give "
      "--camera-height {0:.1f}; if not, its baseline of {1:.4g} m is too long",
      finding.deep_ground_m, finding.baseline_m);
  for (const auto& [unit, metres] :
       {std::pair{"decimetres", 0.1}, std::pair{"inches", 0.0254}, std::pair{"feet", 0.3048}})
    if (std::abs(factor * metres - 1.0) < kNear)
      return note + fmt::format(" (was it meant in {}, {:.3g} m?)", unit, finding.baseline_m * metres);
  return note + fmt::format(" ({:.3g} m would put the road {:.2f} m below it: was the square of the board too large?)",
                            finding.baseline_m / factor, finding.told.height_m);
}

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
  const double offset_px = finding.rise_px();
  if (pitches && !rolls && offset_px >= kLeastOffset_px && finding.farthest_px >= kLeastShare * offset_px)
    return fmt::format(
        ". Hardly anything is seen farther away than {:.1f} m: if the camera does look {}, cx of one camera is some "
        "{:.0f} px off and everything is farther away than reported",
        finding.scale_px_m / finding.farthest_px, pitch_words(finding.told.pitch_rad),
        std::min(offset_px, finding.farthest_px));  // no place has less than what cx is off by
  if (rolls && !pitches)
    return fmt::format(
        ". If the camera does lean {}, one image is narrower than the other: were both resized by the same factor?",
        roll_words(finding.told.roll_rad));
  if (const auto doubt = pitches ? std::nullopt : doubt_on_offset(finding)) return "; " + *doubt;
  return "";
}

}  // namespace

std::string tilt_words(const CameraMount& mount) {
  return pitch_words(mount.pitch_rad) + ", " + roll_words(mount.roll_rad);
}

std::optional<std::string> mount_note(const MountFinding& finding) {
  if (finding.is_upside_down)
    return "the ground lies above the camera: the images are upside down; turn both by 180 degrees and give the right "
           "one as the left, unless that is a ceiling";
  if (finding.deep_ground_m > 0.0) return deep_ground_note(finding);
  if (!finding.is_replaced) return finding.is_confirmed ? doubt_on_offset(finding) : std::nullopt;
  const CameraMount &told = finding.told, &seen = finding.mount;
  std::string note = fmt::format(
      "the road lies {:.2f} m below the camera, which looks {} and leans {}, not {:.2f} m, {} and {}: what the road "
      "shows is used; confirm it with --camera-height {:.2f} --camera-pitch {:.1f} --camera-roll {:.1f}, or use the "
      "other values with --mount given",
      seen.height_m, pitch_words(seen.pitch_rad), roll_words(seen.roll_rad), told.height_m, pitch_words(told.pitch_rad),
      roll_words(told.roll_rad), seen.height_m, tenths_deg(seen.pitch_rad), tenths_deg(seen.roll_rad));
  // All ranges grow with the baseline, and so does the height that the road is seen at.
  constexpr double kMuch = 0.15, kNear = 0.35;
  for (const auto& [unit, metres] : {std::pair{"centimetres", 1e-2}, std::pair{"millimetres", 1e-3}})
    if (std::abs(seen.height_m / (told.height_m * metres) - 1.0) < kNear)
      return note + fmt::format(". Is {:.4g} in {}?", told.height_m, unit);
  if (std::abs(seen.height_m / told.height_m - 1.0) > kMuch)
    note += fmt::format(
        ". If {:.2f} m was measured, the baseline or the focal length of the calibration is not that of the cameras "
        "but {:.3g} times as large",
        told.height_m, seen.height_m / told.height_m);
  return note + other_causes_of_tilt(finding);
}

}  // namespace flies
