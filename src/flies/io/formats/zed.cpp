// SN*.conf of the ZED cameras: https://www.stereolabs.com/docs/opencv/calibration and
// https://github.com/stereolabs/zed-open-capture (examples/include/calibration.hpp); lengths in millimetres.
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/camera_modes.hpp"
#include "flies/io/formats/pose_reading.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

struct Mode {
  const char* name;
  int width_px, height_px;
};
/// Those that are used most first.
constexpr Mode kModes[] = {{"HD", 1280, 720},  {"FHD", 1920, 1080}, {"FHD1200", 1920, 1200},
                           {"2K", 2208, 1242}, {"SVGA", 960, 600},  {"VGA", 672, 376},
                           {"4k", 3840, 2160}, {"4K", 3840, 2160},  {"QHDPLUS", 3200, 1800}};

bool has_mode(const NumberTable& table, const Mode& mode) {
  return table.has(fmt::format("LEFT_CAM_{}.fx", mode.name));
}

/// Firmware of early years writes the other one.
const char* baseline_name(const NumberTable& table) { return table.has("STEREO.BaseLine") ? "BaseLine" : "Baseline"; }

bool has_stereo(const NumberTable& table) { return table.has(fmt::format("STEREO.{}", baseline_name(table))); }

/// That of the images; see `choose_mode`.
/// @throws InputError also where the file was cut short
const Mode& mode_of(const NumberTable& table, const CalibrationRequest& request, CalibrationNotes& notes) {
  if (!has_stereo(table))
    throw InputError(table.source, "[STEREO]",
                     "is missing, or has no Baseline: is the file cut short? Download it again from Stereolabs");
  std::vector<const Mode*> modes;
  std::vector<CameraMode> sizes;
  for (const Mode& mode : kModes)
    if (has_mode(table, mode)) {
      modes.push_back(&mode);
      sizes.push_back({mode.width_px, mode.height_px, table.require_number(fmt::format("LEFT_CAM_{}.fx", mode.name))});
    }
  if (modes.empty())
    throw InputError(
        table.source, "[LEFT_CAM_HD]",
        "is missing or empty, and so are those of all other modes: is the file cut short? Download it again "
        "from Stereolabs");
  auto chosen = choose_mode(sizes, request, table.source);
  notes = std::move(chosen.notes);
  return *modes[chosen.index];
}

RawCamera read_camera(const NumberTable& table, const std::string& side, const Mode& mode) {
  const std::string section = fmt::format("{}_CAM_{}.", side, mode.name);
  const auto number = [&](const char* name) { return table.require_number(section + name); };
  RawCamera raw;
  raw.matrix = camera_matrix(number("fx"), number("fy"), number("cx"), number("cy"));
  const std::string shared = side + "_DISTO.", from = table.has(shared + "k1") ? shared : section;
  // Lenses with k4 and without tangential coefficients are fisheyes.
  const bool is_fisheye = table.has(from + "k4") && !table.has(from + "p1");
  raw.lens = is_fisheye ? Lens::equidistant : Lens::brown;
  raw.distortion = is_fisheye ? coefficients_of(table, from, {"k1", "k2", "k3", "k4"})
                              : coefficients_of(table, from, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"});
  constexpr std::size_t kRational = 8;
  if (!is_fisheye && raw.distortion.size() > 5) raw.distortion.resize(kRational, 0.0);
  return raw;
}

Calibration read_zed(const NumberTable& table, const CalibrationRequest& request) {
  CalibrationNotes notes;
  const Mode& mode = mode_of(table, request, notes);
  RawPair pair{{mode.width_px, mode.height_px, read_camera(table, "LEFT", mode), read_camera(table, "RIGHT", mode)},
               fmt::format("LEFT_CAM_{}", mode.name),
               fmt::format("RIGHT_CAM_{}", mode.name),
               "STEREO",
               std::move(notes)};
  const auto stereo = [&](const std::string& name) { return table.require_number("STEREO." + name); };
  const auto of_mode = [&](const char* name) { return fmt::format("{}_{}", name, mode.name); };
  // Of each mode in the files of newer cameras.
  const auto shift = [&](const char* name) {
    if (table.has("STEREO." + of_mode(name))) return stereo(of_mode(name));
    return table.has(fmt::format("STEREO.{}", name)) ? stereo(name) : 0.0;
  };
  // Stereolabs' zed-open-capture gives Baseline, TY, TZ to OpenCV as they are, which means the same line through both
  // cameras as all three negative.
  Pose right_from_left{rotation_about({stereo(of_mode("RX")), stereo(of_mode("CV")), stereo(of_mode("RZ"))}),
                       {-stereo(baseline_name(table)), -shift("TY"), -shift("TZ")}};
  set_pose(pair.stereo, scaled(right_from_left, kMetresPerMillimetre));
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kZed{
    "ZED SN.conf", false, false,
    [](const NumberTable& table) {
      constexpr int kSeveral = 2;  // one may be of two cameras of another kind, which --baseline completes
      return has_stereo(table) ||
             std::ranges::count_if(kModes, [&](const Mode& mode) { return has_mode(table, mode); }) >= kSeveral;
    },
    read_zed};

}  // namespace flies::detail
