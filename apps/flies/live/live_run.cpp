#include "live/live_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/diagnose/calibrated_pair.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"

namespace {

using namespace std::chrono_literals;
using Answer = flies::FrameStream::Answer;

constexpr std::size_t kRecentPairs = 16;  // an engine holds two, one in work and one that waits, and eight results

flies::DetectorOptions with_option(flies::DetectorOptions options, const std::string& path, const std::string& text) {
  flies::set_option(options, path, text, "options");
  flies::check_detector_options(options, "options");
  return options;
}

}  // namespace

LiveRun::LiveRun(LiveRequest request, std::vector<LiveSink*> sinks)
    : request_(std::move(request)),
      sinks_(std::move(sinks)),
      options_(effective_options(request_.method)),
      preset_(preset_name(options_)),
      following_(request_.following) {
  // Times of pairs count from the moment at which the stream is made.
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  began_ns_ = static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
  stream_ =
      std::make_unique<flies::PairStream>(request_.stream, [this](const std::string& sentence) { say(sentence); });
  if (request_.stream.is_patient && stream_->is_living())
    say("--every-pair is for films and folders: a living source does not wait, so pairs may be left out");
}

LiveRun::~LiveRun() = default;

void LiveRun::say(const std::string& sentence) {
  say_notes({sentence});
  for (LiveSink* sink : sinks_) sink->note(sentence);
}

/// Pictures that came during a pause count as skipped.
flies::PairStreamCounts LiveRun::counted() const {
  auto counts = stream_->counts();
  counts.skipped += passed_while_paused_;
  return counts;
}

/// @returns false when the run is over
bool LiveRun::wait_for_pair(flies::StereoFrame& frame) {
  while (!is_end_requested()) {
    {
      std::unique_lock lock(mutex_);
      source_counts_ = counted();
      // A living source is read on while paused, so that a step shows what is there then.
      if (is_paused_ && steps_ == 0) {
        changed_.wait_for(lock, 20ms);
        lock.unlock();
        rethrow_failure();
        if (!stream_->is_living()) continue;
        const Answer answer = stream_->next(frame, 0ms);
        if (answer == Answer::ended) return false;
        if (answer == Answer::frame) passed_while_paused_ += request_.stream.sources.size();  // pictures
        continue;
      }
    }
    const Answer answer = stream_->next(frame, 100ms);
    rethrow_failure();
    if (answer == Answer::ended) return false;
    if (answer == Answer::nothing_yet) continue;
    flies::stretch_faint(frame.images);
    const std::lock_guard lock(mutex_);
    if (steps_ > 0) --steps_;
    return true;
  }
  return false;
}

std::shared_ptr<const LiveRun::Worker> LiveRun::new_worker(const flies::DetectorOptions& options,
                                                           const std::string& preset,
                                                           const flies::TrackerOptions& following,
                                                           std::uint64_t submitted_before) const {
  const auto& camera = calibration_->camera;
  auto worker = std::make_shared<Worker>();
  worker->engine = std::make_unique<flies::Engine>(camera, options, following, request_.classifier);
  worker->options = std::make_shared<const flies::DetectorOptions>(options);
  worker->following = std::make_shared<const flies::TrackerOptions>(following);
  worker->preset = preset;
  worker->record = run_record({.method = request_.method,
                               .camera = request_.camera,
                               .corrections = request_.corrections,
                               .reading = request_.stream.reading},
                              options, following, camera, request_.calib, diagnosis_);
  worker->camera = camera;
  if (auto record = diagnosis_.record())
    worker->diagnosis = std::make_shared<const flies::DiagnosisRecord>(*std::move(record));
  worker->submitted_before = submitted_before;
  return worker;
}

std::shared_ptr<LivePair> LiveRun::prepare(flies::StereoFrame frame) {
  auto pair = std::make_shared<LivePair>();
  pair->number = next_number_++;
  pair->images = calibration_->rectifier ? calibration_->rectifier->rectify(frame.images) : std::move(frame.images);
  if (later_) diagnose_later(pair->images, frame.time_s);
  diagnosis_.correct(pair->images);
  pair->time_s = frame.time_s;
  pair->skew_s = frame.skew_s;
  pair->skipped = frame.skipped + passed_while_paused_;
  pair->left_name = std::move(frame.left_name);
  pair->right_name = std::move(frame.right_name);
  return pair;
}

/// @param number of the pair that comes next: of those before, none gets a result any more
void LiveRun::renew_worker_if_asked(std::uint64_t number) {
  std::unique_lock lock(mutex_);
  if (!std::exchange(options_changed_, false)) return;
  const auto options = options_;
  const auto preset = preset_;
  const auto following = following_;
  lock.unlock();
  auto worker = new_worker(options, preset, following, submitted_);
  lock.lock();
  std::swap(worker_, worker);
  handed_on_ = 0;
  awaited_from_ = number;
  lock.unlock();  // the old engine ends outside of the lock
}

