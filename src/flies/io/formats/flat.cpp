// Rectified cameras as people write them down by hand: fx, fy, cx, cy, baseline and the size, each under its own key.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

using Names = std::initializer_list<const char*>;

constexpr Names kFocal = {"fx", "fx_px", "f", "f_px", "focal", "focal_px", "focal_length", "focal_length_px"};
constexpr Names kFocalDown = {"fy", "fy_px"};
constexpr Names kColumn = {"cx", "cx_px", "cx_left", "cx0", "ppx", "u0"};
constexpr Names kRightColumn = {"cx_right", "cx_right_px", "cx1"};
constexpr Names kRow = {"cy", "cy_px", "ppy", "v0"};
constexpr Names kBaseline = {"baseline", "baseline_m", "base_line", "b", "B"};
constexpr Names kShift = {"Tx", "tx"};  // of OpenCV, where the right camera's is negative
constexpr Names kWidth = {"width", "width_px", "image_width"};
constexpr Names kHeight = {"height", "height_px", "image_height"};
constexpr Names kLens = {
    "k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "D", "dist", "distortion", "coeffs", "distortion_coefficients"};

/// The name that the table has of these; "" when it has none.
std::string name_in(const NumberTable& table, Names names) {
  const auto found = std::ranges::find_if(names, [&](const char* name) { return table.has(name); });
  return found == names.end() ? "" : *found;
}

/// @param otherwise the name to miss when there is none
double number_of(const NumberTable& table, Names names, const char* otherwise) {
  const std::string name = name_in(table, names);
  return table.require_number(name.empty() ? otherwise : name);
}

double baseline_of(const NumberTable& table, const CalibrationRequest& request) {
  if (const auto name = name_in(table, kBaseline); !name.empty()) return table.require_number(name);
  if (const auto name = name_in(table, kShift); !name.empty()) return std::abs(table.require_number(name));
  return missing_baseline(request, table.source, "baseline");
}

bool has_lens(const NumberTable& table) {
  return std::ranges::any_of(kLens, [&](const char* name) {
    const auto found = table.entries.find(name);
    return found != table.entries.end() &&
           std::ranges::any_of(found->second.numbers, [](double number) { return number != 0.0; });
  });
}

Calibration read_flat(const NumberTable& table, const CalibrationRequest& request) {
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = number_of(table, kFocal, "fx");
  camera.fy_px = name_in(table, kFocalDown).empty() ? camera.fx_px : number_of(table, kFocalDown, "fy");
  camera.cx_px = number_of(table, kColumn, "cx");
  camera.cx_right_px = name_in(table, kRightColumn).empty() ? camera.cx_px : number_of(table, kRightColumn, "cx_right");
  camera.cy_px = number_of(table, kRow, "cy");
  camera.baseline_m = baseline_of(table, request);
  const std::string width = name_in(table, kWidth), height = name_in(table, kHeight);
  if (!width.empty() || !height.empty()) {
    camera.width_px = table.require_size(width.empty() ? "width" : width);
    camera.height_px = table.require_size(height.empty() ? "height" : height);
  }
  calibration.left_name = calibration.right_name = name_in(table, kFocal);
  if (has_lens(table))
    calibration.notes.push_back(
        {"the images are taken as rectified, and the coefficients of distortion left out: for raw images both cameras "
         "must be in the file (OpenCV's M1, D1, M2, D2, R, T)"});
  return calibration;
}

/// The columns of intrinsic.txt behind frame and camera; one camera, as both are alike.
constexpr const char* kVirtualColumns[] = {"K[0,0]", "K[1,1]", "K[0,2]", "K[1,2]"};

Calibration read_virtual_kitti(const NumberTable& table, const CalibrationRequest& request) {
  const auto number = [&](std::size_t column) { return table.require_number(kVirtualColumns[column]); };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = number(0);
  camera.fy_px = number(1);
  camera.cx_px = camera.cx_right_px = number(2);
  camera.cy_px = number(3);
  camera.baseline_m = missing_baseline(request, table.source, "baseline (0.532725 m in Virtual KITTI 2)");
  calibration.left_name = "camera 0";
  calibration.right_name = "camera 1";
  return calibration;
}

}  // namespace

const CalibrationFormat kFlat{
    "flat fx, fy, cx, cy, baseline", false, false,
    [](const NumberTable& table) { return !name_in(table, kFocal).empty() && !name_in(table, kColumn).empty(); },
    read_flat};

const CalibrationFormat kVirtualKitti{"Virtual KITTI intrinsic.txt", false, false,
                                      [](const NumberTable& table) { return table.has(kVirtualColumns[0]); },
                                      read_virtual_kitti};

}  // namespace flies::detail
