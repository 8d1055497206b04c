#include "flies/io/lens.hpp"

#include <cmath>

namespace flies {
namespace {

using Plane = std::array<double, 2>;

/// What lies this near to the plane of the pinhole is not seen.
constexpr double kLeastDepth = 1e-6;

/// @param d k1 k2 p1 p2 k3, missing ones 0
Plane bent(const Plane& at, const double* d, std::size_t count) {
  const double x = at[0], y = at[1], r2 = x * x + y * y;
  const double k1 = count > 0 ? d[0] : 0.0, k2 = count > 1 ? d[1] : 0.0, k3 = count > 4 ? d[4] : 0.0;
  const double p1 = count > 3 ? d[2] : 0.0, p2 = count > 3 ? d[3] : 0.0;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

/// A direction at this angle from the axis goes to this radius.
Plane at_radius(double x, double y, double radius) {
  const double r = std::hypot(x, y);
  return r > 0.0 ? Plane{x * radius / r, y * radius / r} : Plane{0.0, 0.0};
}

/// The double sphere model, equations 40 to 45.
std::optional<Plane> double_sphere(double x, double y, double z, double xi, double alpha) {
  const double d1 = std::sqrt(x * x + y * y + z * z);
  const double w1 = alpha <= 0.5 ? alpha / (1.0 - alpha) : (1.0 - alpha) / alpha;
  const double w2 = (w1 + xi) / std::sqrt(2.0 * w1 * xi + xi * xi + 1.0);
  if (z <= -w2 * d1) return std::nullopt;
  const double d2 = std::sqrt(x * x + y * y + (xi * d1 + z) * (xi * d1 + z));
  const double depth = alpha * d2 + (1.0 - alpha) * (xi * d1 + z);
  if (depth <= kLeastDepth * d1) return std::nullopt;
  return Plane{x / depth, y / depth};
}

std::optional<Plane> unified(double x, double y, double z, double alpha, double beta) {
  const double d = std::sqrt(beta * (x * x + y * y) + z * z);
  const double w = alpha <= 0.5 ? alpha / (1.0 - alpha) : (1.0 - alpha) / alpha;
  const double depth = alpha * d + (1.0 - alpha) * z;
  if (z <= -w * d || depth <= kLeastDepth * d) return std::nullopt;
  return Plane{x / depth, y / depth};
}

std::optional<Plane> on_plane(const RawCamera& camera, double x, double y, double z) {
  const auto& d = camera.distortion;
  switch (camera.lens) {
    case Lens::double_sphere:
      return double_sphere(x, y, z, d[0], d[1]);
    case Lens::unified:
      return unified(x, y, z, d[0], d[1]);
    case Lens::mei: {
      const double depth = z + d[0] * std::sqrt(x * x + y * y + z * z);
      if (depth <= kLeastDepth) return std::nullopt;
      return bent({x / depth, y / depth}, d.data() + 1, d.size() - 1);
    }
    case Lens::equidistant: {
      const double t = std::atan2(std::hypot(x, y), z), t2 = t * t;
      return at_radius(x, y, t * (1.0 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3])))));
    }
    case Lens::fov: {
      if (z <= kLeastDepth) return std::nullopt;
      const double r = std::hypot(x, y) / z, w = d[0];
      return at_radius(x, y, w > kLeastDepth ? std::atan(2.0 * r * std::tan(0.5 * w)) / w : r);
    }
    case Lens::brown:
      break;
  }
  if (z <= kLeastDepth) return std::nullopt;
  return bent({x / z, y / z}, d.data(), d.size());
}

}  // namespace

std::size_t least_coefficients(Lens lens) {
  switch (lens) {
    case Lens::equidistant:
      return 4;
    case Lens::double_sphere:
    case Lens::unified:
      return 2;
    case Lens::mei:
    case Lens::fov:
      return 1;
    case Lens::brown:
      break;
  }
  return 0;
}

const char* lens_name(Lens lens) {
  switch (lens) {
    case Lens::equidistant:
      return "equidistant (fisheye)";
    case Lens::double_sphere:
      return "double sphere";
    case Lens::unified:
      return "unified";
    case Lens::mei:
      return "omnidirectional (Mei)";
    case Lens::fov:
      return "field-of-view";
    case Lens::brown:
      break;
  }
  return "radial and tangential";
}

std::optional<std::array<double, 2>> project(const RawCamera& camera, const std::array<double, 3>& point) {
  if (camera.distortion.size() < least_coefficients(camera.lens)) return std::nullopt;
  const auto at = on_plane(camera, point[0], point[1], point[2]);
  if (!at) return std::nullopt;
  const auto& m = camera.matrix;
  return std::array{m[0] * (*at)[0] + m[1] * (*at)[1] + m[2], m[4] * (*at)[1] + m[5]};
}

}  // namespace flies
