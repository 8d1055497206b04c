#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/synth/person.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// A quarter of the default picture in each direction: quick, and everything is still in it.
SceneOptions small_street() {
  SceneOptions options;
  options.width_px = 310;
  options.height_px = 94;
  options.focal_px = 180.0;
  return options;
}

RenderedPair render_with_threads(const SceneOptions& options, int threads) {
  tbb::task_arena arena(threads);
  return arena.execute([&] { return render_pair(options); });
}

TEST(RenderPair, RepeatsItselfWhateverTheThreadCount) {
  const auto options = small_street();
  const auto one = render_with_threads(options, 1), two = render_with_threads(options, 2);
  EXPECT_EQ(one.left.pixels, two.left.pixels);
  EXPECT_EQ(one.right.pixels, two.right.pixels);
  EXPECT_EQ(one.pixels.object, two.pixels.object);
}

TEST(RenderPair, ChangesWithTheSeed) {
  auto options = small_street();
  const auto first = render_pair(options);
  options.seed = 2;
  EXPECT_NE(first.left.pixels, render_pair(options).left.pixels);
}

TEST(RenderPair, RightImageIsTheLeftOneShiftedByTheTruth) {
  auto options = small_street();
  options.noise_gray = 0.0;
  options.samples_per_side = 4;
  const auto pair = render_pair(options);
  // A left pixel is seen in the right image too unless something with a larger disparity lands on the same place.
  std::map<std::pair<int, int>, float> nearest;
  const auto& truth = pair.pixels;
  const auto shifted = [&](int u, float disparity_px) {
    return static_cast<int>(std::lround(static_cast<float>(u) - disparity_px));
  };
  for (int v = 0; v < truth.height_px; ++v)
    for (int u = 0; u < truth.width_px; ++u) {
      const float disparity_px = truth.disparity_px[truth.index(u, v)];
      if (std::isnan(disparity_px)) continue;
      auto& entry = nearest[{v, shifted(u, disparity_px)}];
      entry = std::max(entry, disparity_px);
    }
  std::vector<double> errors, unshifted_errors;
  for (int v = 0; v < truth.height_px; ++v)
    for (int u = 1; u < truth.width_px; ++u) {
      const float disparity_px = truth.disparity_px[truth.index(u, v)];
      const double right_u = u - static_cast<double>(disparity_px);
      if (std::isnan(disparity_px) || right_u < 0.0) continue;
      if (nearest[{v, shifted(u, disparity_px)}] > disparity_px + 0.5F) continue;
      const int u0 = static_cast<int>(right_u);
      const double share = right_u - u0;
      const double right =
          (1.0 - share) * pair.right_gray.view().at(u0, v) + share * pair.right_gray.view().at(u0 + 1, v);
      errors.push_back(std::abs(right - pair.left_gray.view().at(u, v)));
      unshifted_errors.push_back(std::abs(pair.right_gray.view().at(u, v) - pair.left_gray.view().at(u, v)));
    }
  ASSERT_GT(errors.size(), 15000U);
  // Interpolating between pixels and rounding to whole grey levels cost about one level.
  constexpr double kTolerance_gray = 2.0;
  EXPECT_LT(upper_median(errors), kTolerance_gray);
  EXPECT_GT(upper_median(unshifted_errors), 2.0 * upper_median(errors));
}

TEST(RenderPair, AppliesGainAndVerticalOffsetToTheRightImageOnly) {
  auto options = small_street();
  options.noise_gray = 0.0;
  const auto plain = render_pair(options);
  options.gain_difference = -0.2;
  options.vertical_offset_px = 1.0;
  const auto faulty = render_pair(options);
  EXPECT_EQ(plain.left.pixels, faulty.left.pixels);
  EXPECT_EQ(plain.pixels.object, faulty.pixels.object);
  double worst = 0.0;
  for (int v = 5; v + 5 < options.height_px; ++v)
    for (int u = 0; u < options.width_px; ++u)
      worst = std::max(worst, std::abs(0.8 * plain.right_gray.view().at(u, v) - faulty.right_gray.view().at(u, v + 1)));
  constexpr double kRounding_gray = 2.0;  // three channels rounded before and after the gain
  EXPECT_LT(worst, kRounding_gray);
}

