#include "flies/synth/placing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flies/synth/person.hpp"
#include "flies/synth/street.hpp"

namespace flies::synth {

float half_view_of(const SceneOptions& options, float margin) {
  return static_cast<float>(0.5 * options.width_px / options.focal_px) * (1.0F - margin);
}

bool find_place(FlyRandom& random, const Thing& thing, const FreeGround& ground, Taken& taken,
                std::vector<SceneObject>& objects) {
  constexpr int kAttempts = 80;
  const Bounds bounds = bounds_of(thing.mesh);
  const float radius_m = 0.5F * std::hypot(bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const float x = static_cast<float>(random.uniform(ground.x0_m, ground.x1_m));
    const float y = static_cast<float>(random.uniform(ground.y0_m, ground.y1_m));
    if (std::abs(y) > ground.half_view * x || x * x + y * y < radius_m * radius_m) continue;
    if (!taken.is_free(x, y, radius_m) || (thing.in_sight && !taken.is_in_sight(x, y))) continue;
    taken.circles.push_back({x, y, radius_m});
    objects.push_back(stand(thing.kind, thing.mesh, {{x, y, thing.z_m}, thing.yaw_rad}));
    return true;
  }
  return false;
}

void place_people(const SceneOptions& options, const FreeGround& ground, Taken& taken,
                  std::vector<SceneObject>& objects) {
  FreeGround walked = ground;
  walked.x0_m = std::max(ground.x0_m, static_cast<float>(options.people_min_range_m));
  walked.x1_m = std::max(walked.x0_m, std::min(ground.x1_m, static_cast<float>(options.people_max_range_m)));
  for (std::uint32_t i = 0; static_cast<int>(i) < options.people; ++i) {
    FlyRandom random(options.seed, kPeoplePurpose, 0, i);
    const bool is_child = random.uniform() < options.children;
    Thing somebody{.kind = ObjectClass::pedestrian,
                   .mesh = person(random_look(random, is_child, static_cast<float>(options.texture_contrast)))};
    somebody.yaw_rad = static_cast<float>(random.uniform(-std::numbers::pi, std::numbers::pi));
    find_place(random, somebody, walked, taken, objects);
  }
}

}  // namespace flies::synth
