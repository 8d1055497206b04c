// Settings of stella_vslam and OpenVSLAM: https://stella-cv.readthedocs.io/en/latest/parameters.html
#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

RawCamera read_raw_camera(const NumberTable& table, const std::string& side, Lens lens) {
  return {matrix_of(table, "StereoRectifier.K_" + side), table.require("StereoRectifier.D_" + side), lens};
}

/// The camera of the rectified images stands in `Camera`; of raw ones `StereoRectifier` says how they come to be.
Calibration read_stella(const NumberTable& table, const CalibrationRequest& request) {
  const auto number = [&](const char* name) { return table.require_number(std::string("Camera.") + name); };
  const double fx_px = number("fx");
  if (fx_px == 0.0) throw InputError(table.source, "Camera.fx", "found 0, expected a focal length");
  const double baseline_m = number("focal_x_baseline") / fx_px;
  const ImageSize own{table.require_size("Camera.cols"), table.require_size("Camera.rows")};
  if (!table.has("StereoRectifier.K_left")) {
    Calibration calibration;
    calibration.camera = {.fx_px = fx_px,
                          .fy_px = number("fy"),
                          .cx_px = number("cx"),
                          .cx_right_px = number("cx"),
                          .cy_px = number("cy"),
                          .baseline_m = baseline_m,
                          .width_px = own.width_px,
                          .height_px = own.height_px,
                          .mount = {}};
    calibration.left_name = calibration.right_name = "Camera.fx";
    return calibration;
  }
  const std::string model_key = "StereoRectifier.model";
  const Lens lens = lens_of(table.word(model_key), model_key, table.source);
  RawPair pair{{}, "StereoRectifier.K_left", "StereoRectifier.K_right", "StereoRectifier.R_right"};
  const auto view = [&](const std::string& side, double shift_px) {
    return RectifiedView{read_raw_camera(table, side, lens),
                         rotation_of(table, "StereoRectifier.R_" + side, pair.notes),
                         {fx_px, 0, 0, shift_px, 0, fx_px, 0, 0, 0, 0, 1, 0}};
  };
  const RectifiedView left = view("left", 0.0), right = view("right", -fx_px * baseline_m);
  pair.stereo.left = left.camera;
  pair.stereo.right = right.camera;
  set_pose(pair.stereo, pose_of_views(left, right));
  pair.stereo.width_px = own.width_px;
  pair.stereo.height_px = own.height_px;
  return calibration_from_raw(std::move(pair), request, table.source);
}

}  // namespace

const CalibrationFormat kStellaVslam{"stella_vslam settings", false, false,
                                     [](const NumberTable& table) { return table.has("Camera.focal_x_baseline"); },
                                     read_stella};

}  // namespace flies::detail
