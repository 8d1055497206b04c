#include "flies/eval/people_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "flies/eval/people.hpp"

namespace flies {

Pedestrian person_in_box(const ImageBox& box, double probability, const Projection& projection) {
  constexpr double kAssumedHeight_m = 1.7;
  const double u_px = box.u_px + box.width_px / 2.0, foot_v_px = box.v_px + box.height_px;
  const double depth_m = projection.fy_px() * kAssumedHeight_m / box.height_px;
  const Point3 foot = projection.triangulate({u_px, foot_v_px, projection.disparity_at_depth(depth_m)});
  Pedestrian person;
  person.x_m = foot.x_m;
  person.y_m = foot.y_m;
  person.range_m = std::hypot(foot.x_m, foot.y_m);
  person.height_m = kAssumedHeight_m;
  person.probability = probability;
  person.box = box;
  return person;
}

std::vector<Pedestrian> keep_surest(std::vector<Pedestrian> people, double max_overlap) {
  std::stable_sort(people.begin(), people.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  std::vector<Pedestrian> kept;
  for (const auto& person : people)
    if (std::none_of(kept.begin(), kept.end(), [&](const Pedestrian& surer) {
          return intersection_over_union(surer.box, person.box) > max_overlap;
        }))
      kept.push_back(person);
  std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.range_m < b.range_m; });
  return kept;
}

}  // namespace flies
