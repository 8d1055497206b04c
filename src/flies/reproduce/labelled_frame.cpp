#include "flies/reproduce/labelled_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/eval/measures.hpp"
#include "flies/eval/scene_truth.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// Every pixel would be slow to search and tell no more: at 40 m this is a return every 0.17 m.
constexpr int kPixelStep = 3;

bool counts(const LabelledObject& object, const MatchOptions& match) {
  const double range_m = near_range_m(object.footprint);
  return is_person(object) && object.visible && range_m >= match.min_range_m && range_m <= match.max_range_m;
}

bool shows_people(const FrameTruth& truth, const MatchOptions& match) {
  return std::any_of(truth.objects.begin(), truth.objects.end(), [&](const auto& o) { return counts(o, match); });
}

std::vector<LidarPoint> exact_returns(const PixelTruth& pixels, const StereoCamera& camera) {
  const Projection projection(camera);
  std::vector<LidarPoint> returns;
  for (int v = 0; v < pixels.height_px; v += kPixelStep) {
    for (int u = 0; u < pixels.width_px; u += kPixelStep) {
      const float disparity_px = pixels.disparity_px[pixels.index(u, v)];
      if (!(disparity_px > projection.disparity_offset_px())) continue;
      const Point3 point = projection.triangulate({double(u), double(v), disparity_px});
      returns.push_back({point, point.z_m});  // the ground of every synthetic scene is nominal
    }
  }
  return returns;
}

/// The near face in the direction of the middle of the object, by the one definition that eval has.
double near_face_range(const FrameTruth& truth, const LabelledObject& object, const MatchOptions& match) {
  FrameTruth alone = truth;
  alone.objects = {object};
  Obstacle middle;
  middle.x_m = object.footprint.x_m;
  middle.y_m = object.footprint.y_m;
  middle.range_m = std::hypot(middle.x_m, middle.y_m);
  return score_frame(alone, std::vector<Obstacle>{middle}, match).obstacles.front().near_range_m;
}

/// Returns of everything but the person that stand clear of the road; where there are none, the outlines of the other
/// labelled objects.
std::vector<GroundPoint> places_of_others(const FrameTruth& truth, const LabelledObject& person,
                                          const MatchOptions& match) {
  std::vector<GroundPoint> others;
  for (const auto& lidar : truth.lidar)
    if (lidar.above_road_m >= match.min_above_road_m && lidar.above_road_m <= match.max_above_road_m &&
        !is_on_object(person, lidar))
      others.push_back({lidar.point.x_m, lidar.point.y_m});
  if (!truth.lidar.empty()) return others;
  constexpr double kStep = 0.1;  // of length and width
  for (const auto& object : truth.objects) {
    if (&object == &person) continue;
    const auto& f = object.footprint;
    for (double along = -0.5; along <= 0.5; along += kStep)
      for (double across = -0.5; across <= 0.5; across += kStep)
        others.push_back({f.x_m + along * f.length_m * std::cos(f.yaw_rad) - across * f.width_m * std::sin(f.yaw_rad),
                          f.y_m + along * f.length_m * std::sin(f.yaw_rad) + across * f.width_m * std::cos(f.yaw_rad)});
  }
  return others;
}

}  // namespace

LabelledFrame render_labelled_frame(const SceneOptions& options, const std::string& name) {
  const StereoCamera camera = synthetic_camera(options);
  auto rendered = render_pair(build_scene(options), camera, options);
  LabelledFrame frame;
  frame.name = name;
  frame.camera = camera;
  frame.truth = parse_scene_truth(truth_json(rendered.objects, camera, options.seed), name);
  frame.truth.name = name;
  frame.truth.lidar = exact_returns(rendered.pixels, camera);
  frame.images = {std::move(rendered.left_gray), std::move(rendered.right_gray)};
  return frame;
}

std::vector<LabelledFrame> read_frames_with_people(const std::filesystem::path& folder, TruthKind kind,
                                                   const MatchOptions& match) {
  const Dataset dataset = open_dataset(folder);
  const auto name_of = [](TruthKind k) { return kTruthKindNames[static_cast<std::size_t>(k)]; };
  if (dataset.kind != kind)
    throw InputError(folder.string(), "",
                     fmt::format("found a {}, expected a {}", name_of(dataset.kind), name_of(kind)));
  std::vector<LabelledFrame> frames;
  for (std::size_t i = 0; i < dataset.pairs.size(); ++i) {
    LabelledFrame frame{dataset.load(i), {}};
    frame.name = frame.truth.name;
    frame.camera.width_px = frame.images.left.width_px;  // some calibrations do not say
    frame.camera.height_px = frame.images.left.height_px;
    if (shows_people(frame.truth, match)) frames.push_back(std::move(frame));
  }
  if (frames.empty())
    throw InputError(folder.string(), "",
                     fmt::format("no frame shows a labelled person {:g} to {:g} m away that is not hidden",
                                 match.min_range_m, match.max_range_m));
  return frames;
}

std::vector<PersonPlace> people_in(const FrameTruth& truth, const MatchOptions& match) {
  std::vector<PersonPlace> people;
  for (const auto& object : truth.objects) {
    if (!counts(object, match)) continue;
    const auto& f = object.footprint;
    const double range_m = near_face_range(truth, object, match);
    const double middle_m = std::hypot(f.x_m, f.y_m);
    PersonPlace person;
    person.name = fmt::format("{} {}", object.type, object.track);
    person.near = {range_m * f.x_m / middle_m, range_m * f.y_m / middle_m};
    person.middle = {f.x_m, f.y_m};
    person.width_m = seen_width_m(f);
    person.height_m = object.height_m;
    person.others = places_of_others(truth, object, match);
    people.push_back(std::move(person));
  }
  return people;
}

}  // namespace flies
