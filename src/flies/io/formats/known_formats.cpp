// All formats of calibrations that are read.
#include <fmt/format.h>

#include <array>
#include <string>

#include "flies/core/error.hpp"
#include "flies/io/calibration_formats.hpp"

namespace flies::detail {
namespace {

/// In order of recognition: the particular before the general.
const std::array kFormats = {
    &kPlainYaml, &kMiddlebury,    &kKittiRaw,     &kKittiObject, &kKalibr,          &kKittiOdometry, &kStellaVslam,
    &kOv2Slam,   &kOkvis,         &kMaplab,       &kKimera,      &kOrbSlam,         &kEuroc,         &kZed,
    &kRealSense, &kDepthAi,       &kBasalt,       &kMatlab,      &kStereodemo,      &kStixel,        &kCityscapes,
    &kVins,      &kRosCameraInfo, &kDsec,         &kBouguet,     &kArgoverse,       &kOpenCvStereo,  &kCameraMatrixText,
    &kMrpt,      &kTwoCameras,    &kVirtualKitti, &kFlat,        &kOpenCvExtrinsics};

}  // namespace

const CalibrationFormat& recognised_format(const NumberTable& table) {
  for (const auto* format : kFormats)
    if (format->matches(table)) return *format;
  std::string known;
  for (const auto* format : kFormats) known += (known.empty() ? "" : ", ") + std::string(format->name);
  throw InputError(
      table.source, "format",
      fmt::format("not recognised, expected one of: {}; for rectified images, seven lines of YAML are enough: fx: 700, "
                  "fy: 700, cx: 320, cy: 240, baseline: 0.12 (metres), width: 640, height: 480",
                  known));
}

}  // namespace flies::detail
