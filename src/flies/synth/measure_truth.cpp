#include "flies/synth/measure_truth.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace flies::synth {
namespace {

/// Objects are cut off this close to the camera, where the projection has no meaning any more.
constexpr double kNearest_m = 0.2;

struct Extent {
  double u0 = std::numeric_limits<double>::infinity(), v0 = u0;
  double u1 = -u0, v1 = -u0;

  ImageBox box() const { return {u0, v0, std::max(0.0, u1 - u0), std::max(0.0, v1 - v0)}; }
};

/// Extent of the mesh in the left image; edges that reach behind the camera are cut at `kNearest_m`.
std::optional<Extent> project_mesh(const Mesh& mesh, const Projection& projection) {
  Extent extent;
  bool is_ahead = false;
  const auto include = [&](const Point3& p) {
    const StereoPoint image = projection.project(p);
    extent.u0 = std::min(extent.u0, image.u_px);
    extent.u1 = std::max(extent.u1, image.u_px);
    extent.v0 = std::min(extent.v0, image.v_px);
    extent.v1 = std::max(extent.v1, image.v_px);
    is_ahead = true;
  };
  const auto point = [&](std::uint32_t i) {
    const Vec3& p = mesh.positions[i];
    return Point3{p.x, p.y, p.z};
  };
  for (const auto& t : mesh.triangles) {
    const std::uint32_t corners[3] = {t.a, t.b, t.c};
    for (int k = 0; k < 3; ++k) {
      const Point3 p = point(corners[k]), q = point(corners[(k + 1) % 3]);
      const double depth_p = projection.depth_m(p), depth_q = projection.depth_m(q);
      if (depth_p >= kNearest_m) include(p);
      if ((depth_p >= kNearest_m) != (depth_q >= kNearest_m)) {
        // A hair inside, so that rounding does not put the point behind the limit again.
        const double s = (kNearest_m - depth_p) / (depth_q - depth_p);
        include({p.x_m + s * (q.x_m - p.x_m), p.y_m + s * (q.y_m - p.y_m), p.z_m + s * (q.z_m - p.z_m)});
      }
    }
  }
  if (!is_ahead) return std::nullopt;
  return extent;
}

/// Distance on the ground from the origin to a rectangle.
double footprint_range_m(const SceneObject& object) {
  const double c = std::cos(object.yaw_rad), s = std::sin(object.yaw_rad);
  const double along = -(c * object.x_m + s * object.y_m), across = -(-s * object.x_m + c * object.y_m);
  return std::hypot(std::max(0.0, std::abs(along) - 0.5 * object.length_m),
                    std::max(0.0, std::abs(across) - 0.5 * object.width_m));
}

/// Share of the object's silhouette inside the image that the pixel truth gives to other objects.
double hidden_share(const SceneObject& object, std::size_t index, const ImageBox& box, const PixelRays& rays,
                    const PixelTruth& pixels) {
  constexpr double kMaxRays = 6000.0;  // enough for an error well below 2 %
  const int step = std::max(1, static_cast<int>(std::sqrt(box.width_px * box.height_px / kMaxRays)));
  const SingleObject alone(object);
  std::size_t silhouette = 0, visible = 0;
  const int u_end = std::min(pixels.width_px, static_cast<int>(std::ceil(box.u_px + box.width_px)) + 1);
  const int v_end = std::min(pixels.height_px, static_cast<int>(std::ceil(box.v_px + box.height_px)) + 1);
  for (int v = std::max(0, static_cast<int>(box.v_px)); v < v_end; v += step) {
    for (int u = std::max(0, static_cast<int>(box.u_px)); u < u_end; u += step) {
      const bool is_seen = pixels.object[pixels.index(u, v)] == static_cast<int>(index);
      if (!is_seen && !alone.is_hit(rays.origin(), rays.direction(static_cast<float>(u), static_cast<float>(v))))
        continue;
      ++silhouette;
      if (is_seen) ++visible;
    }
  }
  return silhouette == 0 ? 0.0 : 1.0 - static_cast<double>(visible) / static_cast<double>(silhouette);
}

}  // namespace

PixelTruth measure_pixels(const RayScene& rays, const StereoCamera& camera, const SceneOptions& options) {
  PixelTruth truth;
  truth.width_px = camera.width_px;
  truth.height_px = camera.height_px;
  const auto count = static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px);
  truth.disparity_px.assign(count, std::numeric_limits<float>::quiet_NaN());
  truth.object.assign(count, -1);
  const PixelRays pixel_rays(camera, options, false);
  const Projection projection(camera);
  tbb::parallel_for(0, camera.height_px, [&](int v) {
    for (int u = 0; u < camera.width_px; ++u) {
      const Hit hit =
          rays.cast(pixel_rays.origin(), pixel_rays.direction(static_cast<float>(u), static_cast<float>(v)));
      if (hit.object < 0) continue;
      // Directions have a depth of 1 m, so the distance in lengths of the direction is the depth.
      truth.disparity_px[truth.index(u, v)] = static_cast<float>(projection.disparity_at_depth(hit.distance));
      truth.object[truth.index(u, v)] = hit.object;
    }
  });
  return truth;
}

std::vector<TruthObject> measure_objects(const RayScene& rays, const StereoCamera& camera, const SceneOptions& options,
                                         const PixelTruth& pixels) {
  const Projection projection(camera);
  const PixelRays pixel_rays(camera, options, false);
  const auto& objects = rays.scene().objects;
  std::vector<std::size_t> visible_px(objects.size(), 0);
  for (const int object : pixels.object)
    if (object >= 0) ++visible_px[static_cast<std::size_t>(object)];

  std::vector<TruthObject> truth;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    if (!is_obstacle(object.kind)) continue;
    const auto extent = project_mesh(object.mesh, projection);
    if (!extent) continue;
    // Pixels cover half a pixel to each side of their centre.
    const double u_max = camera.width_px - 0.5, v_max = camera.height_px - 0.5;
    const Extent cut{std::clamp(extent->u0, -0.5, u_max), std::clamp(extent->v0, -0.5, v_max),
                     std::clamp(extent->u1, -0.5, u_max), std::clamp(extent->v1, -0.5, v_max)};
    const double area = extent->box().width_px * extent->box().height_px;
    const double cut_area = cut.box().width_px * cut.box().height_px;
    if (cut_area <= 0.0) continue;
    TruthObject t;
    t.kind = object.kind;
    t.scene_index = i;
    t.x_m = object.x_m;
    t.y_m = object.y_m;
    t.z_m = object.z_m;
    t.yaw_rad = object.yaw_rad;
    t.length_m = object.length_m;
    t.width_m = object.width_m;
    t.height_m = object.height_m;
    t.vx_mps = object.vx_mps;
    t.vy_mps = object.vy_mps;
    t.near_range_m = footprint_range_m(object);
    t.whole_box = extent->box();
    t.box = cut.box();
    t.truncation = 1.0 - cut_area / area;
    t.visible_px = visible_px[i];
    t.occlusion = visible_px[i] == 0 ? 1.0 : hidden_share(object, i, t.box, pixel_rays, pixels);
    truth.push_back(t);
  }
  std::sort(truth.begin(), truth.end(),
            [](const TruthObject& a, const TruthObject& b) { return a.near_range_m < b.near_range_m; });
  return truth;
}

}  // namespace flies::synth
