#include "flies/pipeline/detector.hpp"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/pair_check.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/pipeline/ghosts.hpp"

namespace flies {
namespace {

/// Adds how long its life took, in milliseconds.
class Stopwatch {
 public:
  Stopwatch(StageTimes_ms& stage_ms, Stage stage) : total_ms_(stage_ms[static_cast<std::size_t>(stage)]) {}
  ~Stopwatch() { total_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_ms_;
  Clock::time_point start_ = Clock::now();
};

/// Runs something and adds how long it took.
template <class Run>
auto timed(StageTimes_ms& stage_ms, Stage stage, const Run& run) {
  const Stopwatch watch(stage_ms, stage);
  return run();
}

/// Work that another of the arena's threads does while this one goes on; this one does it when it waits for it and no
/// other had time. It is waited for in any case.
class Meanwhile {
 public:
  template <class Run>
  explicit Meanwhile(const Run& run) {
    group_.run(run);
  }
  ~Meanwhile() {
    try {
      group_.wait();
    } catch (...) {  // what `wait` would have thrown, had it come to that
    }
  }
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

  void wait() { group_.wait(); }

 private:
  tbb::task_group group_;
};

/// Where somebody seen in the pair before stands now, had he stood still: the boxes beside allow for a step.
Obstacle where_now(const Pedestrian& person, const PlanarMotion& moved) {
  constexpr double kWidth_m = 0.5;
  const Point3 now = moved.now({person.x_m, person.y_m, 0.0});
  Obstacle place;
  place.x_m = now.x_m;
  place.y_m = now.y_m;
  place.range_m = std::hypot(now.x_m, now.y_m);
  place.width_m = kWidth_m;
  place.height_m = person.height_m;
  return place;
}

/// Calls `run` without taking up, while it waits for its own loops, what was started beside it.
template <class Run>
auto undistracted(const Run& run) {
  return tbb::this_task_arena::isolate(run);
}

}  // namespace

/// Kept from pair to pair: workers that had to be called together anew would come late to a pair of some milliseconds.
struct Detector::Workers {
  tbb::task_arena arena;
};

Detector::Detector(const StereoCamera& camera, const DetectorOptions& options,
                   std::shared_ptr<const PeopleClassifier> classifier)
    : camera_(camera),
      projection_(camera),
      options_(options),
      classifier_(std::move(classifier)),
      workers_(new Workers{tbb::task_arena(options.threads == 0 ? tbb::task_arena::automatic : options.threads)}) {
  check_camera(camera_, "camera");
  check_detector_options(options_, "options");
}

Detection Detector::process(const RectifiedPair& pair, const std::optional<PlanarMotion>& motion) {
  return process(pair, motion ? [&] { return motion; } : MotionSource());
}

Detection Detector::process(const RectifiedPair& given, const MotionSource& motion) {
  [[maybe_unused]] const detail::OneAtATime::Use use(one_at_a_time_);
  if (!workers_) throw std::logic_error("this detector was moved from and cannot be used");
  const RectifiedPair pair = detail::usable_pair(given);
  check_camera_fits(camera_, pair.left.width_px, pair.left.height_px, "camera");
  if (detail::is_one_image_twice(pair))
    throw InputError("right image", "pixels", "not a pair: it is identical to the left image");
  // Refused pairs do not count: after one that is swapped, every pair is asked until one is not.
  constexpr std::uint32_t kAskedEvery = 32;
  if (frame_ % kAskedEvery == 0) check_not_swapped(pair, camera_, "left image", "right image");
  auto detection = workers_->arena.execute([&] { return detect(pair, motion); });
  last_obstacles_ = detection.concentrate.obstacles;
  last_pedestrians_ = detection.pedestrians;
  ++frame_;
  return detection;
}

DetectionSummary Detector::find(const RectifiedPair& pair, const std::optional<PlanarMotion>& motion) {
  return process(pair, motion);
}

void Detector::reset() {
  [[maybe_unused]] const detail::OneAtATime::Use use(one_at_a_time_);
  evolver_ = {};
  scanner_ = {};
  concentrator_ = {};
  last_obstacles_.clear();
  last_pedestrians_.clear();
  frame_ = 0;
}

Detection Detector::detect(const RectifiedPair& pair, const MotionSource& motion) {
  Detection d;
  const auto moved = find_obstacles(pair, motion, d);
  find_pedestrians(pair, moved, d);
  for (auto& obstacle : d.obstacles) obstacle.range_sd_m = range_deviation_m(camera_, obstacle.range_m);
  for (auto& pedestrian : d.pedestrians) pedestrian.range_sd_m = range_deviation_m(camera_, pedestrian.range_m);
  return d;
}

std::optional<PlanarMotion> Detector::find_obstacles(const RectifiedPair& pair, const MotionSource& source,
                                                     Detection& d) {
  d.road = timed(d.stage_ms, Stage::road, [&] { return estimate_road(pair, projection_, options_.road); });
  const RoadPlane& road = d.road.plane;
  const FieldOptions field = detail::lived_in(options_.field, camera_);
  EvolveOptions evolve = options_.evolve;
  evolve.flies = detail::flies_in(field, options_.field, evolve.flies);
  const auto look = [&](const Population& flies) {
    timed(d.stage_ms, Stage::scan,
          [&] { scanner_.look(pair, projection_, road, flies, options_.field, options_.scan); });
  };
  const bool scan_asks_flies = options_.scan.evidence.fly > 0.0;
  Meanwhile flies([&] {
    d.evolved = timed(d.stage_ms, Stage::evolve, [&] {
      return undistracted([&] {
        return evolver_.evolve(pair, projection_, road, field, options_.fitness, evolve, {options_.seed, frame_},
                               last_obstacles_);
      });
    });
    d.concentrate = timed(d.stage_ms, Stage::concentrate, [&] {
      return undistracted(
          [&] { return concentrator_.concentrate(d.evolved.flies, projection_, road, field, options_.concentrate); });
    });
    if (scan_asks_flies) look(d.evolved.flies);
  });
  Meanwhile cells([&] {
    if (!scan_asks_flies) look({});
  });
  // What takes longest begins at once: this thread runs already, another may be late.
  const std::optional<PlanarMotion> motion = source ? source() : std::nullopt;
  cells.wait();
  flies.wait();
  d.scan = timed(d.stage_ms, Stage::scan,
                 [&] { return scanner_.decide(pair, projection_, road, options_.field, options_.scan, motion); });
  const auto is_ghost = [&](const Obstacle& obstacle) {
    return obstacle.x_m > options_.field.x_max_m || detail::is_seen_through(obstacle, d.scan);
  };
  detail::drop(is_ghost, d.concentrate);
  d.obstacles = timed(d.stage_ms, Stage::concentrate, [&] {
    return whole_obstacles(d.concentrate.obstacles, d.scan, projection_, road, options_.concentrate.whole);
  });
  return motion;
}

void Detector::find_pedestrians(const RectifiedPair& pair, const std::optional<PlanarMotion>& moved,
                                Detection& d) const {
  d.rois = timed(d.stage_ms, Stage::propose, [&] {
    std::vector<Obstacle> places = d.concentrate.obstacles;
    if (moved)
      for (const Pedestrian& person : last_pedestrians_) places.push_back(where_now(person, *moved));
    return propose_rois(places, d.scan, projection_, d.road.plane, pair.left.width_px, pair.left.height_px,
                        classifier_ ? for_classifier(options_.propose, *classifier_) : options_.propose);
  });
  d.pedestrians = timed(d.stage_ms, Stage::classify, [&] {
    if (!classifier_) {
      d.roi_scores.assign(d.rois.size(), 0.0);
      return std::vector<Pedestrian>();
    }
    ClassifyResult people = find_people(pair.left, d.rois, *classifier_, options_.classify);
    d.roi_scores = std::move(people.screened);
    return std::move(people.pedestrians);
  });
}

}  // namespace flies
