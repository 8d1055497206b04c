// Bouguet's Camera Calibration Toolbox for MATLAB: fc_left, cc_left, kc_left, ..., om and T, as text (name = [ ... ];)
// or under the same names in YAML or JSON. om and T take points of the left camera into the frame of the right one.
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

RawCamera bouguet_camera(const NumberTable& table, const std::string& side) {
  const auto& focal = table.require("fc_" + side, 2);
  const auto& centre = table.require("cc_" + side, 2);
  auto matrix = camera_matrix(focal[0], focal[1], centre[0], centre[1]);
  const std::string skew = "alpha_c_" + side;
  if (table.has(skew)) matrix[1] = table.require_number(skew) * focal[0];
  return {matrix, table.require("kc_" + side), Lens::brown};
}

/// The toolbox has the unit of the board's squares, which it asks for in millimetres.
double metres_per_unit(const std::vector<double>& t, CalibrationNotes& notes) {
  const bool is_millimetres = are_millimetres(t);
  notes.push_back({std::string("T is taken as ") +
                   (is_millimetres ? "millimetres, in which the toolbox asks for the squares of the board" : "metres") +
                   " (correct it with --baseline M)"});
  return is_millimetres ? 1e-3 : 1.0;
}

Calibration read_bouguet(const NumberTable& table, const CalibrationRequest& request) {
  const bool has_matrix = !table.has("om") && table.has("R");
  RawPair pair{{}, "fc_left", "fc_right", has_matrix ? "R" : "om"};
  pair.distortion_keys = {"kc_left", "kc_right"};
  pair.stereo.left = bouguet_camera(table, "left");
  pair.stereo.right = bouguet_camera(table, "right");
  const auto& t = table.require("T", 3);
  set_pose(pair.stereo,
           scaled({rotation_of(table, pair.pose_key, pair.notes), {t[0], t[1], t[2]}}, metres_per_unit(t, pair.notes)));
  if (table.has("nx") || table.has("ny")) {
    pair.stereo.width_px = table.require_size("nx");
    pair.stereo.height_px = table.require_size("ny");
  }
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kBouguet{"Bouguet's toolbox", false, false,
                                 [](const NumberTable& table) { return table.has("fc_left") || table.has("fc_right"); },
                                 read_bouguet};

}  // namespace flies::detail
