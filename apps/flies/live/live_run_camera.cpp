// What a `LiveRun` knows of its camera, by the first pairs and by later ones.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/diagnose/calibrated_pair.hpp"
#include "flies/io/images.hpp"
#include "flies/io/mosaic.hpp"
#include "live/live_run.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"
#include "shared/pair_arguments.hpp"

namespace {

constexpr std::size_t kPairsToDiagnose = 5;

}  // namespace

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
      fmt::format(
          "found whole pictures of {} x {} px, the size that the calibration is for; expected the left and the right "
          "picture in each, side by side or one above the other (--split), or a second source with the right pictures",
          width_px, height_px));
}

/// @throws flies::InputError when the file cannot be read, or does not go with this pair
void LiveRun::fit_calibration(const flies::StereoFrame& frame) {
  if (!request_.stream.folder.empty())
    if (const auto note = orientation_note({frame.left_name, frame.right_name})) say(*note);
  const flies::RectifiedPair view = frame.images.view();
  calibration_ = calibration_for(request_.calib, request_.camera, frame.left_name, frame.right_name, view);
  for (const auto& note : calibration_->notes) say(request_.calib + ": " + note.text);
  const flies::GrayPair images =
      calibration_->rectifier ? calibration_->rectifier->rectify(frame.images) : frame.images;
  const flies::RectifiedPair pair = images.view();
  flies::check_camera_fits(calibration_->camera, pair.left.width_px, pair.left.height_px, request_.calib);
  calibration_->camera.width_px = pair.left.width_px;
  calibration_->camera.height_px = pair.left.height_px;
  flies::check_calibrated_pair(
      pair, *calibration_, [&] { return frame.images; }, frame.left_name, frame.right_name);
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
  for (const auto& note : flies::notes_on_images(first.front().images.view())) say(note);
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
    say(fmt::format("the mount of the camera stays as before: {}", error.what()));
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
