// The thread of a `LiveRun` that hands results to the sinks.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "live/live_run.hpp"

namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();  // below it are the numbers of all pairs

}  // namespace

GroundPose moved(const GroundPose& pose, const flies::EgoMotion& ego) {
  if (!ego.is_known) return {.segment = pose.segment + 1};
  const flies::RigidMotion motion = ego.current_from_previous.inverse();  // of the vehicle
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  return {.x_m = pose.x_m + c * motion.shift.x_m - s * motion.shift.y_m,
          .y_m = pose.y_m + s * motion.shift.x_m + c * motion.shift.y_m,
          .yaw_rad = pose.yaw_rad + std::atan2(motion.rotation[1][0], motion.rotation[0][0]),
          .segment = pose.segment};
}

std::shared_ptr<const LivePair> LiveRun::pair_at(double time_s) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(recent_, time_s, [](const auto& pair) { return pair->time_s; });
  return found == recent_.end() ? nullptr : *found;
}

std::shared_ptr<const LiveRun::Worker> LiveRun::worker_unless_ending() {
  const std::lock_guard lock(mutex_);
  return is_ending_ ? nullptr : worker_;
}

void LiveRun::go_on_with(std::shared_ptr<const Worker> worker) {
  dropped_before_ = worker->submitted_before - results_;
  ids_before_ = highest_id_;
  last_result_ = last_dropped_ = 0;
  handing_worker_ = std::move(worker);
}

/// A result as if there had been one engine all along: no number is given to two tracks.
std::shared_ptr<const flies::Snapshot> LiveRun::continued(
    const std::shared_ptr<const flies::Snapshot>& snapshot) const {
  if (ids_before_ == 0) return snapshot;
  auto result = std::make_shared<flies::Snapshot>(*snapshot);
  for (auto& track : result->tracking.tracks) track.id += ids_before_;
  return result;
}

LiveFrame LiveRun::frame_of(std::shared_ptr<const LivePair> pair,
                            std::shared_ptr<const flies::Snapshot> snapshot) const {
  const std::uint64_t dropped = dropped_before_ + overtaken_ + snapshot->dropped;
  return {.pair = std::move(pair),
          .snapshot = std::move(snapshot),
          .camera = handing_worker_->camera,
          .pose = pose_,
          .dropped = dropped,
          .options = handing_worker_->options,
          .following = handing_worker_->following,
          .preset = handing_worker_->preset,
          .run = handing_worker_->record,
          .diagnosis = handing_worker_->diagnosis,
          .began_ns = began_ns_};
}

/// Under `mutex_`. @returns the number of the oldest pair whose result may still come; more than all if there is none
std::uint64_t LiveRun::oldest_awaited() const {
  const auto oldest = std::ranges::find_if(recent_, [&](const auto& pair) { return pair->number >= awaited_from_; });
  return oldest == recent_.end() ? kAll : (*oldest)->number;
}

/// Pairs that no worker got and whose number is below this one, so that numbers grow.
/// @param before nothing: below those whose result may still come
void LiveRun::hand_on_passed_over(std::optional<std::uint64_t> before) {
  std::vector<PassedOver> passed_over;
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t limit = before ? *before : oldest_awaited();
    const auto end = std::ranges::find_if(passed_over_, [&](const auto& one) { return one.pair->number >= limit; });
    passed_over.assign(passed_over_.begin(), end);
    passed_over_.erase(passed_over_.begin(), end);
  }
  for (const auto& [pair, fault] : passed_over) pass_over(pair, fault);
}

void LiveRun::pass_over(const std::shared_ptr<const LivePair>& pair, const std::string& fault) {
  auto snapshot = std::make_shared<flies::Snapshot>();
  snapshot->tracking.time_s = pair->time_s;
  snapshot->dropped = last_dropped_;
  snapshot->error = fault;
  const LiveFrame frame = frame_of(pair, std::move(snapshot));
  for (LiveSink* sink : sinks_) sink->pass_over(frame);
}

void LiveRun::take(const std::shared_ptr<const LivePair>& pair,
                   const std::shared_ptr<const flies::Snapshot>& snapshot) {
  shift_watch_.look(snapshot->tracking.ego);
  if (const auto note = shift_watch_.first_note(handing_worker_->camera); !note.empty()) say(note);
  pose_ = moved(pose_, snapshot->tracking.ego);
  for (const auto& track : snapshot->tracking.tracks) highest_id_ = std::max(highest_id_, track.id);
  const LiveFrame frame = frame_of(pair, snapshot);
  for (LiveSink* sink : sinks_) sink->take(frame);
}

void LiveRun::hand_on_results() {
  const auto result = handing_worker_->engine->wait_for_next(last_result_, 50ms);
  if (result->number == last_result_) return hand_on_passed_over(std::nullopt);
  overtaken_ += result->number - last_result_ - 1;
  const auto snapshot = continued(result);
  results_ += snapshot->number - last_result_;
  last_result_ = snapshot->number;
  last_dropped_ = snapshot->dropped;
  const bool is_refused = !snapshot->error.empty();
  const auto pair = pair_at(snapshot->newest_time_s);
  if (is_refused && first_refusal_.empty()) {
    first_refusal_ = snapshot->error;
    say(pair ? fmt::format("{}: {}", pair->left_name, snapshot->error) : snapshot->error);
  }
  has_results_ = has_results_ || !is_refused;
  if (pair) {
    hand_on_passed_over(pair->number);
    if (is_refused)
      pass_over(pair, snapshot->error);
    else
      take(pair, snapshot);
  }
  const std::lock_guard lock(mutex_);
  if (pair) awaited_from_ = std::max(awaited_from_, pair->number + 1);
  while (pair && recent_.size() > 1 && recent_.front()->number < pair->number) recent_.erase(recent_.begin());
  if (handing_worker_ == worker_) handed_on_ = last_result_;
  changed_.notify_all();
}

/// The thread that hands results to the sinks.
void LiveRun::hand_on() {
  try {
    while (auto worker = worker_unless_ending()) {
      if (worker != handing_worker_) go_on_with(std::move(worker));
      hand_on_results();
    }
    if (handing_worker_) hand_on_passed_over(kAll);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}
