// What must not change a result, of the whole of which every number is compared: the instruction set, the number of
// threads, and what else the process has worked out before.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "flies/fitness/fitness.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/synth/render.hpp"

namespace flies {
namespace {

/// Numbers as text, without rounding: a line each time it is added to.
class Listing {
 public:
  Listing() { text_ << std::hexfloat; }

  template <class... Numbers>
  void add(std::string_view what, const Numbers&... numbers) {
    text_ << what;
    ((text_ << ' ' << numbers), ...);
    text_ << '\n';
  }
  void add(const std::vector<Obstacle>& obstacles) {
    for (const Obstacle& o : obstacles) {
      add("obstacle", o.x_m, o.y_m, o.range_m, o.width_m, o.middle_offset_m, o.depth_m, o.height_m, o.ground_z_m);
      add("of it", o.score, o.range_sd_m, o.box.u_px, o.box.v_px, o.box.width_px, o.box.height_px);
    }
  }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

/// All of a result but its times.
std::string every_number(const Detection& d) {
  Listing listing;
  listing.add("road", d.road.found, d.road.plane.height_m, d.road.plane.slope, d.road.plane.bank);
  for (const RoadProbe& probe : d.road.probes)
    listing.add("probe", probe.point.x_m, probe.point.y_m, probe.point.z_m, probe.correlation, probe.inlier);
  listing.add("evaluations", d.evolved.evaluations);
  for (std::size_t i = 0; i < d.evolved.flies.size(); ++i) {
    const auto [point, fitness] = d.evolved.flies.fly(i);
    const StereoPoint image = d.evolved.in_image.point(i);
    listing.add("fly", point.x_m, point.y_m, point.z_m, fitness, image.u_px, image.v_px, image.disparity_px);
  }
  listing.add("scan", d.scan.angle_min_rad, d.scan.angle_increment_rad);
  for (std::size_t i = 0; i < d.scan.size(); ++i)
    listing.add("sector", static_cast<int>(d.scan.states[i]), d.scan.ranges_m[i], d.scan.free_m[i],
                d.scan.confidence[i]);
  for (const Candidate& c : d.concentrate.candidates)
    listing.add("candidate", c.pixel.u_px, c.pixel.v_px, c.ground.x_m, c.ground.y_m, c.density, c.kept);
  for (const int obstacle : d.concentrate.obstacle_of_fly) listing.add("obstacle of fly", obstacle);
  listing.add(d.concentrate.obstacles);
  listing.add(d.obstacles);
  for (std::size_t i = 0; i < d.rois.size(); ++i)
    listing.add("box", d.rois[i].window.u_px, d.rois[i].window.v_px, d.rois[i].window.height_px, d.rois[i].x_m,
                d.rois[i].y_m, d.rois[i].height_m, d.rois[i].obstacle, d.roi_scores[i]);
  for (const Pedestrian& p : d.pedestrians)
    listing.add("pedestrian", p.x_m, p.y_m, p.range_m, p.range_sd_m, p.height_m, p.probability, p.box.u_px, p.box.v_px,
                p.box.width_px, p.box.height_px);
  return listing.text();
}

/// Small, for some tests paint it anew in processes of their own.
const SceneOptions kStreet = [] {
  SceneOptions options;
  options.seed = 1;
  options.width_px = 720;
  options.height_px = 240;
  options.samples_per_side = 1;
  return options;
}();

const RenderedPair& street() {
  static const RenderedPair pair = render_pair(kStreet);
  return pair;
}

/// The pair twice, as from a camera that stands still: what is remembered has a say in the second result.
std::string results(const DetectorOptions& options = {}) {
  Detector detector(synthetic_camera(kStreet), options);
  const Detection first = detector.process(street().gray_pair());
  const Detection second = detector.process(street().gray_pair(), PlanarMotion{});
  EXPECT_FALSE(first.obstacles.empty() || first.pedestrians.empty());
  EXPECT_FALSE(second.obstacles.empty() || second.pedestrians.empty());
  return every_number(first) + every_number(second);
}

std::string with_seed(std::uint64_t seed) {
  DetectorOptions options;
  options.seed = seed;
  return results(options);
}

/// Says where two texts part, which is more readable than both of them.
void expect_same(const std::string& found, const std::string& expected) {
  if (found == expected) return;
  const auto line = [](const std::string& text, std::size_t at) {
    const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
    return text.substr(begin, text.find('\n', at) - begin);
  };
  const auto parted = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
  const auto at = static_cast<std::size_t>(parted.first - found.begin());
  ADD_FAILURE() << "found:    " << line(found, at) << "\nexpected: " << line(expected, at);
}

class InstructionSet : public testing::TestWithParam<std::int64_t> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(InstructionSet, OfAllKernelsButTheFitnessDoesNotMatter) {
  const std::string expected = results();
  hwy::SetSupportedTargetsForTest(GetParam());
  expect_same(results(), expected);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, InstructionSet, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

// A process chooses the kernel of the fitness once, so each has one of its own.
TEST(FitnessKernelDeathTest, ThatIsNamedByTheEnvironmentDoesNotMatter) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto print_results = [] {
    std::cerr << kernel_target_name() << " gives " << std::hash<std::string>()(results()) << '\n';
    std::_Exit(0);
  };
  const std::string expected = " gives " + std::to_string(std::hash<std::string>()(results())) + "\n";
  for (const std::string_view target : kernel_target_names()) {
    setenv("FLIES_TARGET", std::string(target).c_str(), 1);
    EXPECT_EXIT(print_results(), testing::ExitedWithCode(0), "^" + std::string(target) + expected);
  }
  unsetenv("FLIES_TARGET");
}

TEST(Threads, DoNotMatter) {
  // More than there are cores, where there are fewer.
  const tbb::global_control four_threads(tbb::global_control::max_allowed_parallelism, 4);
  const std::string expected = results();
  for (const int threads : {2, 4}) {
    SCOPED_TRACE(threads);
    DetectorOptions options;
    options.threads = threads;
    expect_same(results(options), expected);
  }
}

TEST(Seeds, GiveTheSameInWhateverOrder) {
  std::map<std::uint64_t, std::string> by_seed;
  for (const std::uint64_t seed : {1U, 2U, 3U}) by_seed[seed] = with_seed(seed);
  EXPECT_NE(by_seed[1], by_seed[2]);
  EXPECT_NE(by_seed[2], by_seed[3]);
  for (const std::uint64_t seed : {3U, 2U, 1U}) {
    SCOPED_TRACE(seed);
    expect_same(with_seed(seed), by_seed[seed]);
  }
}

}  // namespace
}  // namespace flies
