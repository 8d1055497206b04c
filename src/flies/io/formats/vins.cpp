// Configurations of VINS-Fusion, and the camera files of camodocal that they name:
// https://github.com/HKUST-Aerial-Robotics/VINS-Fusion, https://github.com/hengli/camodocal
#include <fmt/format.h>

#include <filesystem>

#include "flies/core/error.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

bool is_of_camera(const NumberTable& table) {
  return table.has("projection_parameters.fx") || table.has("projection_parameters.gamma1") ||
         table.has("projection_parameters.mu");
}

/// The rational one of PINHOLE_FULL is that of PINHOLE with more coefficients.
Lens lens_of_camodocal(const NumberTable& table) {
  const std::string model = table.word("model_type");
  if (model == "pinhole" || model == "pinhole_full") return Lens::brown;
  if (model == "mei") return Lens::mei;
  if (model == "kannala_brandt") return Lens::equidistant;
  throw InputError(table.source, "model_type",
                   fmt::format("found '{}', expected PINHOLE, PINHOLE_FULL, MEI or KANNALA_BRANDT", model));
}

RawCamera read_camera(const NumberTable& table) {
  const std::string projection = "projection_parameters.";
  const auto matrix = [&](const char* fx, const char* fy, const char* cx, const char* cy) {
    return camera_matrix(table.require_number(projection + fx), table.require_number(projection + fy),
                         table.require_number(projection + cx), table.require_number(projection + cy));
  };
  RawCamera raw;
  raw.lens = lens_of_camodocal(table);
  switch (raw.lens) {
    case Lens::equidistant:
      raw.matrix = matrix("mu", "mv", "u0", "v0");
      raw.distortion = {table.require_number(projection + "k2"), table.require_number(projection + "k3"),
                        table.require_number(projection + "k4"), table.require_number(projection + "k5")};
      return raw;
    case Lens::mei: {
      raw.matrix = matrix("gamma1", "gamma2", "u0", "v0");
      raw.distortion = {table.require_number("mirror_parameters.xi")};
      const auto bent = distortion_of(table, "", raw.lens);
      raw.distortion.insert(raw.distortion.end(), bent.begin(), bent.end());
      return raw;
    }
    default:
      raw.matrix = matrix("fx", "fy", "cx", "cy");
      raw.distortion = distortion_of(table, "", raw.lens);
      return raw;
  }
}

/// The file that `cam0_calib` or `cam1_calib` names, beside the configuration; the configuration itself where both
/// cameras are in it.
NumberTable camera_table(const NumberTable& table, const std::string& camera) {
  const auto named = table.entries.find(camera + "_calib");
  if (named == table.entries.end() && is_of_camera(table)) return table;
  if (named == table.entries.end() || named->second.not_a_number.empty())
    throw InputError(table.source, camera + "_calib", "is missing, and names the file of that camera");
  const auto file = std::filesystem::path(table.source).parent_path() / named->second.not_a_number;
  if (!std::filesystem::exists(file))
    throw InputError(table.source, camera + "_calib", fmt::format("names {}, which is not there", file.string()));
  return read_number_table(file.string());
}

ImageSize size_of(const NumberTable& table, const NumberTable& configuration) {
  const NumberTable& from = table.has("image_width") ? table : configuration;
  if (!from.has("image_width")) return {};
  return {from.require_size("image_width"), from.require_size("image_height")};
}

Calibration read_vins(const NumberTable& table, const CalibrationRequest& request) {
  if (!table.has("body_T_cam0") || !table.has("body_T_cam1"))
    throw InputError(table.source, "body_T_cam0, body_T_cam1",
                     "are missing: this file describes one camera without its pose; give the configuration file that "
                     "names the files of both cameras");
  if (!request.right_path.empty())
    throw InputError(request.right_path, "right calibration",
                     fmt::format("is not used: {} names the files of both cameras", table.source));
  const NumberTable left = camera_table(table, "cam0"), right = camera_table(table, "cam1");
  RawPair pair{{}, left.source, right.source, "body_T_cam1"};
  if (left.source == right.source) {
    pair.left_key = pair.right_key = "projection_parameters";
    pair.notes.push_back(
        {"the file describes one lens, which both cameras are taken to have", CalibrationNoteKind::told});
  }
  pair.stereo.left = read_camera(left);
  pair.stereo.right = read_camera(right);
  const Pose body_from_left = pose_of(table, "body_T_cam0", pair.notes);
  const Pose body_from_right = pose_of(table, "body_T_cam1", pair.notes);
  set_body_poses(pair, body_from_left, body_from_right);
  const auto of_left = size_of(left, table), of_right = size_of(right, table);
  check_same_size(of_left, of_right, right.source, "image_width, image_height");
  pair.stereo.width_px = of_left.width_px;
  pair.stereo.height_px = of_left.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kVins{"VINS-Fusion configuration", false, true,
                              [](const NumberTable& table) { return table.has("body_T_cam0") || is_of_camera(table); },
                              read_vins};

}  // namespace flies::detail
