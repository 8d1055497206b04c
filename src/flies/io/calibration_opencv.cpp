// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

ImageSize size_of(const NumberTable& table, const OpenCvNames& names) {
  constexpr std::size_t kList = 2;  // a longer one tells its order itself
  if (!names.size.empty()) {
    const auto size = size_of_list(table, names.size);
    const bool is_exchanged = names.is_rows_first && table.require(names.size).size() == kList;
    return is_exchanged ? ImageSize{size.height_px, size.width_px} : size;
  }
  if (names.sides[0].empty()) return {};
  return {table.require_size(names.sides[0]), table.require_size(names.sides[1])};
}

/// First and last column, first and last row of a cropped image.
ImageSize size_of_crop(const NumberTable& table) {
  if (!table.has("roi")) return {};
  const auto& roi = table.require("roi", 4);
  const auto pixels = [&](double first, double last) {
    NumberTable size{table.source, {}};
    size.entries["roi"].numbers = {last - first + 1.0};
    return size.require_size("roi");
  };
  return {pixels(roi[0], roi[1]), pixels(roi[2], roi[3])};
}

/// A camera matrix, or fx, fy, cx, cy.
std::array<double, 9> intrinsics_of(const NumberTable& table, const std::string& key) {
  constexpr std::size_t kFew = 4;
  const auto& numbers = table.require(key);
  if (numbers.size() != kFew) return matrix_of(table, key);
  return camera_matrix(numbers[0], numbers[1], numbers[2], numbers[3]);
}

/// A file whose lenses are free of distortion has nothing that looks like coefficients.
void check_no_distortion(const NumberTable& table) {
  constexpr std::size_t kFewest = 4, kMost = 14;
  for (const auto& [key, entry] : table.entries) {
    const auto count = entry.numbers.size();
    if ((key.starts_with('d') || key.starts_with('D')) && count >= kFewest && count <= kMost)
      throw InputError(
          table.source, key,
          fmt::format("found {} numbers: are they distortion coefficients? expected those as D1 and D2", count));
  }
}

/// MATLAB's world units are millimetres unless somebody chose others.
double metres_per_unit(const OpenCvNames& names, const std::vector<double>& t, CalibrationNotes& notes) {
  if (!names.is_of_matlab) return 1.0;
  const bool is_millimetres = are_millimetres(t);
  notes.push_back({fmt::format("{} is taken as {} (correct it with --baseline M)", names.translation,
                               is_millimetres ? "millimetres, as MATLAB's world units are" : "metres")});
  return is_millimetres ? 1e-3 : 1.0;
}

Calibration read_raw(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  const auto size = size_of(table, names);
  RawPair pair{{}, names.matrices[0], names.matrices[1], names.pose.empty() ? names.rotation : names.pose};
  const Lens lens = names.are_fisheyes          ? Lens::equidistant
                    : !names.mirrors[0].empty() ? Lens::mei
                                                : named_lens(table, pair.notes);
  // OpenCV's own names stand in for those that are not there.
  const bool is_undistorted = !table.has(names.distortions[0]) && !table.has(names.distortions[1]);
  if (is_undistorted) {
    check_no_distortion(table);
    pair.notes.push_back({"the file has no distortion coefficients: the lenses are taken as free of distortion"});
  }
  if (!is_undistorted) pair.distortion_keys = names.distortions;
  const auto camera_of = [&](std::size_t side) {
    RawCamera camera{intrinsics_of(table, names.matrices[side]), {}, lens};
    if (!is_undistorted) camera.distortion = table.require(names.distortions[side]);
    if (names.mirrors[side].empty()) return camera;
    camera.lens = Lens::mei;
    camera.distortion.insert(camera.distortion.begin(), table.require_number(names.mirrors[side]));
    return camera;
  };
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  pair.stereo.left = camera_of(0);
  pair.stereo.right = camera_of(1);
  if (names.pose.empty()) {
    const auto rotation = rotation_of(table, names.rotation, pair.notes);
    const auto& t = table.require(names.translation, 3);
    set_pose(pair.stereo, scaled({rotation, {t[0], t[1], t[2]}}, metres_per_unit(names, t, pair.notes)));
  } else {
    set_pose(pair.stereo, pose_of(table, names.pose, pair.notes));
  }
  return calibration_from_raw(std::move(pair), request, table.source);
}

