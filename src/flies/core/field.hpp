#pragma once

#include "flies/core/options.hpp"
#include "flies/core/road.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// The field of detection: a box over the road, in the vehicle frame. Heights are above the road plane.
struct FieldOptions {
  double x_min_m = 4.0;
  double x_max_m = 45.0;
  double y_min_m = -20.0;
  double y_max_m = 20.0;
  double z_min_m = 0.2;
  double z_max_m = 2.4;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("x_min_m", self.x_min_m, Range{0.1, 200}, "near end of the field: nearest distance ahead that is searched");
    field("x_max_m", self.x_max_m, Range{1, 500}, "far end of the field: farthest distance ahead that is searched");
    field("y_min_m", self.y_min_m, Range{-200, 200}, "right edge of the field (y points left)");
    field("y_max_m", self.y_max_m, Range{-200, 200}, "left edge of the field");
    field("z_min_m", self.z_min_m, Range{-5, 20}, "lowest point above the road; kerbs and markings stay below it");
    field("z_max_m", self.z_max_m, Range{-5, 20}, "highest point above the road");
  }
};

/// True when the point lies in the field over this road; false for a point that is not finite.
inline bool in_field(const FieldOptions& field, const RoadPlane& road, const Point3& p) {
  const double height_m = p.z_m - road.z_m(p.x_m, p.y_m);
  return p.x_m >= field.x_min_m && p.x_m <= field.x_max_m && p.y_m >= field.y_min_m && p.y_m <= field.y_max_m &&
         height_m >= field.z_min_m && height_m <= field.z_max_m;
}

/// @throws InputError naming `source` and the bound out of range or the interval that is empty
void check_field(const FieldOptions& field, const std::string& source);

}  // namespace flies
