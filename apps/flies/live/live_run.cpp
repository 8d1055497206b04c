#include "live/live_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <thread>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/pair_check.hpp"
#include "flies/io/mosaic.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"
#include "shared/pair_arguments.hpp"

namespace {

using namespace std::chrono_literals;
using Answer = flies::FrameStream::Answer;

constexpr std::size_t kPairsToDiagnose = 5;
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
        const bool is_living =
            request_.stream.folder.empty() && flies::is_living(flies::source_kind(request_.stream.sources.front()));
        if (!is_living) continue;
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

void LiveRun::calibrate(const flies::StereoFrame& frame) {
  try {
    fit_calibration(frame);
  } catch (const flies::InputError&) {
    check_not_halved(frame);
    throw;
  }
}

/// The pictures of one source are halved, also where each is but one of the two.
/// @throws flies::InputError where they, as wholes, have the size that the calibration is for
void LiveRun::check_not_halved(const flies::StereoFrame& frame) const {
  constexpr int kCutOff_px = 2;                  // films have even sides
  constexpr double kMiddle = 0.1, kAside = 0.2;  // of the size: a principal point
  if (!request_.stream.folder.empty() || request_.stream.sources.size() != 1) return;
  const auto view = frame.images.view();
  const bool is_top_bottom = request_.stream.layout == flies::PairLayout::top_bottom;
  const int width_px = view.left.width_px * (is_top_bottom ? 1 : 2);
  const int height_px = view.left.height_px * (is_top_bottom ? 2 : 1);
  auto request = calibration_request(request_.camera, frame.left_name, frame.right_name, view);
  request.width_px = request.height_px = 0;
  flies::StereoCamera camera;
  try {
    camera = flies::load_calibration(request_.calib, request).camera;
  } catch (const flies::InputError&) {  // the fault of the halves is told
    return;
  }
  const auto offset = [&](int width, int height) {
    return std::max(std::abs(camera.cx_px / width - 0.5), std::abs(camera.cy_px / height - 0.5));
  };
  const bool has_size = camera.width_px > 0 && camera.height_px > 0;
  const bool is_for_wholes =
      has_size
          ? std::abs(camera.width_px - width_px) <= kCutOff_px && std::abs(camera.height_px - height_px) <= kCutOff_px
          : offset(width_px, height_px) < kMiddle && offset(view.left.width_px, view.left.height_px) > kAside;
  if (!is_for_wholes) return;
  throw flies::InputError(
      request_.stream.sources.front(), "image size",
      fmt::format("a whole picture has {} x {} px, for which the calibration is; expected the left and the right "
                  "picture in each, side by side or one above the other (--split), or a second source with the right "
                  "pictures",
                  width_px, height_px));
}

/// @throws flies::InputError when the file cannot be read, or does not go with this pair
void LiveRun::fit_calibration(const flies::StereoFrame& frame) {
  if (!request_.stream.folder.empty())
    if (const auto note = orientation_note({frame.left_name, frame.right_name})) say(*note);
  const flies::RectifiedPair view = frame.images.view();
  calibration_ = flies::load_calibration(request_.calib,
                                         calibration_request(request_.camera, frame.left_name, frame.right_name, view));
  for (const auto& note : calibration_->notes) say(request_.calib + ": " + note.text);
  const flies::GrayPair images =
      calibration_->rectifier ? calibration_->rectifier->rectify(frame.images) : frame.images;
  const flies::RectifiedPair pair = images.view();
  flies::check_camera_fits(calibration_->camera, pair.left.width_px, pair.left.height_px, request_.calib);
  calibration_->camera.width_px = pair.left.width_px;
  calibration_->camera.height_px = pair.left.height_px;
  flies::check_true_pair(pair, calibration_->camera, frame.left_name, frame.right_name);
}

/// Reads what it takes to know calibration and rows.
/// @returns false when the run was ended before there was a pair
/// @throws flies::InputError when the source ended without one
bool LiveRun::begin(std::vector<flies::StereoFrame>& first) {
  flies::StereoFrame frame;
  const std::size_t most =
      request_.max_pairs == 0 ? kPairsToDiagnose
                              : static_cast<std::size_t>(std::min<std::uint64_t>(kPairsToDiagnose, request_.max_pairs));
  while (first.size() < most && wait_for_pair(frame)) {
    if (first.empty()) calibrate(frame);
    first.push_back(std::move(frame));
  }
  if (first.empty()) {
    if (is_end_requested()) return false;
    const auto& folder = request_.stream.folder;
    const auto counts = stream_->counts();
    throw flies::InputError(folder.empty() ? request_.stream.sources.front() : folder.front().left, "",
                            fmt::format("the source ended without a pair; broken pictures: {}, without a partner: {}",
                                        counts.broken, counts.unpaired));
  }
  std::vector<flies::GrayPair> sample;
  for (const auto& one : first)
    sample.push_back(calibration_->rectifier ? calibration_->rectifier->rectify(one.images) : one.images);
  const flies::Calibration told = *calibration_;
  diagnosis_ = diagnose_sample(std::move(sample), *calibration_, request_.corrections);
  if (!is_settled(diagnosis_, request_.corrections)) later_.emplace(told, request_.corrections);
  for (const auto& note : first.front().images.notes) say(note);
  if (const auto note = flies::mosaic_note(first.front().images.view())) say(*note);
  for (const auto& note : diagnosis_.notes) say(note);
  for (const auto& note : fit_options()) say(note);
  {
    const std::lock_guard lock(mutex_);
    options_changed_ = false;
    worker_ = new_worker(options_, preset_, following_, submitted_);
  }
  say_run(*worker_->record);
  return true;
}

/// Learns from pairs that come after the first ones what those did not show.
/// @param images rectified, rows as they came
void LiveRun::diagnose_later(const flies::GrayPair& images, double time_s) {
  later_->offer(images, time_s);
  try {
    if (auto found = later_->take(request_.stream.is_patient)) take_up(*std::move(found));
  } catch (const flies::InputError& error) {  // options that do not go with the mount that was found
    later_.reset();
    say(fmt::format("the camera is taken as mounted as before: {}", error.what()));
  }
}

/// Fits camera and options to what was found, if it is more than was known, from the next pair on.
/// @throws flies::InputError when the options do not go with it; nothing has changed then
void LiveRun::take_up(LaterDiagnosis::Finding found) {
  const bool is_over = is_settled(found.diagnosis, request_.corrections);
  if (!is_over && (diagnosis_.diagnosis.can_be_trusted() || !found.diagnosis.diagnosis.can_be_trusted())) return;
  const auto exchange = [&] {
    std::swap(diagnosis_, found.diagnosis);
    std::swap(calibration_->camera.mount, found.mount);
  };
  exchange();
  std::vector<std::string> refusals;
  try {
    refusals = fit_options();
  } catch (const flies::InputError&) {
    exchange();
    throw;
  }
  const auto& told = found.diagnosis.notes;
  for (const auto& note : diagnosis_.notes)
    if (std::ranges::find(told, note) == told.end()) say(note);
  for (const auto& note : refusals) say(note);
  if (is_over) later_.reset();
}

/// To the camera, and what was set meanwhile on top; a worker is made so for the next pair.
/// @returns what of it is not allowed with this camera
std::vector<std::string> LiveRun::fit_options() {
  std::vector<std::string> refusals;
  const std::lock_guard lock(mutex_);
  options_ = effective_options(request_.method, calibration_->camera);
  try {  // together: one may need another
    auto all = options_;
    for (const auto& [path, text] : settings_) flies::set_option(all, path, text, "page");
    flies::check_detector_options(all, "page");
    options_ = all;
  } catch (const flies::InputError& error) {
    refusals.emplace_back(error.what());
  }
  options_changed_ = true;
  return refusals;
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
    flies::check_true_pair(images, camera, pair.left_name, pair.right_name);
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
    const bool is_done = snapshot->number == handed_on_ && !recent_.empty() &&
                         (snapshot->tracking.time_s >= recent_.back()->time_s || !snapshot->error.empty());
    if (is_done) break;
    changed_.wait_for(lock, 20ms);
  }
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
