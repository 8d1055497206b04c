#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "flies/synth/material.hpp"
#include "flies/synth/vec3.hpp"

namespace flies::synth {

/// A triangle mesh with smooth normals, texture coordinates in metres that move with the object, and its materials.
struct Mesh {
  struct Triangle {
    std::uint32_t a, b, c;  ///< indices into the vertex arrays
    std::uint32_t material;
  };
  std::vector<Vec3> positions, normals, texture;  ///< one entry per vertex in each
  std::vector<Triangle> triangles;
  std::vector<Material> materials;

  /// Joins another mesh to this one.
  void add(const Mesh& part);
};

/// Two opposite corners of an axis-aligned box.
struct Bounds {
  Vec3 low{1e30F, 1e30F, 1e30F};
  Vec3 high{-1e30F, -1e30F, -1e30F};
};
Bounds bounds_of(const Mesh& mesh);

/// Where an object stands: turned by `yaw_rad` about z (positive to the left), then moved.
struct Placement {
  Vec3 position;
  float yaw_rad = 0.0F;
};
/// The mesh at its place; texture coordinates stay as they are.
Mesh placed(Mesh mesh, const Placement& placement);
/// A direction turned as the placement turns.
Vec3 placed_direction(const Vec3& direction, const Placement& placement);

/// Axis-aligned box with flat faces.
Mesh box(const Vec3& low, const Vec3& high, const Material& material);

/// Flat parallelogram with the normal cross(edge_u, edge_v).
Mesh quad(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, const Material& material);

/// Ellipsoid with its half axes along x, y and z.
Mesh ellipsoid(const Vec3& centre, const Vec3& half, const Material& material, int segments = 16);

/// One cross-section of a loft: the closed curve centre + half_u * cos + half_v * sin.
struct Ring {
  Vec3 centre, half_u, half_v;
};
/// Skin over two or more rings, closed at both ends. With `squareness` above 2 the ellipses turn into rounded
/// rectangles (superellipses of that exponent). Rings must run so that cross(half_u, half_v) points along the path.
Mesh loft(std::span<const Ring> rings, const Material& material, int segments = 16, float squareness = 2.0F);

/// One point of a limb: half widths across the body (`side`) and across it front to back (`depth`).
struct LimbPoint {
  Vec3 position;
  float side_m, depth_m;
};
/// Loft along a path whose cross-sections stand square on the path; `side` is the direction of `side_m`.
Mesh limb(std::span<const LimbPoint> points, const Vec3& side, const Material& material, int segments = 14);

/// Upright or tilted cylinder between two points.
Mesh cylinder(const Vec3& from, const Vec3& to, float radius_m, const Material& material, int segments = 16);

}  // namespace flies::synth