TEST(RenderPair, NoiseHasTheStandardDeviationAskedFor) {
  auto options = small_street();
  options.kind = SceneKind::empty_road;
  options.noise_gray = 0.0;
  const auto clean = render_pair(options);
  options.noise_gray = 4.0;
  const auto noisy = render_pair(options);
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < clean.left_gray.pixels.size(); ++i) {
    if (clean.left_gray.pixels[i] > 230) continue;  // the noise is cut off at white
    const double difference = noisy.left_gray.pixels[i] - clean.left_gray.pixels[i];
    squares += difference * difference;
    count += 1.0;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 4.0, 0.15);  // four standard errors of some 25000 pixels, and rounding
}

TEST(RenderPair, DisparityOfTheRoadIsThatOfThePlane) {
  auto options = small_street();
  options.kind = SceneKind::empty_road;
  options.pitch_deg = 3.0;
  options.roll_deg = -2.0;
  const auto camera = synthetic_camera(options);
  const auto pair = render_pair(options);
  const Projection projection(camera);
  for (const int u : {20, 150, 290}) {
    const int v = 85;
    const double disparity_px = pair.pixels.disparity_px[pair.pixels.index(u, v)];
    const auto road = projection.triangulate({static_cast<double>(u), static_cast<double>(v), disparity_px});
    EXPECT_GT(road.x_m, 1.0);
    EXPECT_NEAR(road.z_m, 0.0, 0.01);  // lane paint lies a few millimetres above the road
  }
}

TEST(BuildScene, EmptyRoadHasNoObstacles) {
  auto options = small_street();
  options.kind = SceneKind::empty_road;
  EXPECT_TRUE(render_pair(options).objects.empty());
}

TEST(BuildScene, PedestrianStandsWhereAskedFor) {
  auto options = small_street();
  options.kind = SceneKind::pedestrian;
  options.people_min_range_m = 15.0;
  const auto pair = render_pair(options);
  ASSERT_EQ(pair.objects.size(), 1U);
  const auto& person = pair.objects.front();
  EXPECT_EQ(person.kind, ObjectClass::pedestrian);
  EXPECT_NEAR(person.x_m, 15.0, 0.3);  // the middle of the stride, not of the hips
  EXPECT_LT(person.near_range_m, person.x_m);
  EXPECT_GE(person.height_m, 1.55 - 1e-3);
  EXPECT_LE(person.height_m, 1.95 + 1e-3);
  EXPECT_EQ(person.occlusion, 0.0);
  EXPECT_EQ(person.truncation, 0.0);
  // Every pixel that shows the person lies in the box, and one touches each of its sides.
  int left = 1000, right = -1, top = 1000, bottom = -1;
  for (int v = 0; v < options.height_px; ++v)
    for (int u = 0; u < options.width_px; ++u)
      if (pair.pixels.object[pair.pixels.index(u, v)] == static_cast<int>(person.scene_index)) {
        left = std::min(left, u);
        right = std::max(right, u);
        top = std::min(top, v);
        bottom = std::max(bottom, v);
      }
  constexpr double kPixel = 1.01;
  EXPECT_NEAR(person.box.u_px, left, kPixel);
  EXPECT_NEAR(person.box.u_px + person.box.width_px, right, kPixel);
  EXPECT_NEAR(person.box.v_px, top, kPixel);
  EXPECT_NEAR(person.box.v_px + person.box.height_px, bottom, kPixel);
}

TEST(BuildScene, WallStandsAcrossTheRoad) {
  auto options = small_street();
  options.kind = SceneKind::wall;
  options.people_min_range_m = 12.0;
  const auto pair = render_pair(options);
  ASSERT_EQ(pair.objects.size(), 1U);
  EXPECT_EQ(pair.objects[0].kind, ObjectClass::wall);
  EXPECT_NEAR(pair.objects[0].near_range_m, 12.0, 1e-3);
  const double expected_px = 180.0 * 0.54 / 12.0;
  EXPECT_NEAR(pair.pixels.disparity_px[pair.pixels.index(155, 40)], expected_px, 1e-3);
}

