#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/evolve/operators.hpp"
#include "flies/pipeline/detector.hpp"
#include "flies/track/tracks.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kWidth_px = 160, kHeight_px = 120;

/// A pair of noise, and what a stage needs besides its options.
struct Bench {
  Bench() : pixels(kWidth_px * kHeight_px) {
    std::mt19937 random(7);
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random() & 255U);
  }
  GrayView view() const { return {pixels.data(), kWidth_px, kHeight_px, kWidth_px}; }
  RectifiedPair pair() const { return {view(), view()}; }

  std::vector<std::uint8_t> pixels;
  StereoCamera camera{200, 200, 80, 80, 60, 0.5, kWidth_px, kHeight_px, {}};
  Projection projection{camera};
};

/// Sets options to what no range allows and runs a stage with them.
struct BadOptions {
  const char* name;
  const char* complaint;
  std::function<void(const Bench&)> run;
};

void PrintTo(const BadOptions& bad, std::ostream* out) { *out << bad.name; }

class StagesAlone : public ::testing::TestWithParam<BadOptions> {};

TEST_P(StagesAlone, CheckTheirOptions) {
  const Bench bench;
  EXPECT_THAT([&] { GetParam().run(bench); }, ThrowsMessage<InputError>(HasSubstr(GetParam().complaint)));
}

BadOptions bad_fitness(const char* name, const char* complaint, const std::function<void(FitnessOptions&)>& spoil) {
  return {name, complaint, [spoil](const Bench& bench) {
            FitnessOptions options;
            spoil(options);
            score_point(bench.pair(), options, {80, 60, 10});
          }};
}

BadOptions bad_evolution(const char* name, const char* complaint, const std::function<void(EvolveOptions&)>& spoil) {
  return {name, complaint, [spoil](const Bench& bench) {
            EvolveOptions options;
            spoil(options);
            evolve(bench.pair(), bench.projection, {}, {}, {}, options, {});
          }};
}

BadOptions bad_field(const char* name, const char* complaint, const std::function<void(FieldOptions&)>& spoil) {
  return {name, complaint, [spoil](const Bench& bench) {
            FieldOptions field;
            spoil(field);
            concentrate({}, bench.projection, {}, field, {});
          }};
}

BadOptions bad_concentration(const char* name, const char* complaint,
                             const std::function<void(ConcentrateOptions&)>& spoil) {
  return {name, complaint, [spoil](const Bench& bench) {
            ConcentrateOptions options;
            spoil(options);
            concentrate({}, bench.projection, {}, {}, options);
          }};
}

BadOptions bad_scan(const char* name, const char* complaint, const std::function<void(ScanOptions&)>& spoil) {
  return {name, complaint, [spoil](const Bench& bench) {
            ScanOptions options;
            spoil(options);
            scan(bench.pair(), bench.projection, {}, {}, {}, options);
          }};
}

/// A right image of fewer rows.
RectifiedPair uneven(const Bench& bench) {
  RectifiedPair pair = bench.pair();
  pair.right.height_px = kHeight_px / 2;
  return pair;
}