/// Q of rectified images, as stereoRectify gives it: 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 -1/Tx (cx - cx')/Tx.
Calibration read_reprojection(const NumberTable& table, const OpenCvNames& names) {
  constexpr double kZero = 1e-9;
  const auto& q = table.require(names.reprojection, 16);
  const auto is_zero = [&](std::size_t i) { return std::abs(q[i]) <= kZero; };
  const bool has_zeros = is_zero(1) && is_zero(2) && is_zero(4) && is_zero(6) && is_zero(8) && is_zero(9) &&
                         is_zero(10) && is_zero(12) && is_zero(13);
  if (!has_zeros || q[0] != 1.0 || q[5] != 1.0 || is_zero(14))
    throw InputError(table.source, names.reprojection,
                     "is not of the form 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 1/baseline c, as stereoRectify gives it");
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = camera.fy_px = q[11];
  camera.cx_px = -q[3];
  camera.cy_px = -q[7];
  camera.cx_right_px = camera.cx_px + q[15] / q[14];
  camera.baseline_m = 1.0 / q[14];
  const auto [width_px, height_px] = size_of(table, names);
  camera.width_px = width_px;
  camera.height_px = height_px;
  calibration.left_name = calibration.right_name = names.reprojection;
  calibration.notes.push_back(
      {"the images are taken as rectified: the camera is that of " + names.reprojection, CalibrationNoteKind::told});
  return calibration;
}

Calibration read_opencv(const NumberTable& file, const CalibrationRequest& request) {
  NumberTable table = file;
  const bool has_second_file = !request.right_path.empty();
  if (has_second_file) {
    const auto second = read_number_table(request.right_path);
    table.entries.insert(second.entries.begin(), second.entries.end());
    table.source += " with " + request.right_path;
  }
  table = without_common_prefix(table);
  const OpenCvNames names = opencv_names(table);
  if (!names.reprojection.empty()) return read_reprojection(table, names);
  const bool has_rectified = names.has_projections;
  const bool has_raw = names.has_matrices && names.has_pose;
  if (names.has_matrices && !has_raw && !has_rectified && !has_second_file && !table.has(names.rotation))
    throw InputError(table.source, names.rotation,
                     "is missing, so the pose of the cameras is not known: if that is in a file of its own "
                     "(extrinsics.yml), give it too with --right-calib FILE");
  // Intrinsics given as a file of their own say that the images are raw; beside P1 and P2 they are just the record of
  // the calibration.
  if (request.images_are_raw || !has_rectified || (has_raw && has_second_file)) return read_raw(table, names, request);

  // Karlsruhe's sequences of 2010 have rows for the images as they were cropped, beside those of the whole ones.
  const bool is_cropped = table.has("P1_roi") && table.has("P2_roi");
  auto calibration = is_cropped
                         ? calibration_from_projections({table, "P1_roi"}, {table, "P2_roi"})
                         : calibration_from_projections({table, names.projections[0]}, {table, names.projections[1]});
  const auto [width_px, height_px] = is_cropped ? size_of_crop(table) : size_of(table, names);
  calibration.camera.width_px = width_px;
  calibration.camera.height_px = height_px;
  if (has_raw)
    calibration.notes.push_back(
        {"the images are taken as rectified because the file holds P1 and P2; M1, D1, M2, D2, R and T are ignored "
         "(give --raw if the images are as the cameras gave them)",
         CalibrationNoteKind::told});
  else if (table.has("R1") && table.has("R2"))
    calibration.notes.push_back(
        {"the file holds the extrinsics of raw cameras without their intrinsics, so the images are taken as rectified. "
         "If they are not, give the file of the intrinsics too (--right-calib)",
         CalibrationNoteKind::told});
  return calibration;
}

}  // namespace

const CalibrationFormat kOpenCvStereo{"OpenCV stereo", false, true,
                                      [](const NumberTable& table) {
                                        const auto names = opencv_names(without_common_prefix(table));
                                        return names.has_matrices || names.has_projections ||
                                               !names.reprojection.empty();
                                      },
                                      read_opencv};

}  // namespace flies::detail
