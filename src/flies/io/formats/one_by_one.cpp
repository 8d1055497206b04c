// Rectified cameras of a handful of numbers: what stereo networks and small tools take.
#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

StereoCamera camera_of(double fx_px, double fy_px, double cx_px, double cy_px, double baseline_m) {
  StereoCamera camera;
  camera.fx_px = fx_px;
  camera.fy_px = fy_px;
  camera.cx_px = camera.cx_right_px = cx_px;
  camera.cy_px = cy_px;
  camera.baseline_m = baseline_m;
  return camera;
}

/// FoundationStereo: the camera matrix and, in the next row, the baseline in metres.
Calibration read_k_txt(const NumberTable& table, const CalibrationRequest& request) {
  constexpr std::size_t kCount = 10;
  auto k = table.require(kBareNumbers);
  if (k.size() == kCount - 1) k.push_back(missing_baseline(request, table.source, "baseline in the second row"));
  if (k.size() != kCount) table.require(kBareNumbers, kCount);
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    throw InputError(table.source, kBareNumbers, "are not fx 0 cx 0 fy cy 0 0 1 and a baseline");
  Calibration calibration;
  calibration.camera = camera_of(k[0], k[4], k[2], k[5], k[9]);
  calibration.left_name = calibration.right_name = "K";
  return calibration;
}

/// stereodemo's JSON.
Calibration read_stereodemo(const NumberTable& table, const CalibrationRequest&) {
  const auto number = [&](const char* key) { return table.require_number(key); };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera = camera_of(number("fx"), number("fy"), number("cx0"), number("cy"), number("baseline_meters"));
  camera.cx_right_px = number("cx1");
  if (table.has("width") || table.has("height")) {
    camera.width_px = table.require_size("width");
    camera.height_px = table.require_size("height");
  }
  calibration.left_name = "cx0";
  calibration.right_name = "cx1";
  return calibration;
}

/// Settings of stixel programs in OpenCV's XML or YAML: metres and radians, the tilt positive when it looks down.
Calibration read_stixel(const NumberTable& table, const CalibrationRequest&) {
  const auto number = [&](const char* key) { return table.require_number(key); };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera = camera_of(number("FocalLengthX"), number("FocalLengthY"), number("CenterX"), number("CenterY"),
                     number("BaseLine"));
  calibration.has_height = table.has("Height");
  calibration.has_pitch = table.has("Tilt");
  if (calibration.has_height) camera.mount.height_m = number("Height");
  if (calibration.has_pitch) camera.mount.pitch_rad = number("Tilt");
  calibration.left_name = calibration.right_name = "FocalLengthX";
  return calibration;
}

/// The camera of a Cityscapes picture: rectified, with its place on the car: metres and radians, the pitch positive
/// when it looks down.
Calibration read_cityscapes(const NumberTable& table, const CalibrationRequest&) {
  const auto number = [&](const char* key) { return table.require_number(key); };
  Calibration calibration;
  auto& camera = calibration.camera;
  camera = camera_of(number("intrinsic.fx"), number("intrinsic.fy"), number("intrinsic.u0"), number("intrinsic.v0"),
                     number("extrinsic.baseline"));
  calibration.has_height = table.has("extrinsic.z");
  calibration.has_pitch = table.has("extrinsic.pitch");
  if (calibration.has_height) camera.mount.height_m = number("extrinsic.z");
  if (calibration.has_pitch) camera.mount.pitch_rad = number("extrinsic.pitch");
  calibration.left_name = calibration.right_name = "intrinsic";
  return calibration;
}

}  // namespace

const CalibrationFormat kCityscapes{
    "Cityscapes camera.json", false, false,
    [](const NumberTable& table) { return table.has("extrinsic.baseline") && table.has("intrinsic.u0"); },
    read_cityscapes};

const CalibrationFormat kCameraMatrixText{"FoundationStereo K.txt", false, false,
                                          [](const NumberTable& table) { return table.has(kBareNumbers); }, read_k_txt};

const CalibrationFormat kStereodemo{
    "stereodemo calibration", false, false,
    [](const NumberTable& table) { return table.has("baseline_meters") && (table.has("cx0") || table.has("cx1")); },
    read_stereodemo};

const CalibrationFormat kStixel{"stixel camera", false, false,
                                [](const NumberTable& table) { return table.has("FocalLengthX"); }, read_stixel};

}  // namespace flies::detail
