// Evaluations of the fitness functions per second on one thread, with the default patch of 13 x 19 pixels:
//   Kernel/<target>/<function>/<sampling>   the sums over a patch, for every instruction set of this CPU
//   ScoreFlies/<function>/<sampling>        score_flies as a whole, for the one that FLIES_TARGET selects
// Compare targets within one run, and medians of repetitions: --benchmark_repetitions=9
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/fitness/kernels/kernel.hpp"

namespace {

using flies::kernels::Kernel;
using flies::kernels::PatchImages;
using flies::kernels::PatchPlace;

constexpr int kWidth_px = 640, kHeight_px = 480;
constexpr int kColumns = 13, kRows = 19;
constexpr std::size_t kEvaluations = 1024;  ///< places of an iteration; all pixels stay in the second level cache

struct NoisePair {
  std::vector<std::uint8_t> left, right;

  NoisePair() : left(std::size_t{kWidth_px} * kHeight_px), right(left.size()) {
    flies::FlyRandom random(11, 0, 0, 0);
    for (auto& pixel : left) pixel = static_cast<std::uint8_t>(random.below(256));
    for (std::size_t i = 0; i < right.size(); ++i)
      right[i] = static_cast<std::uint8_t>((left[(i + 9) % left.size()] * 3 + random.below(256)) / 4);
  }
  flies::RectifiedPair view() const {
    return {{left.data(), kWidth_px, kHeight_px, kWidth_px}, {right.data(), kWidth_px, kHeight_px, kWidth_px}};
  }
};

const NoisePair& noise_pair() {
  static const NoisePair pair;
  return pair;
}

std::vector<PatchPlace> random_places(flies::PatchSampling sampling) {
  flies::FlyRandom random(12, 0, 0, 0);
  std::vector<PatchPlace> places;
  for (std::size_t i = 0; i < kEvaluations; ++i) {
    const auto below = [&](int limit) {
      return static_cast<std::ptrdiff_t>(random.below(static_cast<unsigned>(limit)));
    };
    const std::ptrdiff_t row = below(kHeight_px - kRows) * kWidth_px;
    places.push_back({.left = noise_pair().left.data() + row + below(kWidth_px - kColumns),
                      .right = noise_pair().right.data() + row + below(kWidth_px - kColumns - 1),
                      .fraction16 = sampling == flies::PatchSampling::nearest ? 0 : static_cast<int>(below(16))});
  }
  return places;
}

template <class Result, class Evaluate>
void run(benchmark::State& state, flies::PatchSampling sampling, const Evaluate& evaluate) {
  const auto& [left, right] = noise_pair();
  const PatchImages images = {
      left.data() + left.size(), right.data() + right.size(), kWidth_px, kWidth_px, kColumns, kRows};
  const auto places = random_places(sampling);
  std::vector<Result> results(places.size());
  for (auto _ : state) {
    evaluate(images, places, results.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kEvaluations));
}

void run_kernel(benchmark::State& state, const Kernel& kernel, flies::FitnessFunction function,
                flies::PatchSampling sampling) {
  using enum flies::FitnessFunction;
  if (function == louchet)
    run<std::int64_t>(state, sampling, kernel.sum_squared_differences);
  else if (function == covariance)
    run<float>(state, sampling, kernel.sum_weighted_covariances);
  else
    run<flies::kernels::PatchMoments>(state, sampling, kernel.sum_moments);
}

void run_score_flies(benchmark::State& state, flies::FitnessFunction function, flies::PatchSampling sampling) {
  const flies::StereoCamera camera = {.fx_px = 500,
                                      .fy_px = 500,
                                      .cx_px = kWidth_px / 2.0,
                                      .cx_right_px = kWidth_px / 2.0,
                                      .cy_px = kHeight_px / 2.0,
                                      .baseline_m = 0.5,
                                      .width_px = kWidth_px,
                                      .height_px = kHeight_px,
                                      .mount = {.height_m = 1.0}};
  const flies::Projection projection(camera);
  flies::FitnessOptions options;
  options.function = function;
  options.sampling = sampling;
  options.row_step = 1;
  flies::FlyRandom random(13, 0, 0, 0);
  flies::Population flies;
  for (std::size_t i = 0; i < kEvaluations; ++i) {
    // In view of both cameras with room for the patch, 10 to 40 m ahead.
    const double distance_m = random.uniform(10, 40);
    flies.push_back({distance_m, random.uniform(-0.5, 0.4) * distance_m, 1.0 + random.uniform(-0.4, 0.4) * distance_m});
  }
  std::vector<float> fitness(flies.size());
  tbb::task_arena(1).execute([&] {
    for (auto _ : state) {
      flies::score_flies(noise_pair().view(), projection, options, flies, 0, fitness);
      benchmark::ClobberMemory();
    }
  });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kEvaluations));
}

const bool kRegistered = [] {
  using enum flies::FitnessFunction;
  for (const auto function : {louchet, covariance, correlation})
    for (const auto sampling : {flies::PatchSampling::nearest, flies::PatchSampling::subpixel}) {
      const std::string what = std::string(flies::enum_name(function)) + '/' + std::string(flies::enum_name(sampling));
      for (const Kernel& kernel : flies::kernels::supported_kernels())
        benchmark::RegisterBenchmark(
            ("Kernel/" + std::string(kernel.target) + '/' + what).c_str(),
            [&kernel, function, sampling](benchmark::State& state) { run_kernel(state, kernel, function, sampling); });
      benchmark::RegisterBenchmark(("ScoreFlies/" + what).c_str(), [function, sampling](benchmark::State& state) {
        run_score_flies(state, function, sampling);
      });
    }
  return true;
}();

}  // namespace
