#include "live/later_diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "flies/core/background_thread.hpp"

namespace {

constexpr std::size_t kPairs = 5;
constexpr double kFirst_s = 0.4, kLongest_s = 12.0;  // between two pairs: the first sample takes 2 s, the last a minute

}  // namespace

bool is_settled(const RunDiagnosis& diagnosis, const RunCorrections& corrections) {
  if (!diagnosis.is_known || !diagnosis.diagnosis.can_be_trusted()) return false;
  return !corrections.find_mount || diagnosis.diagnosis.road_found || diagnosis.mount.is_upside_down;
}

LaterDiagnosis::LaterDiagnosis(flies::Calibration calibration, RunCorrections corrections)
    : calibration_(std::move(calibration)), corrections_(corrections), every_s_(kFirst_s) {}

void LaterDiagnosis::offer(const flies::GrayPair& images, double time_s) {
  if (finding_.valid()) return;
  // Times of films that begin anew go back.
  if (last_s_ && std::abs(time_s - *last_s_) < every_s_) return;
  last_s_ = time_s;
  sample_.push_back(images);
  if (sample_.size() < kPairs) return;
  every_s_ = std::min(2.0 * every_s_, kLongest_s);
  finding_ = std::async(std::launch::async, [sample = std::exchange(sample_, {}), calibration = calibration_,
                                             corrections = corrections_]() mutable {
    flies::yield_to_other_threads();
    auto diagnosis = diagnose_sample(std::move(sample), calibration, corrections);
    return Finding{std::move(diagnosis), calibration.camera.mount};
  });
}

std::optional<LaterDiagnosis::Finding> LaterDiagnosis::take(bool is_awaited) {
  if (!finding_.valid()) return std::nullopt;
  if (!is_awaited && finding_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return finding_.get();
}
