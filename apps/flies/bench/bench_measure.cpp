#include "bench/bench_measure.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <utility>

#include "flies/core/mat_view.hpp"
#include "flies/core/quantile.hpp"
#include "flies/pipeline/detector.hpp"

namespace {

using flies::Stage;

constexpr int kWarmUpRuns = 2;
constexpr int kDisparities = 128;
constexpr int kBlock_px = 5;  ///< of the semi-global matchers, with penalties 8 and 32 per pixel of it
constexpr int kMostFlies = 300000;
/// Pairs that a detector sees in a row before the next contestant's turn, as those of a camera follow each other.
constexpr int kPairsInARow = 5;

constexpr int kGrowthRuns = 5;  ///< at most; the largest population takes a while

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// @param times not empty
Times summary(const std::vector<double>& times) {
  return {*flies::median(times), flies::quantile(times, 0.25), flies::quantile(times, 0.75)};
}

double work_ms(const flies::Detection& found) {
  return found.stage_ms[static_cast<std::size_t>(Stage::evolve)] +
         found.stage_ms[static_cast<std::size_t>(Stage::concentrate)];
}

/// A detector and the times of its runs.
class FrameBench {
 public:
  FrameBench(const flies::StereoCamera& camera, flies::Preset preset, int threads)
      : preset_(preset), threads_(threads), detector_(camera, options_of(preset, threads)) {}

  void run(const flies::RectifiedPair& pair, bool counts) {
    for (int i = 0; i < kPairsInARow; ++i) run_once(pair, counts);
  }
  FrameTimes times() const {
    FrameTimes times{.preset = std::string(flies::enum_name(preset_)),
                     .threads = threads_,
                     .evaluations = evaluations_,
                     .frame = summary(frame_ms_),
                     .work = summary(work_ms_),
                     .stages = {}};
    for (std::size_t i = 0; i < flies::kStageCount; ++i) times.stages[i] = summary(stage_ms_[i]);
    return times;
  }

 private:
  void run_once(const flies::RectifiedPair& pair, bool counts) {
    flies::Detection found;
    const double frame_ms = milliseconds([&] { found = detector_.process(pair); });
    evaluations_ = found.evolved.evaluations;
    if (!counts) return;
    frame_ms_.push_back(frame_ms);
    work_ms_.push_back(work_ms(found));
    for (std::size_t i = 0; i < flies::kStageCount; ++i) stage_ms_[i].push_back(found.stage_ms[i]);
  }
  static flies::DetectorOptions options_of(flies::Preset preset, int threads) {
    auto options = flies::preset_options(preset);
    options.threads = threads;
    return options;
  }

  flies::Preset preset_;
  int threads_;
  flies::Detector detector_;
  std::size_t evaluations_ = 0;
  std::vector<double> frame_ms_, work_ms_;
  std::array<std::vector<double>, flies::kStageCount> stage_ms_;
};

/// Something of OpenCV's and the times of its runs.
struct OtherBench {
  std::string name;
  std::function<void()> run;
  std::vector<double> frame_ms;
};

std::vector<OtherBench> other_benches(const cv::Mat& left, const cv::Mat& right) {
  const auto matching = [&](const cv::Ptr<cv::StereoMatcher>& matcher) {
    return [left, right, matcher] {
      cv::Mat disparity;
      matcher->compute(left, right, disparity);
    };
  };
  const auto sgbm = [](int mode) {
    constexpr int kPixels = kBlock_px * kBlock_px;
    return cv::StereoSGBM::create(0, kDisparities, kBlock_px, 8 * kPixels, 32 * kPixels, 1, 63, 10, 100, 2, mode);
  };
  const auto hog = std::make_shared<cv::HOGDescriptor>();
  hog->setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  return {{"StereoBM", matching(cv::StereoBM::create(kDisparities, 15)), {}},
          {"SGBM 3-way", matching(sgbm(cv::StereoSGBM::MODE_SGBM_3WAY)), {}},
          {"SGBM", matching(sgbm(cv::StereoSGBM::MODE_SGBM)), {}},
          {"HOG, whole image",
           [left, hog] {
             std::vector<cv::Rect> found;
             hog->detectMultiScale(left, found);
           },
           {}}};
}

/// Evolve and concentrate only: what else a frame holds does not grow with the flies.
class GrowthBench {
 public:
  GrowthBench(const flies::RectifiedPair& pair, const flies::StereoCamera& camera, int flies)
      : pair_(pair), flies_(flies), detector_(camera, options_of(flies)) {}

