#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace flies {

/// How a lens bends rays. Coefficients are those of OpenCV where OpenCV has the model.
enum class Lens {
  brown,          ///< radial and tangential: k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tx ty]]]]; 4, 5, 8, 12 or 14
  equidistant,    ///< Kannala and Brandt, OpenCV's fisheye: k1 k2 k3 k4
  double_sphere,  ///< Usenko et al. 2018: xi alpha
  unified,        ///< the enhanced unified model of Khomutenko et al. 2016: alpha beta
  mei,            ///< Mei and Rives 2007, "omni": xi k1 k2 p1 p2
  fov,            ///< Devernay and Faugeras 2001, one angle: w
};

/// How many coefficients the model has at least; `brown` and what `mei` has behind xi may lack all, which are then 0.
std::size_t least_coefficients(Lens lens);

/// The name of a model in the text of a note: "equidistant (fisheye)", ...
const char* lens_name(Lens lens);

/// A camera as it was calibrated, before its images are rectified.
struct RawCamera {
  std::array<double, 9> matrix{};  ///< fx 0 cx, 0 fy cy, 0 0 1: 3 x 3, row by row, pixels
  std::vector<double> distortion;  ///< as `lens` says
  Lens lens = Lens::brown;
};

/// Where a point in the camera's frame (x right, y down, z forward) appears; nothing when the model does not see it
/// or lacks coefficients.
/// `brown` takes 5 coefficients at most here: OpenCV projects the others.
std::optional<std::array<double, 2>> project(const RawCamera& camera, const std::array<double, 3>& point);

}  // namespace flies
