#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// A quarter of the place's picture in each direction.
SceneOptions small_place(SceneKind kind, std::uint64_t seed = 1) {
  SceneOptions options = scene_defaults(kind);
  options.seed = seed;
  options.width_px /= 4;
  options.height_px /= 4;
  options.focal_px /= 4.0;
  return options;
}

RenderedPair render_with_threads(const SceneOptions& options, int threads) {
  tbb::task_arena arena(threads);
  return arena.execute([&] { return render_pair(options); });
}

std::string text_of(const SceneOptions& options) {
  std::string text;
  for (const auto& listing : list_options(options))
    if (listing.path != "kind") text += listing.path + "=" + listing.value + "\n";
  return text;
}

double footprint_circle_m(const SceneObject& object) { return 0.5 * std::hypot(object.length_m, object.width_m); }

bool is_placed_freely(ObjectClass kind) {
  return kind == ObjectClass::box || kind == ObjectClass::pallet || kind == ObjectClass::pedestrian ||
         kind == ObjectClass::pole;
}

class Places : public testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(All, Places,
                         testing::Values(SceneKind::room, SceneKind::aisle, SceneKind::woods, SceneKind::pavement),
                         [](const auto& place) {
                           return std::string(EnumNames<SceneKind>::names[static_cast<std::size_t>(place.param)]);
                         });

TEST_P(Places, RepeatThemselvesWhateverTheThreadCountAndChangeWithTheSeed) {
  const auto options = small_place(GetParam());
  const auto one = render_with_threads(options, 1), two = render_with_threads(options, 2);
  EXPECT_EQ(one.left.pixels, two.left.pixels);
  EXPECT_EQ(one.right.pixels, two.right.pixels);
  EXPECT_EQ(one.pixels.object, two.pixels.object);
  EXPECT_NE(one.pixels.object, render_pair(small_place(GetParam(), 2)).pixels.object);
}

TEST_P(Places, HaveAllThatWasAskedForApartFromEachOther) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto scene = build_scene(small_place(GetParam(), seed));
    std::vector<const SceneObject*> things;
    for (const auto& object : scene.objects)
      if (is_placed_freely(object.kind)) things.push_back(&object);
    EXPECT_GE(things.size(), GetParam() == SceneKind::woods ? 0U : 2U) << "seed " << seed;
    for (const auto* a : things)
      for (const auto* b : things) {
        if (a == b) continue;
        EXPECT_GT(std::hypot(a->x_m - b->x_m, a->y_m - b->y_m), footprint_circle_m(*a) + footprint_circle_m(*b) - 0.05)
            << "seed " << seed;
      }
  }
}

TEST_P(Places, ThingsAreSeenWhereTheirTruthIs) {
  const auto options = small_place(GetParam());
  const auto camera = synthetic_camera(options);
  const Projection projection(camera);
  const auto pair = render_pair(options);
  std::size_t seen = 0;
  for (const auto& object : pair.objects) {
    for (int v = 0; v < camera.height_px; ++v)
      for (int u = 0; u < camera.width_px; ++u) {
        const auto i = pair.pixels.index(u, v);
        if (pair.pixels.object[i] != static_cast<int>(object.scene_index)) continue;
        const Point3 point =
            projection.triangulate({static_cast<double>(u), static_cast<double>(v), pair.pixels.disparity_px[i]});
        constexpr double kFloat_m = 0.01;  // vertices are floats, and turned ones rounded again
        const double c = std::cos(object.yaw_rad), s = std::sin(object.yaw_rad);
        const double dx = point.x_m - object.x_m, dy = point.y_m - object.y_m;
        ASSERT_LE(std::abs(c * dx + s * dy), 0.5 * object.length_m + kFloat_m);
        ASSERT_LE(std::abs(-s * dx + c * dy), 0.5 * object.width_m + kFloat_m);
        ASSERT_GE(point.z_m, object.z_m - kFloat_m);
        ASSERT_LE(point.z_m, object.z_m + object.height_m + kFloat_m);
        ++seen;
      }
  }
  EXPECT_GT(seen, 1000U);
}

TEST(BuildScene, IndoorsNoSkyIsSeen) {
  for (const auto kind : {SceneKind::room, SceneKind::aisle}) {
    const auto pair = render_pair(small_place(kind));
    EXPECT_EQ(std::count(pair.pixels.object.begin(), pair.pixels.object.end(), -1), 0);
  }
}

TEST(BuildScene, BeforeADroneThereIsNoGroundNear) {
  const auto options = small_place(SceneKind::woods);
  const auto camera = synthetic_camera(options);
  const auto scene = build_scene(options);
  const auto pair = render_pair(options);
  constexpr double kNear_m = 11.0;
  bool is_tree_near = false;
  for (std::size_t i = 0; i < pair.pixels.object.size(); ++i) {
    if (pair.pixels.object[i] < 0) continue;
    const double range_m = camera.fx_px * camera.baseline_m / pair.pixels.disparity_px[i];
    const auto kind = scene.objects[static_cast<std::size_t>(pair.pixels.object[i])].kind;
    EXPECT_FALSE(kind == ObjectClass::ground && range_m < kNear_m) << range_m;
    is_tree_near |= kind == ObjectClass::tree && range_m < kNear_m;
  }
  EXPECT_TRUE(is_tree_near);
}

TEST(SceneDefaults, OfRoadsAreTheDefaults) {
  const SceneOptions defaults;
  for (const auto kind :
       {SceneKind::street, SceneKind::crossing, SceneKind::empty_road, SceneKind::pedestrian, SceneKind::wall}) {
    EXPECT_EQ(scene_defaults(kind).kind, kind);
    EXPECT_EQ(text_of(scene_defaults(kind)), text_of(defaults));
  }
}

TEST(SceneDefaults, CamerasOfOtherPlacesAreSmallAndLow) {
  EXPECT_EQ(synthetic_camera(scene_defaults(SceneKind::room)).mount.height_m, 1.0);
  EXPECT_EQ(synthetic_camera(scene_defaults(SceneKind::aisle)).mount.height_m, 0.5);
  EXPECT_EQ(synthetic_camera(scene_defaults(SceneKind::pavement)).mount.height_m, 0.3);
  EXPECT_EQ(synthetic_camera(scene_defaults(SceneKind::woods)).mount.height_m, 7.0);
  EXPECT_EQ(scene_defaults(SceneKind::room).sun_strength, 0.0);
}

TEST(KittiLabels, KnowFurnitureAndBoxesAsMiscAndShelvesAsRegions) {
  const auto options = small_place(SceneKind::aisle);
  const auto pair = render_pair(options);
  const std::string labels = kitti_labels(pair.objects, synthetic_camera(options));
  EXPECT_NE(labels.find("Misc "), std::string::npos);
  EXPECT_NE(labels.find("DontCare "), std::string::npos);
}

}  // namespace
}  // namespace flies
