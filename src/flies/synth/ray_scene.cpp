#include "flies/synth/ray_scene.hpp"

#include <tbb/task_arena.h>

#include <limits>
#include <new>

namespace flies::synth {
namespace {

RTCRay rtc_ray(const Vec3& origin, const Vec3& direction, float reach) {
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tfar = reach;
  ray.mask = ~0U;
  return ray;
}

Vec3 to_vec3(const Point3& p) {
  return {static_cast<float>(p.x_m), static_cast<float>(p.y_m), static_cast<float>(p.z_m)};
}

}  // namespace

// One thread builds the tree, so that equal distances are always resolved in the same order.
RayScene::RayScene(const SyntheticScene& scene)
    : scene_(scene), device_(rtcNewDevice("threads=1")), rtc_scene_(nullptr) {
  if (device_ == nullptr) throw std::bad_alloc();
  rtc_scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(rtc_scene_, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Mesh& mesh = scene.objects[i].mesh;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                sizeof(Vec3), mesh.positions.size()));
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), vertices);
    for (const auto& t : mesh.triangles) {
      *corners++ = t.a;
      *corners++ = t.b;
      *corners++ = t.c;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(rtc_scene_, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  tbb::task_arena one_thread(1);
  one_thread.execute([&] { rtcCommitScene(rtc_scene_); });
}

RayScene::~RayScene() {
  rtcReleaseScene(rtc_scene_);
  rtcReleaseDevice(device_);
}

Hit RayScene::cast(const Vec3& origin, const Vec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray_hit{};
  ray_hit.ray = rtc_ray(origin, direction, std::numeric_limits<float>::infinity());
  ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(rtc_scene_, &context, &ray_hit);
  if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {static_cast<int>(ray_hit.hit.geomID),
          ray_hit.hit.primID,
          ray_hit.ray.tfar,
          ray_hit.hit.u,
          ray_hit.hit.v,
          {ray_hit.hit.Ng_x, ray_hit.hit.Ng_y, ray_hit.hit.Ng_z}};
}

bool RayScene::is_blocked(const Vec3& origin, const Vec3& direction, float reach) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = rtc_ray(origin, direction, reach);
  rtcOccluded1(rtc_scene_, &context, &ray);
  return ray.tfar < 0.0F;  // Embree's sign for "blocked"
}

SingleObject::SingleObject(const SceneObject& object) : scene_{{object}, {}}, rays_(scene_) {}

bool SingleObject::is_hit(const Vec3& origin, const Vec3& direction) const {
  return rays_.is_blocked(origin, direction, std::numeric_limits<float>::infinity());
}

PixelRays::PixelRays(const StereoCamera& camera, const SceneOptions& options, bool is_right)
    : cx_px_(static_cast<float>(is_right ? camera.cx_right_px : camera.cx_px)),
      cy_px_(static_cast<float>(camera.cy_px)) {
  // The camera's axes in the vehicle frame, from the one projection that everything else uses too.
  const Projection projection(camera);
  const double disparity_px = projection.disparity_at_depth(1.0);
  const auto at = [&](double u_px, double v_px) {
    return to_vec3(projection.triangulate({u_px, v_px, disparity_px})) -
           Vec3{0, 0, static_cast<float>(camera.mount.height_m)};
  };
  forward_ = at(camera.cx_px, camera.cy_px);
  const Vec3 right = at(camera.cx_px + camera.fx_px, camera.cy_px) - forward_;
  const Vec3 down = at(camera.cx_px, camera.cy_px + camera.fy_px) - forward_;
  right_per_px_ = right * static_cast<float>(1.0 / camera.fx_px);
  down_per_px_ = down * static_cast<float>(1.0 / camera.fy_px);
  origin_ = {0, 0, static_cast<float>(camera.mount.height_m)};
  if (is_right) {
    origin_ = origin_ + right * static_cast<float>(camera.baseline_m);
    offset_v_px_ = static_cast<float>(options.vertical_offset_px);
    cos_roll_ = static_cast<float>(std::cos(radians(options.relative_roll_deg)));
    sin_roll_ = static_cast<float>(std::sin(radians(options.relative_roll_deg)));
  }
}

Vec3 PixelRays::direction(float u_px, float v_px) const {
  const float u = u_px - cx_px_, v = v_px - cy_px_ - offset_v_px_;
  return forward_ + right_per_px_ * (cos_roll_ * u + sin_roll_ * v) + down_per_px_ * (cos_roll_ * v - sin_roll_ * u);
}

}  // namespace flies::synth
