// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

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
  return {request.width_px, request.height_px};
}

Calibration read_raw(const NumberTable& table, const CalibrationRequest& request) {
  const auto [width_px, height_px] = size_of(table, request);
  const RawStereo raw{width_px,
                      height_px,
                      array_of<9>(table, key_of(table, kLeftIntrinsics)),
                      array_of<9>(table, key_of(table, kRightIntrinsics)),
                      distortion_of(table, key_of(table, kLeftDistortion)),
                      distortion_of(table, key_of(table, kRightDistortion)),
                      array_of<9>(table, "R"),
                      array_of<3>(table, "T")};
  if (width_px == 0 || height_px == 0)
    throw InputError(table.source, "image_width, image_height",
                     "are missing, and rectifying needs the size of the images");
  for (const auto& [intrinsics, names] :
       {std::pair{&raw.left_intrinsics, kLeftIntrinsics}, std::pair{&raw.right_intrinsics, kRightIntrinsics}})
    if (!((*intrinsics)[0] > 0.0) || !((*intrinsics)[4] > 0.0))
      throw InputError(table.source, key_of(table, names),
                       fmt::format("found focal lengths {:.6g} and {:.6g}, expected positive ones", (*intrinsics)[0],
                                   (*intrinsics)[4]));
  Calibration calibration;
  calibration.rectifier.emplace(raw, table.source);
  calibration.camera = calibration.rectifier->camera();
  calibration.left_name = key_of(table, kLeftIntrinsics);
  calibration.right_name = key_of(table, kRightIntrinsics);
  calibration.notes.push_back("the images are rectified first (M1 D1 M2 D2 R T)");
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

  auto calibration = calibration_from_projections({table, "P1"}, {table, "P2"});
  const auto [width_px, height_px] = size_of(table, {});
  calibration.camera.width_px = width_px;
  calibration.camera.height_px = height_px;
  if (has_raw)
    calibration.notes.push_back(
        "the images are taken as rectified because the file holds P1 and P2; M1, D1, M2, D2, R "
        "and T are ignored");
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