INSTANTIATE_TEST_SUITE_P(
    Table, StagesAlone,
    ::testing::Values(
        bad_fitness("HalfWidth", "half_width_px: found 40", [](auto& o) { o.half_width_px = 40; }),
        bad_fitness("HalfHeight", "half_height_px: found 60", [](auto& o) { o.half_height_px = 60; }),
        bad_fitness("RowStep", "row_step: found 0", [](auto& o) { o.row_step = 0; }),
        bad_fitness("Function", "function", [](auto& o) { o.function = static_cast<FitnessFunction>(7); }),
        BadOptions{"Correlate", "row_step: found 0",
                   [](const Bench& bench) {
                     FitnessOptions options;
                     options.row_step = 0;
                     correlate_point(bench.pair(), options, {80, 60, 10});
                   }},
        bad_evolution("Scouts", "scouts: found 200", [](auto& o) { o.scouts = 200; }),
        bad_evolution("NegativeFlies", "flies: found -5", [](auto& o) { o.flies = -5; }),
        bad_evolution("CrowdingCell", "sharing.cell_px: found 0", [](auto& o) { o.sharing.cell_px = 0; }),
        bad_evolution("NanShare", "keep_share",
                      [](auto& o) { o.keep_share = std::numeric_limits<double>::quiet_NaN(); }),
        bad_evolution("Shares", "add up to", [](auto& o) { o.crossover_share = 0.9; }),
        BadOptions{"FitnessOfEvolution", "row_step: found 0",
                   [](const Bench& bench) {
                     FitnessOptions fitness;
                     fitness.row_step = 0;
                     evolve(bench.pair(), bench.projection, {}, {}, fitness, {}, {});
                   }},
        BadOptions{"PairOfEvolution", "left image",
                   [](const Bench& bench) { evolve({}, bench.projection, {}, {}, {}, {}, {}); }},
        BadOptions{"ScoutAlone", "scouts: found 200",
                   [](const Bench& bench) {
                     scout(Habitat(bench.projection, bench.pair(), {}, {}), 200, {80, 60, 10}, FlyDraws(1, 0, 0, 0));
                   }},
        bad_field("FieldBound", "x_max_m: found 1000", [](auto& f) { f.x_max_m = 1000; }),
        bad_field("FieldEmpty", "is empty", [](auto& f) { f.z_max_m = f.z_min_m; }),
        bad_concentration("Bin", "bin_m: found 0", [](auto& o) { o.bin_m = 0; }),
        bad_concentration("Samples", "samples: found -1", [](auto& o) { o.samples = -1; }),
        bad_concentration("ViewAngle", "view_angle_deg: found 0", [](auto& o) { o.view_angle_deg = 0; }),
        BadOptions{"Histograms", "bin_m: found 0",
                   [](const Bench&) {
                     ConcentrateOptions options;
                     options.bin_m = 0;
                     sample_histograms({}, {}, options);
                   }},
        BadOptions{"MeanShift", "bandwidth_px: found 0",
                   [](const Bench&) {
                     ConcentrateOptions options;
                     options.bandwidth_px = 0;
                     shift_means({}, {}, options);
                   }},
        BadOptions{"Heights", "heights: found 0",
                   [](const Bench& bench) {
                     ProposeOptions options;
                     options.heights = 0;
                     propose_rois({}, {}, bench.projection, {}, kWidth_px, kHeight_px, options);
                   }},
        BadOptions{"Probes", "probes: found -3",
                   [](const Bench& bench) {
                     RoadOptions options;
                     options.probes = -3;
                     estimate_road(bench.pair(), bench.projection, options);
                   }},
        bad_scan("CellRowStep", "cells.row_step: found 0", [](auto& o) { o.cells.row_step = 0; }),
        bad_scan("NearQuantile", "near_quantile: found 1.5", [](auto& o) { o.near_quantile = 1.5; }),
        bad_scan("ScanEmpty", "is empty", [](auto& o) { o.x_min_m = o.x_max_m; }),
        BadOptions{"ScannerOptions", "angle_increment_deg: found 0",
                   [](const Bench& bench) {
                     ScanOptions options;
                     options.angle_increment_deg = 0;
                     Scanner().scan(bench.pair(), bench.projection, {}, {}, {}, options);
                   }},
        BadOptions{"ScanField", "x_max_m: found 1000",
                   [](const Bench& bench) {
                     FieldOptions field;
                     field.x_max_m = 1000;
                     scan(bench.pair(), bench.projection, {}, {}, field, {});
                   }},
        BadOptions{"WholeObstacles", "max_width_m: found 0",
                   [](const Bench& bench) {
                     WholeOptions options;
                     options.max_width_m = 0;
                     whole_obstacles({}, {}, bench.projection, {}, options);
                   }},
        BadOptions{"Tracks", "min_corners: found 0",
                   [](const Bench& bench) {
                     TrackOptions options;
                     options.min_corners = 0;
                     TrackKeeper(bench.camera, options);
                   }},
        BadOptions{"EgoMotion", "hypotheses: found 0",
                   [](const Bench& bench) {
                     EgoOptions options;
                     options.hypotheses = 0;
                     EgoEstimator(bench.camera, options);
                   }},
        BadOptions{"PairOfScore", "right image: size",
                   [](const Bench& bench) { score_point(uneven(bench), {}, {80, 60, 10}); }},
        BadOptions{"PairOfCorrelation", "right image: size",
                   [](const Bench& bench) { correlate_point(uneven(bench), {}, {80, 60, 10}); }},
        BadOptions{"PairOfFlies", "right image: size",
                   [](const Bench& bench) { score_flies(uneven(bench), bench.projection, {}, {}); }},
        BadOptions{"PairOfScan", "right image: size",
                   [](const Bench& bench) { scan(uneven(bench), bench.projection, {}, {}, {}, {}); }},
        BadOptions{"PairOfRoad", "right image: size",
                   [](const Bench& bench) { estimate_road(uneven(bench), bench.projection, {}); }},
        BadOptions{"PairOfEgoMotion", "right image: size",
                   [](const Bench& bench) { EgoEstimator(bench.camera).follow(uneven(bench), 0.0); }},
        BadOptions{"Votes", "votes: found 0",
                   [](const Bench& bench) {
                     ClassifyOptions options;
                     options.votes = 0;
                     find_people(bench.view(), {}, *default_people_classifier(), options);
                   }}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace flies
