#include "flies/pipeline/engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/usable_pair.hpp"
#include "flies/core/waiting.hpp"

namespace flies {
namespace {

using Clock = std::chrono::steady_clock;

/// A pair that owns its pixels.
struct OwnPair {
  std::vector<std::uint8_t> left, right;
  int width_px = 0, height_px = 0;
  double time_s = 0.0;
  Clock::time_point arrived;

  void copy(const RectifiedPair& pair) {
    width_px = pair.left.width_px;
    height_px = pair.left.height_px;
    copy(pair.left, left);
    copy(pair.right, right);
  }
  RectifiedPair view() const {
    return {{left.data(), width_px, height_px, width_px}, {right.data(), width_px, height_px, width_px}};
  }

 private:
  static void copy(const GrayView& image, std::vector<std::uint8_t>& pixels) {
    const auto width = static_cast<std::size_t>(image.width_px);
    pixels.resize(width * static_cast<std::size_t>(image.height_px));
    for (int v = 0; v < image.height_px; ++v)
      std::memcpy(pixels.data() + static_cast<std::size_t>(v) * width, image.row(v), width);
  }
};

/// How late a reader of all results may be: a quarter of a second at 30 Hz, and some 3 MB.
constexpr std::size_t kKeptResults = 8;

}  // namespace

/// Locks are held to swap pointers and never while images are copied or worked on.
struct Engine::State {
  StereoCamera camera;
  Tracker tracker;

  mutable std::mutex mutex;  ///< of all below
  std::condition_variable pair_came;
  mutable std::condition_variable result_came;
  std::unique_ptr<OwnPair> next;   ///< waits for the worker
  std::unique_ptr<OwnPair> spare;  ///< keeps its memory
  std::shared_ptr<const Snapshot> newest = std::make_shared<Snapshot>();
  std::deque<std::shared_ptr<const Snapshot>> kept;  ///< the newest last
  std::uint64_t submitted = 0, dropped = 0;
  double last_time_s = -std::numeric_limits<double>::infinity();
  bool is_ending = false;

  std::thread worker;  ///< last: it uses all of the above

  State(const StereoCamera& own_camera, const DetectorOptions& detector, const TrackerOptions& options,
        std::shared_ptr<const PeopleClassifier> classifier)
      : camera(own_camera), tracker(own_camera, detector, options, std::move(classifier)) {}

  void run() {
    std::unique_ptr<OwnPair> pair;
    while (true) {
      {
        std::unique_lock lock(mutex);
        if (pair) spare = std::move(pair);
        pair_came.wait(lock, [&] { return is_ending || next; });
        if (is_ending) return;
        pair = std::move(next);
      }
      auto result = std::make_shared<Snapshot>();
      try {
        result->tracking = tracker.process(pair->view(), pair->time_s);
        result->arrived = pair->arrived;
      } catch (const std::exception& error) {
        const auto before = snapshot();
        *result = *before;
        result->error = error.what();
      }
      result->newest_time_s = pair->time_s;
      result->latency_ms = std::chrono::duration<double, std::milli>(Clock::now() - pair->arrived).count();
      {
        const std::lock_guard lock(mutex);
        result->number = newest->number + 1;
        result->submitted = submitted;
        result->dropped = dropped;
        newest = std::move(result);
        kept.push_back(newest);
        if (kept.size() > kKeptResults) kept.pop_front();
      }
      result_came.notify_all();
    }
  }

  std::shared_ptr<const Snapshot> snapshot() const {
    const std::lock_guard lock(mutex);
    return newest;
  }
};

Engine::Engine(const StereoCamera& camera, const DetectorOptions& detector, const TrackerOptions& options,
               std::shared_ptr<const PeopleClassifier> classifier)
    : state_(std::make_unique<State>(camera, detector, options, std::move(classifier))) {
  state_->worker = std::thread([state = state_.get()] { state->run(); });
}

Engine::~Engine() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_ending = true;
  }
  state_->pair_came.notify_all();
  state_->worker.join();
}

bool Engine::submit(const RectifiedPair& given, double time_s) {
  const RectifiedPair pair = detail::usable_pair(given);
  check_camera_fits(state_->camera, pair.left.width_px, pair.left.height_px, "camera");
  std::unique_ptr<OwnPair> own;
  {
    const std::lock_guard lock(state_->mutex);
    own = std::move(state_->spare);
  }
  if (!own) own = std::make_unique<OwnPair>();
  own->copy(pair);
  own->time_s = time_s;
  own->arrived = Clock::now();
  bool is_one_dropped = false;
  {
    const std::lock_guard lock(state_->mutex);
    if (!std::isfinite(time_s)) throw InputError("pair", "time", fmt::format("{} is no time in seconds", time_s));
    if (!(time_s > state_->last_time_s))
      throw InputError("pair", "time",
                       fmt::format("{} s is not later than {} s of the pair before", time_s, state_->last_time_s));
    state_->last_time_s = time_s;
    ++state_->submitted;
    is_one_dropped = state_->next != nullptr;
    if (is_one_dropped) {
      ++state_->dropped;
      state_->spare = std::move(state_->next);
    }
    state_->next = std::move(own);
  }
  state_->pair_came.notify_one();
  return is_one_dropped;
}

std::shared_ptr<const Snapshot> Engine::snapshot() const { return state_->snapshot(); }

std::shared_ptr<const Snapshot> Engine::wait(std::uint64_t after, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(state_->mutex);
  state_->result_came.wait_for(lock, detail::bounded_wait(timeout), [&] { return state_->newest->number > after; });
  return state_->newest;
}

std::shared_ptr<const Snapshot> Engine::wait_for_next(std::uint64_t after, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(state_->mutex);
  state_->result_came.wait_for(lock, detail::bounded_wait(timeout), [&] { return state_->newest->number > after; });
  const auto next = std::ranges::find_if(state_->kept, [&](const auto& result) { return result->number > after; });
  return next == state_->kept.end() ? state_->newest : *next;
}

}  // namespace flies
