// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

/// The same matrix goes by several names in the wild; the first is that of OpenCV's own sample.
using Names = std::initializer_list<const char*>;
const Names kLeftIntrinsics = {"M1", "K1", "cameraMatrix1", "camera_matrix_1"};
const Names kRightIntrinsics = {"M2", "K2", "cameraMatrix2", "camera_matrix_2"};
const Names kLeftDistortion = {"D1", "distCoeffs1", "dist_coeffs_1"};
const Names kRightDistortion = {"D2", "distCoeffs2", "dist_coeffs_2"};

std::string key_of(const NumberTable& table, Names names) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const char* name) { return table.has(name); });
  return found != names.end() ? *found : *names.begin();
}

ImageSize size_of(const NumberTable& table) {
  for (const char* key : {"image_size", "imageSize", "size"})
    if (table.has(key)) return size_of_list(table, key);
  for (const auto& [width, height] :
       {std::pair{"image_width", "image_height"}, std::pair{"imageWidth", "imageHeight"}, std::pair{"width", "height"}})
    if (table.has(width) || table.has(height)) return {table.require_size(width), table.require_size(height)};
  return {};
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

Calibration read_raw(const NumberTable& table, const CalibrationRequest& request) {
  const auto size = known_size(size_of(table), request);
  const Lens lens = named_lens(table);
  const std::string left = key_of(table, kLeftIntrinsics), right = key_of(table, kRightIntrinsics);
  RawPair pair{{}, left, right, "R"};
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  pair.stereo.left = {matrix_of(table, left), table.require(key_of(table, kLeftDistortion)), lens};
  pair.stereo.right = {matrix_of(table, right), table.require(key_of(table, kRightDistortion)), lens};
  const auto& t = table.require("T", 3);
  set_pose(pair.stereo, {matrix_of(table, "R"), {t[0], t[1], t[2]}});
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
  const bool has_rectified = table.has("P1") || table.has("P2");
  const bool has_raw = table.has(key_of(table, kLeftIntrinsics)) && table.has("R") && table.has("T");
  // Intrinsics given as a file of their own say that the images are raw; beside P1 and P2 they are just the record of
  // the calibration.
  if (request.images_are_raw || !has_rectified || (has_raw && has_second_file)) return read_raw(table, request);

  // Karlsruhe's sequences of 2010 have rows for the images as they were cropped, beside those of the whole ones.
  const bool is_cropped = table.has("P1_roi") && table.has("P2_roi");
  auto calibration = is_cropped ? calibration_from_projections({table, "P1_roi"}, {table, "P2_roi"})
                                : calibration_from_projections({table, "P1"}, {table, "P2"});
  const auto [width_px, height_px] = is_cropped ? size_of_crop(table) : size_of(table);
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
                                        const auto has_any = [&](Names names) {
                                          return table.has(key_of(table, names));
                                        };
                                        return (table.has("P1") && !table.has("P0")) || table.has("P2") ||
                                               has_any(kLeftIntrinsics) || has_any(kRightIntrinsics);
                                      },
                                      read_opencv};

}  // namespace flies::detail