  void run(bool counts) {
    for (int i = 0; i < kPairsInARow; ++i) {
      const auto found = detector_.process(pair_);
      if (counts) work_ms_.push_back(work_ms(found));
    }
  }
  GrowthTimes times() const { return {flies_, pair_.left.width_px, pair_.left.height_px, summary(work_ms_)}; }

 private:
  static flies::DetectorOptions options_of(int flies) {
    flies::DetectorOptions options;
    options.evolve.flies = flies;
    return options;
  }

  flies::RectifiedPair pair_;
  int flies_;
  flies::Detector detector_;
  std::vector<double> work_ms_;
};

/// The benches in turns.
std::vector<GrowthTimes> grow(std::vector<GrowthBench> benches, int runs) {
  for (int run = -1; run < runs; ++run)
    for (auto& bench : benches) bench.run(run >= 0);
  std::vector<GrowthTimes> times;
  for (const auto& bench : benches) times.push_back(bench.times());
  return times;
}

/// The camera of a pair resized to twice the width and height.
flies::StereoCamera enlarged(flies::StereoCamera camera) {
  const auto centre = [](double& c_px) { c_px = 2.0 * c_px + 0.5; };  // pixel centres are at whole numbers
  camera.fx_px *= 2.0;
  camera.fy_px *= 2.0;
  centre(camera.cx_px);
  centre(camera.cx_right_px);
  centre(camera.cy_px);
  camera.width_px *= 2;
  camera.height_px *= 2;
  return camera;
}

cv::Mat enlarged(const cv::Mat& image) {
  cv::Mat larger;
  cv::resize(image, larger, {}, 2.0, 2.0, cv::INTER_CUBIC);
  return larger;
}

}  // namespace

BenchResult run_bench(const flies::RectifiedPair& pair, const flies::StereoCamera& camera, const BenchPlan& plan) {
  cv::setNumThreads(1);
  const cv::Mat left = flies::mat_of(pair.left), right = flies::mat_of(pair.right);

  std::vector<std::unique_ptr<FrameBench>> frames;
  for (const auto preset : {flies::Preset::standard, flies::Preset::paper})
    for (const int threads : {1, 2}) frames.push_back(std::make_unique<FrameBench>(camera, preset, threads));
  auto others = plan.has_others ? other_benches(left, right) : std::vector<OtherBench>{};
  for (int run = -kWarmUpRuns; run < plan.runs; ++run) {
    for (const auto& frame : frames) frame->run(pair, run >= 0);
    for (auto& other : others) {
      if (run + 1 < 0) continue;  // the first of the warming rounds is for what is quick
      const double frame_ms = milliseconds(other.run);
      if (run >= 0) other.frame_ms.push_back(frame_ms);
    }
  }

  BenchResult result;
  for (const auto& frame : frames) result.frames.push_back(frame->times());
  for (const auto& other : others) result.others.push_back({other.name, summary(other.frame_ms)});
  if (!plan.has_growth) return result;

  const int growth_runs = std::min(plan.runs, kGrowthRuns);
  std::vector<GrowthBench> by_flies;
  for (int flies = kMostFlies / 100; flies <= kMostFlies; flies *= 10) by_flies.emplace_back(pair, camera, flies);
  result.by_flies = grow(std::move(by_flies), growth_runs);

  const cv::Mat larger_left = enlarged(left), larger_right = enlarged(right);
  const int flies = flies::DetectorOptions().evolve.flies;
  std::vector<GrowthBench> by_pixels;
  by_pixels.emplace_back(pair, camera, flies);
  by_pixels.emplace_back(flies::view_of(larger_left, larger_right), enlarged(camera), flies);
  result.by_pixels = grow(std::move(by_pixels), plan.runs);
  return result;
}
