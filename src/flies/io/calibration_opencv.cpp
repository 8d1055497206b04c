// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"
#include "flies/io/plausible.hpp"

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

template <std::size_t Size>
std::array<double, Size> array_of(const NumberTable& table, const std::string& key) {
  std::array<double, Size> values{};
  std::copy_n(table.require(key, Size).begin(), Size, values.begin());
  return values;
}

std::vector<double> distortion_of(const NumberTable& table, const std::string& key) {
  const auto& numbers = table.require(key);
  constexpr std::array<std::size_t, 5> kCounts = {4, 5, 8, 12, 14};
  if (std::find(kCounts.begin(), kCounts.end(), numbers.size()) == kCounts.end())
    throw InputError(table.source, key, fmt::format("found {} numbers, expected 4, 5, 8, 12 or 14", numbers.size()));
  return numbers;
}

struct ImageSize {
  int width_px = 0, height_px = 0;
};

ImageSize size_of(const NumberTable& table, const CalibrationRequest& request) {
  for (const char* key : {"image_size", "imageSize", "size"})
    if (table.has(key)) {
      const auto& size = table.require(key, 2);
      const NumberTable each{table.source, {{key, {{size[0]}, ""}}}}, other{table.source, {{key, {{size[1]}, ""}}}};
      return {each.require_size(key), other.require_size(key)};
    }
  for (const auto& [width, height] :
       {std::pair{"image_width", "image_height"}, std::pair{"imageWidth", "imageHeight"}, std::pair{"width", "height"}})
    if (table.has(width) || table.has(height)) return {table.require_size(width), table.require_size(height)};
  if (request.calibrated_width_px > 0) return {request.calibrated_width_px, request.calibrated_height_px};
  return {request.width_px, request.height_px};
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

/// The model of the lens that the file names, if any: "equidistant", "fisheye", "plumb_bob", ...
std::string named_model(const NumberTable& table) {
  std::string name;
  for (const char* key : {"distortion_model", "camera_model", "model", "lens_model"}) {
    const auto found = table.entries.find(key);
    if (found == table.entries.end() || found->second.not_a_number == "pinhole") continue;  // says nothing of the lens
    if (name.empty()) name = found->second.not_a_number;
  }
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

/// @returns whether the model is OpenCV's fisheye one. @throws InputError when it is neither that nor the pinhole one
bool is_fisheye(const NumberTable& table) {
  const std::string model = named_model(table);
  const auto is_one_of = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), model) != names.end();
  };
  if (is_one_of({"equidistant", "fisheye", "kannala_brandt", "kannalabrandt", "kannala-brandt", "kannalabrandt8"}))
    return true;
  if (is_one_of({"", "plumb_bob", "radtan", "radial-tangential", "rational_polynomial", "brown", "perspective",
                 "brown_conrady", "none"}))
    return false;
  throw InputError(
      table.source, "distortion_model",
      fmt::format("found '{}', expected plumb_bob, radtan, rational_polynomial, equidistant or fisheye", model));
}

/// The camera matrix of images that were resized.
std::array<double, 9> scaled(std::array<double, 9> m, double scale) {
  m[0] *= scale;
  m[1] *= scale;
  m[4] *= scale;
  m[2] = scaled_centre_px(m[2], scale);
  m[5] = scaled_centre_px(m[5], scale);
  return m;
}

void check_raw(const RawStereo& raw, const NumberTable& table) {
  check_camera_matrix(raw.left_intrinsics, table.source, key_of(table, kLeftIntrinsics));
  check_camera_matrix(raw.right_intrinsics, table.source, key_of(table, kRightIntrinsics));
  check_rotation(raw.rotation, table.source, "R");
  constexpr std::size_t kFisheyeCoefficients = 4;
  for (const auto& [distortion, names] :
       {std::pair{&raw.left_distortion, kLeftDistortion}, std::pair{&raw.right_distortion, kRightDistortion}})
    if (raw.is_fisheye && distortion->size() != kFisheyeCoefficients)
      throw InputError(
          table.source, key_of(table, names),
          fmt::format("found {} numbers, expected the 4 of the fisheye model that the file names", distortion->size()));
}

Calibration read_raw(const NumberTable& table, const CalibrationRequest& request) {
  const auto [width_px, height_px] = size_of(table, request);
  RawStereo raw{width_px,
                height_px,
                array_of<9>(table, key_of(table, kLeftIntrinsics)),
                array_of<9>(table, key_of(table, kRightIntrinsics)),
                distortion_of(table, key_of(table, kLeftDistortion)),
                distortion_of(table, key_of(table, kRightDistortion)),
                array_of<9>(table, "R"),
                is_fisheye(table),
                array_of<3>(table, "T")};
  if (width_px == 0 || height_px == 0)
    throw InputError(table.source, "image_width, image_height",
                     "are missing, and rectifying needs the size of the images");
  check_raw(raw, table);
  Calibration calibration;
  const auto scale = one_scale(width_px, height_px, request.width_px, request.height_px);
  if (scale && (width_px != request.width_px || height_px != request.height_px)) {
    calibration.notes.push_back(
        fmt::format("the calibration is for {} x {} px, scaled by {:.4g} to the images of {} x "
                    "{} px",
                    width_px, height_px, *scale, request.width_px, request.height_px));
    raw.left_intrinsics = scaled(raw.left_intrinsics, *scale);
    raw.right_intrinsics = scaled(raw.right_intrinsics, *scale);
    raw.width_px = request.width_px;
    raw.height_px = request.height_px;
  }
  calibration.rectifier.emplace(raw, table.source);
  calibration.camera = calibration.rectifier->camera();
  calibration.left_name = key_of(table, kLeftIntrinsics);
  calibration.right_name = key_of(table, kRightIntrinsics);
  calibration.notes.push_back(fmt::format("the images are rectified first{} (M1 D1 M2 D2 R T)",
                                          raw.is_fisheye ? ", with the fisheye model that the file names" : ""));
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
  const bool has_rectified = table.has("P1") || table.has("P2");
  const bool has_raw = table.has(key_of(table, kLeftIntrinsics)) && table.has("R") && table.has("T");
  // Intrinsics given as a file of their own say that the images are raw; beside P1 and P2 they are just the record of
  // the calibration.
  if (has_raw && (has_second_file || !has_rectified)) return read_raw(table, request);
  if (!has_rectified) return read_raw(table, request);

  // Karlsruhe's sequences of 2010 have rows for the images as they were cropped, beside those of the whole ones.
  const bool is_cropped = table.has("P1_roi") && table.has("P2_roi");
  auto calibration = is_cropped ? calibration_from_projections({table, "P1_roi"}, {table, "P2_roi"})
                                : calibration_from_projections({table, "P1"}, {table, "P2"});
  const auto [width_px, height_px] = is_cropped ? size_of_crop(table) : size_of(table, {});
  calibration.camera.width_px = width_px;
  calibration.camera.height_px = height_px;
  if (has_raw)
    calibration.notes.push_back(
        "the images are taken as rectified because the file holds P1 and P2; M1, D1, M2, D2, R "
        "and T are ignored");
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
