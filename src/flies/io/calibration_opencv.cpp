// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

ImageSize size_of(const NumberTable& table, const OpenCvNames& names) {
  if (!names.size.empty()) return size_of_list(table, names.size);
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

/// The model of the lens that the file names, if any.
Lens named_lens(const NumberTable& table) {
  for (const char* key : {"distortion_model", "camera_model", "model", "lens_model"})
    if (const std::string word = table.word(key); !word.empty() && word != "pinhole")  // which says nothing of the lens
      return lens_of(word, key, table.source);
  return Lens::brown;
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
          fmt::format("found {} numbers: are they coefficients of distortion? expected them as D1 and D2", count));
  }
}

Calibration read_raw(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  const auto size = known_size(size_of(table, names), request, table.source);
  RawPair pair{{}, names.matrices[0], names.matrices[1], names.pose.empty() ? names.rotation : names.pose};
  // OpenCV's own names stand in for those that are not there.
  const bool is_undistorted = !table.has(names.distortions[0]) && !table.has(names.distortions[1]);
  if (is_undistorted) {
    check_no_distortion(table);
    pair.notes.push_back("the file has no coefficients of distortion: the lenses are taken as free of it");
  }
  const auto camera_of = [&](std::size_t side) {
    const Lens lens = names.are_fisheyes ? Lens::equidistant : named_lens(table);
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
    set_pose(pair.stereo, {rotation, {t[0], t[1], t[2]}});
  } else {
    set_pose(pair.stereo, pose_of(table, names.pose, pair.notes));
  }
  return calibration_from_raw(std::move(pair), request, table.source);
}

Calibration read_opencv(const NumberTable& file, const CalibrationRequest& request) {
  NumberTable table = file;
  const bool has_second_file = !request.right_path.empty();
  if (has_second_file) {
    const auto second = read_number_table(request.right_path);
    table.entries.insert(second.entries.begin(), second.entries.end());
    table.source += " with " + request.right_path;
  }
  const OpenCvNames names = opencv_names(table);
  const bool has_rectified = names.has_projections;
  const bool has_raw = names.has_matrices && names.has_pose;
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
        "the images are taken as rectified because the file holds P1 and P2; M1, D1, M2, D2, R "
        "and T are ignored (--raw: they are as the cameras gave them)");
  else if (table.has("R1") && table.has("R2"))
    calibration.notes.push_back(
        "the file holds the extrinsics of raw cameras without their intrinsics; the images are taken as rectified. If "
        "they are not, give the file of the intrinsics too (--right-calib)");
  return calibration;
}

}  // namespace

const CalibrationFormat kOpenCvStereo{"OpenCV stereo", false, true,
                                      [](const NumberTable& table) {
                                        const auto names = opencv_names(table);
                                        return names.has_matrices || names.has_projections;
                                      },
                                      read_opencv};

}  // namespace flies::detail