/// Looks at a pair and tells what is met for the first time.
/// @returns why nothing is to be looked for in it; empty where it is a pair
std::string LiveRun::fault_of(const LivePair& pair) {
  const flies::RectifiedPair images = pair.images.view();
  const auto& camera = calibration_->camera;
  std::shared_ptr<const Worker> worker;
  {
    const std::lock_guard lock(mutex_);
    worker = worker_;
  }
  const flies::NearEnd near_end{nearest_range_m(*worker->options), worker->preset};
  for (const auto& note : watch_.look(images, camera, pair.left_name, near_end)) say(note);
  if (!watch_.is_no_pair()) return {};
  try {
    flies::check_calibrated_pair(images, *calibration_, {}, pair.left_name, pair.right_name);
  } catch (const flies::InputError& fault) {
    return fault.what();
  }
  return {};
}

/// The engine has dropped the pair that was submitted before this one.
void LiveRun::forget_the_one_before(const LivePair& pair) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(recent_, pair.number, [](const auto& one) { return one->number; });
  if (found != recent_.begin() && found != recent_.end()) recent_.erase(std::prev(found));
}

/// @param is_awaited no pair may overtake this one
void LiveRun::submit(std::shared_ptr<LivePair> pair, bool is_awaited) {
  renew_worker_if_asked(pair->number);
  if (auto fault = fault_of(*pair); !fault.empty()) {
    const std::lock_guard lock(mutex_);
    passed_over_.push_back({std::move(pair), std::move(fault)});
    return;
  }
  std::shared_ptr<const Worker> worker;
  std::uint64_t before = 0;
  {
    const std::lock_guard lock(mutex_);
    worker = worker_;
    before = handed_on_;
    recent_.push_back(pair);
    if (recent_.size() > kRecentPairs) recent_.erase(recent_.begin());
  }
  if (worker->engine->submit(pair->images.view(), pair->time_s)) forget_the_one_before(*pair);
  ++submitted_;
  if (!is_awaited) return;
  std::unique_lock lock(mutex_);
  while (handed_on_ <= before && !failure_ && !is_end_requested()) changed_.wait_for(lock, 100ms);
}

void LiveRun::rethrow_failure() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

/// Lets the engine finish the last pair.
void LiveRun::finish() {
  const auto until = std::chrono::steady_clock::now() + 5s;
  std::unique_lock lock(mutex_);
  while (!failure_ && std::chrono::steady_clock::now() < until) {
    const auto snapshot = worker_->engine->snapshot();
    const bool is_done =
        snapshot->number == handed_on_ && !recent_.empty() && snapshot->newest_time_s >= recent_.back()->time_s;
    if (is_done) break;
    changed_.wait_for(lock, 20ms);
  }
}

/// After the run. @throws flies::InputError when the source ended and the engine refused all pairs that it got
void LiveRun::check_that_pairs_were_used() const {
  if (has_results_ || first_refusal_.empty() || is_end_requested()) return;
  const auto& stream = request_.stream;
  throw flies::InputError(stream.folder.empty() ? stream.sources.front() : stream.folder.front().left, "",
                          "no pair could be used; the first error: " + first_refusal_);
}

void LiveRun::run() {
  std::vector<flies::StereoFrame> first;
  if (!begin(first)) return;
  std::thread handing([this] { hand_on(); });
  const auto end = [&] {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    handing.join();
  };
  try {
    for (auto& one : first) submit(prepare(std::move(one)), true);
    flies::StereoFrame frame;
    while ((request_.max_pairs == 0 || next_number_ < request_.max_pairs) && wait_for_pair(frame))
      submit(prepare(std::move(frame)), request_.stream.is_patient);
    finish();
  } catch (...) {
    end();
    throw;
  }
  end();
  rethrow_failure();
  for (const auto& note : watch_.counts()) say(note);
  check_that_pairs_were_used();
  const std::lock_guard lock(mutex_);
  source_counts_ = counted();
}

void LiveRun::pause(bool is_paused) {
  const std::lock_guard lock(mutex_);
  is_paused_ = is_paused;
  steps_ = 0;
  changed_.notify_all();
}

void LiveRun::step() {
  const std::lock_guard lock(mutex_);
  if (is_paused_) ++steps_;
  changed_.notify_all();
}

bool LiveRun::is_paused() const {
  const std::lock_guard lock(mutex_);
  return is_paused_;
}

void LiveRun::set_option(const std::string& path, const std::string& text) {
  if (path == "threads")
    throw flies::InputError("options", path, "cannot be changed while flies runs; give it at the start");
  const std::lock_guard lock(mutex_);
  if (flies::is_tracker_option(path)) {
    flies::set_option(following_, path, text, "options");
  } else {
    options_ = with_option(options_, path, text);
    const auto set = std::ranges::find(settings_, path, &Overrides::value_type::first);
    if (set == settings_.end())
      settings_.emplace_back(path, text);
    else
      set->second = text;
    preset_ = "custom";
  }
  options_changed_ = true;
}

flies::DetectorOptions LiveRun::options() const {
  const std::lock_guard lock(mutex_);
  return options_;
}

flies::TrackerOptions LiveRun::following() const {
  const std::lock_guard lock(mutex_);
  return following_;
}

flies::PairStreamCounts LiveRun::source_counts() const {
  const std::lock_guard lock(mutex_);
  return source_counts_;
}
