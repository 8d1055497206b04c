// How far apart the cameras of a calibration stand: what is said of it, and what is wrong with what a file says.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

/// Of formats that say the baseline times the focal length.
bool says_focal_lengths(const Calibration& calibration) {
  constexpr std::array kTimesFocal = {&kKittiObject,   &kKittiRaw, &kKittiOdometry,
                                      &kRosCameraInfo, &kOrbSlam,  &kStellaVslam};
  return !calibration.rectifier &&
         std::ranges::any_of(kTimesFocal, [&](const auto* format) { return calibration.format == format->name; });
}

/// Where the file has the baseline: one name or two.
std::string names_of(const Calibration& calibration) {
  return calibration.left_name == calibration.right_name ? calibration.left_name
                                                         : calibration.left_name + " and " + calibration.right_name;
}

/// @throws InputError for a baseline in metres where the format has it times the focal length
void check_focal_times_baseline(const Calibration& calibration, const std::string& source) {
  constexpr double kSmall_m = 0.005, kLikely_m = 0.03, kLikelyMost_m = 1.5;
  const auto& camera = calibration.camera;
  const double meant_m = camera.baseline_m * camera.fx_px;
  if (!says_focal_lengths(calibration) || !(camera.baseline_m > 0.0) || camera.baseline_m >= kSmall_m ||
      meant_m < kLikely_m || meant_m > kLikelyMost_m)
    return;
  throw InputError(source, "baseline",
                   fmt::format("found {:.4g} m ({}): were metres written ({:.4g} m) where the format has the focal "
                               "length times metres ({:.4g})? --baseline M gives the right one",
                               camera.baseline_m, names_of(calibration), meant_m, meant_m * camera.fx_px));
}

/// @throws InputError for a baseline that no option mends
void check_baseline(const Calibration& calibration, const CalibrationRequest& request, const std::string& source) {
  const double baseline_m = calibration.camera.baseline_m;
  const std::string pair = names_of(calibration);
  if (baseline_m < 0.0) {
    std::string causes = calibration.left_name == calibration.right_name
                             ? "expected a distance, above 0: is it a translation, or are left and right swapped?"
                             : fmt::format("left and right are swapped ({})", pair);
    if (calibration.format == kKalibr.name || calibration.format == kBasalt.name)  // whose names end in the camera
      causes +=
          fmt::format(" (--cameras {},{} exchanges them)", calibration.right_name.back(), calibration.left_name.back());
    if (calibration.rectifier)
      causes +=
          ", or rotation and translation (R, T) are the pose of the right camera instead of the transformation of "
          "points from the left camera to the right one";
    throw InputError(source, "baseline", fmt::format("found {:.4g} m: {}", baseline_m, causes));
  }
  if (baseline_m == 0.0 && (calibration.rectifier || !request.baseline_m))
    throw InputError(
        source, "baseline",
        fmt::format("found 0 m: both cameras are in the same place ({}){}", pair,
                    calibration.rectifier ? "" : "; if the file leaves it out, give it with --baseline M"));
}

}  // namespace

double missing_baseline(const CalibrationRequest& request, const std::string& source, const std::string& key) {
  if (request.baseline_m) return 0.0;
  throw InputError(source, key, "is missing: give the distance between the cameras (--baseline M)");
}

void check_asked_baseline(double baseline_m, const std::string& source) {
  if (!(baseline_m > 0.0) || !std::isfinite(baseline_m))
    throw InputError(source, "baseline", fmt::format("found {} m, expected more than 0", baseline_m));
}

void override_baseline(double baseline_m, const std::string& source, Calibration& calibration) {
  const double found_m = calibration.camera.baseline_m;
  if (!(found_m >= 0.0) || (found_m == 0.0 && calibration.rectifier)) return;
  check_asked_baseline(baseline_m, source);
  constexpr double kSame = 1e-9;
  if (std::abs(found_m - baseline_m) <= kSame * baseline_m) return;
  calibration.camera.baseline_m = baseline_m;
  if (calibration.rectifier) {
    RawStereo raw = calibration.rectifier->raw();
    for (double& t : raw.translation_m) t *= baseline_m / found_m;
    calibration.rectifier.emplace(raw, source);
    calibration.camera = calibration.rectifier->camera();
  }
  const std::string instead = found_m > 0.0 ? fmt::format("{:.4g} as in the file", found_m) : "in the file";
  calibration.notes.push_back(
      {fmt::format("the baseline is {:.4g} m as given, not {}", baseline_m, instead), CalibrationNoteKind::told});
}

void settle_baseline(const CalibrationRequest& request, const std::string& source, Calibration& calibration) {
  check_baseline(calibration, request, source);
  if (request.baseline_m)
    override_baseline(*request.baseline_m, source, calibration);
  else
    check_focal_times_baseline(calibration, source);
}

}  // namespace flies::detail
