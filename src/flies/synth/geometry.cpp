#include "flies/synth/geometry.hpp"

#include <array>
#include <cassert>
#include <numbers>

namespace flies::synth {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

Vec3 turned(const Vec3& p, float cos_yaw, float sin_yaw) {
  return {cos_yaw * p.x - sin_yaw * p.y, sin_yaw * p.x + cos_yaw * p.y, p.z};
}

/// Normals of a smooth surface: the mean of the neighbouring faces' normals weighted by their area.
void smooth_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3{});
  for (const auto& t : mesh.triangles) {
    const Vec3 normal = cross(mesh.positions[t.b] - mesh.positions[t.a], mesh.positions[t.c] - mesh.positions[t.a]);
    for (const auto i : {t.a, t.b, t.c}) mesh.normals[i] = mesh.normals[i] + normal;
  }
  for (auto& normal : mesh.normals) normal = normalized(normal);
}

float signed_power(float value, float exponent) { return std::copysign(std::pow(std::abs(value), exponent), value); }

}  // namespace

void Mesh::add(const Mesh& part) {
  const auto first_vertex = static_cast<std::uint32_t>(positions.size());
  const auto first_material = static_cast<std::uint32_t>(materials.size());
  positions.insert(positions.end(), part.positions.begin(), part.positions.end());
  normals.insert(normals.end(), part.normals.begin(), part.normals.end());
  texture.insert(texture.end(), part.texture.begin(), part.texture.end());
  materials.insert(materials.end(), part.materials.begin(), part.materials.end());
  for (const auto& t : part.triangles)
    triangles.push_back({t.a + first_vertex, t.b + first_vertex, t.c + first_vertex, t.material + first_material});
}

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const auto& p : mesh.positions) {
    bounds.low = min(bounds.low, p);
    bounds.high = max(bounds.high, p);
  }
  return bounds;
}

Mesh placed(Mesh mesh, const Placement& placement) {
  const float cos_yaw = std::cos(placement.yaw_rad), sin_yaw = std::sin(placement.yaw_rad);
  for (auto& p : mesh.positions) p = turned(p, cos_yaw, sin_yaw) + placement.position;
  for (auto& n : mesh.normals) n = turned(n, cos_yaw, sin_yaw);
  return mesh;
}

Vec3 placed_direction(const Vec3& direction, const Placement& placement) {
  return turned(direction, std::cos(placement.yaw_rad), std::sin(placement.yaw_rad));
}

Mesh quad(const Vec3& corner, const Vec3& edge_u, const Vec3& edge_v, const Material& material) {
  Mesh mesh;
  mesh.positions = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
  mesh.texture = mesh.positions;
  mesh.normals.assign(4, normalized(cross(edge_u, edge_v)));
  mesh.triangles = {{0, 1, 2, 0}, {0, 2, 3, 0}};
  mesh.materials = {material};
  return mesh;
}

Mesh box(const Vec3& low, const Vec3& high, const Material& material) {
  const Vec3 size = high - low;
  const Vec3 x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
  Mesh mesh = quad(low, z, y, material);
  for (const auto& face : {quad(low, x, z, material), quad(low, y, x, material), quad(low + x, y, z, material),
                           quad(low + y, z, x, material), quad(low + z, x, y, material)})
    mesh.add(face);
  mesh.materials.resize(1);
  for (auto& t : mesh.triangles) t.material = 0;
  return mesh;
}

Mesh loft(std::span<const Ring> rings, const Material& material, int segments, float squareness) {
  assert(rings.size() >= 2 && segments >= 3);
  Mesh mesh;
  mesh.materials = {material};
  const float exponent = 2.0F / squareness;
  float path_m = 0.0F;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const Ring& ring = rings[r];
    if (r > 0) path_m += length(ring.centre - rings[r - 1].centre);
    const float side_m = length(ring.half_u), depth_m = length(ring.half_v);
    for (int s = 0; s < segments; ++s) {
      const float angle = 2.0F * kPi * static_cast<float>(s) / static_cast<float>(segments);
      const float u = signed_power(std::cos(angle), exponent), v = signed_power(std::sin(angle), exponent);
      mesh.positions.push_back(ring.centre + ring.half_u * u + ring.half_v * v);
      mesh.texture.push_back({u * side_m, v * depth_m, path_m});
    }
  }
  const auto count = static_cast<std::uint32_t>(segments);
  for (std::uint32_t r = 0; r + 1 < rings.size(); ++r) {
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t next = (s + 1) % count;
      const std::uint32_t a = r * count + s, b = r * count + next, c = a + count, d = b + count;
      mesh.triangles.push_back({a, b, d, 0});
      mesh.triangles.push_back({a, d, c, 0});
    }
  }
  smooth_normals(mesh);

  // The caps have vertices of their own so that their edge stays sharp.
  for (const bool at_end : {false, true}) {
    const Ring& ring = at_end ? rings.back() : rings.front();
    const auto outward = normalized(cross(ring.half_u, ring.half_v)) * (at_end ? 1.0F : -1.0F);
    const auto ring_start = at_end ? static_cast<std::uint32_t>(rings.size() - 1) * count : 0U;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(ring.centre);
    mesh.texture.push_back({0.0F, 0.0F, at_end ? path_m : 0.0F});
    for (std::uint32_t s = 0; s < count; ++s) {
      mesh.positions.push_back(mesh.positions[ring_start + s]);
      mesh.texture.push_back(mesh.texture[ring_start + s]);
    }
    mesh.normals.resize(mesh.positions.size(), outward);
    for (std::uint32_t s = 0; s < count; ++s) {
      const std::uint32_t here = first + 1 + s, next = first + 1 + (s + 1) % count;
      mesh.triangles.push_back(at_end ? Mesh::Triangle{first, here, next, 0} : Mesh::Triangle{first, next, here, 0});
    }
  }
  return mesh;
}

Mesh ellipsoid(const Vec3& centre, const Vec3& half, const Material& material, int segments) {
  std::vector<Ring> rings;
  const int steps = std::max(4, segments / 2);
  for (int i = 0; i <= steps; ++i) {
    const float polar = kPi * static_cast<float>(i) / static_cast<float>(steps);
    // A pole of almost no size keeps the normals defined.
    const float radius = std::max(1e-3F, std::sin(polar));
    rings.push_back({centre - Vec3{0, 0, half.z * std::cos(polar)}, {half.x * radius, 0, 0}, {0, half.y * radius, 0}});
  }
  Mesh mesh = loft(rings, material, segments);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.texture[i] = mesh.positions[i] - centre;
  return mesh;
}

Mesh limb(std::span<const LimbPoint> points, const Vec3& side, const Material& material, int segments) {
  std::vector<Ring> rings;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& before = points[i == 0 ? 0 : i - 1].position;
    const Vec3& after = points[std::min(i + 1, points.size() - 1)].position;
    const Vec3 along = normalized(after - before);
    const Vec3 across = normalized(side - along * dot(side, along));
    rings.push_back({points[i].position, across * points[i].side_m, cross(along, across) * points[i].depth_m});
  }
  return loft(rings, material, segments);
}

Mesh cylinder(const Vec3& from, const Vec3& to, float radius_m, const Material& material, int segments) {
  const Vec3 along = normalized(to - from);
  const Vec3 side = std::abs(along.x) < 0.9F ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const std::array points = {LimbPoint{from, radius_m, radius_m}, LimbPoint{to, radius_m, radius_m}};
  return limb(points, side, material, segments);
}

}  // namespace flies::synth
