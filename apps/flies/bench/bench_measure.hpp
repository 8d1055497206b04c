#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"

/// Times of repeated runs, milliseconds.
struct Times {
  double median_ms = 0.0, first_quartile_ms = 0.0, third_quartile_ms = 0.0;
};

/// The method with one preset and number of threads. `work` is evolve and concentrate together, the part that the paper
/// times as well.
struct FrameTimes {
  std::string preset;
  int threads = 1;
  std::size_t evaluations = 0;  ///< of the fitness, in the last run
  Times frame, work;
  std::array<Times, flies::kStageCount> stages;
};

/// Another program's work on the same pair, one thread.
struct OtherTimes {
  std::string name;
  Times frame;
};

/// Evolve and concentrate, preset `default`, one thread, as something grows.
struct GrowthTimes {
  int flies = 0;
  int width_px = 0, height_px = 0;
  Times work;
};

struct BenchResult {
  std::vector<FrameTimes> frames;
  std::vector<OtherTimes> others;
  std::vector<GrowthTimes> by_flies, by_pixels;
};

struct BenchPlan {
  int runs = 15;           ///< of everything, in turns, so that a busy machine slows all alike
  bool has_others = true;  ///< OpenCV's dense matching and full-image HOG
  bool has_growth = true;  ///< over flies and over pixels
};

/// Measures on a pair in memory. Two rounds before the first one that counts warm everything up.
/// @throws flies::InputError when the pair does not fit the camera
BenchResult run_bench(const flies::RectifiedPair& pair, const flies::StereoCamera& camera, const BenchPlan& plan);
