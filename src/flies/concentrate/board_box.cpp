#include "flies/concentrate/board_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flies {

ImageBox board_box(const UprightBoard& board, const Projection& projection, const RoadPlane& road) {
  constexpr double kLeastDepth_m = 1e-3;
  double left_px = std::numeric_limits<double>::max(), top_px = left_px, right_px = -left_px, bottom_px = -left_px;
  for (const double bearing_rad : {board.right_rad, board.left_rad}) {
    const double x_m = board.range_m * std::cos(bearing_rad), y_m = board.range_m * std::sin(bearing_rad);
    for (const double height_m : {0.0, board.height_m}) {
      Point3 corner{x_m, y_m, road.z_m(x_m, y_m) + height_m};
      if (const double depth_m = projection.depth_m(corner); depth_m < kLeastDepth_m)
        corner.x_m += 2.0 * (kLeastDepth_m - depth_m);  // the optical axis is within 45 degrees of x in both tilts
      const auto image = projection.project(corner);
      left_px = std::min(left_px, image.u_px);
      right_px = std::max(right_px, image.u_px);
      top_px = std::min(top_px, image.v_px);
      bottom_px = std::max(bottom_px, image.v_px);
    }
  }
  return {left_px, top_px, right_px - left_px, bottom_px - top_px};
}

}  // namespace flies