TEST(BuildScene, PutsNothingIntoEachOther) {
  auto options = small_street();
  options.people = 20;
  options.cars = 12;
  for (options.seed = 1; options.seed <= 5; ++options.seed) {
    const auto scene = build_scene(options);
    const auto people = std::count_if(scene.objects.begin(), scene.objects.end(),
                                      [](const auto& object) { return object.kind == ObjectClass::pedestrian; });
    ASSERT_GE(people, 10) << "seed " << options.seed;
    for (const auto& a : scene.objects)
      for (const auto& b : scene.objects) {
        if (&a == &b || a.kind != ObjectClass::pedestrian) continue;
        if (b.kind != ObjectClass::pedestrian && b.kind != ObjectClass::pole) continue;
        EXPECT_GT(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m), 0.3) << "seed " << options.seed;
      }
  }
}

TEST(BuildScene, RefusesOptionsOutOfRange) {
  auto options = small_street();
  options.people = -1;
  EXPECT_THROW(build_scene(options), InputError);
  options = small_street();
  options.people_min_range_m = 20.0;
  options.people_max_range_m = 10.0;
  EXPECT_THROW(build_scene(options), InputError);
  options = small_street();
  options.focal_px = std::nan("");
  EXPECT_THROW(synthetic_camera(options), InputError);
}

TEST(Person, StandsOnTheGroundAndIsAsTallAsAskedFor) {
  for (std::uint32_t i = 0; i < 30; ++i) {
    FlyRandom random(5, 1, 0, i);
    const auto look = synth::random_look(random, i % 3 == 0, 1.0F);
    const auto bounds = synth::bounds_of(synth::person(look));
    EXPECT_NEAR(bounds.low.z, 0.0F, 1e-4F);
    EXPECT_NEAR(bounds.high.z, look.height_m, 1e-4F);
    EXPECT_LT(bounds.high.y - bounds.low.y, 0.45F * look.height_m);  // narrower than with arms stretched out
  }
}

TEST(KittiLabels, PositionComesBackThroughTheCamera) {
  auto options = small_street();
  options.pitch_deg = 2.0;
  const auto camera = synthetic_camera(options);
  const auto pair = render_pair(options);
  std::istringstream lines(kitti_labels(pair.objects, camera));
  const Projection projection(camera);
  std::string line;
  std::size_t people = 0;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string type;
    double truncated, occluded, alpha, u0, v0, u1, v1, h, w, l, x, y, z, heading;
    ASSERT_TRUE(fields >> type >> truncated >> occluded >> alpha >> u0 >> v0 >> u1 >> v1 >> h >> w >> l >> x >> y >>
                z >> heading)
        << line;
    if (type != "Pedestrian") continue;
    ++people;
    const auto foot = projection.triangulate(
        {camera.cx_px + camera.fx_px * x / z, camera.cy_px + camera.fy_px * y / z, projection.disparity_at_depth(z)});
    // Labels are rounded to millimetres.
    const bool is_known = std::any_of(pair.objects.begin(), pair.objects.end(), [&](const TruthObject& object) {
      const double turn_rad = object.yaw_rad + heading + std::numbers::pi / 2.0;
      return std::hypot(object.x_m - foot.x_m, object.y_m - foot.y_m, object.z_m - foot.z_m) < 2e-3 &&
             std::abs(std::remainder(turn_rad, 2.0 * std::numbers::pi)) < 0.01;
    });
    EXPECT_TRUE(is_known) << line;
  }
  EXPECT_GT(people, 2U);
}

TEST(TruthJson, HoldsEveryObject) {
  const auto options = small_street();
  const auto pair = render_pair(options);
  const auto json = nlohmann::json::parse(truth_json(pair.objects, synthetic_camera(options), 1));
  ASSERT_EQ(json.at("objects").size(), pair.objects.size());
  EXPECT_EQ(json.at("seed"), 1);
  EXPECT_NEAR(json.at("objects").at(0).at("x_m").get<double>(), pair.objects[0].x_m, 1e-4);
}

}  // namespace
}  // namespace flies
