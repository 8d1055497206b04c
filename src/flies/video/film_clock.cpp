#include "flies/video/film_clock.hpp"

#include <cmath>
#include <vector>

#include "flies/core/quantile.hpp"

namespace flies {
namespace {

constexpr double kRounding_s = 0.0011;  // stamps of many containers are whole milliseconds, of the first picture too
constexpr std::size_t kUsualSteps = 10;

}  // namespace

FilmClock::FilmClock(double rate_hz) : rate_hz_(rate_hz) {}

double FilmClock::even_time_s() const { return since_s_ + static_cast<double>(index_) / rate_hz_; }

/// Decoders that hold pictures back give the last ones none.
double FilmClock::time_without_stamp() const {
  const bool is_even = index_ > 1 || steps_s_.empty();
  return is_even ? even_time_s() : *last_s_ + upper_median(std::vector<double>(steps_s_.begin(), steps_s_.end()));
}

void FilmClock::note_step(double step_s) {
  steps_s_.push_back(step_s);
  if (steps_s_.size() > kUsualSteps) steps_s_.pop_front();
}

double FilmClock::next(std::optional<double> stamp_s) {
  const bool is_known = stamp_s && (!last_s_ || *stamp_s > *last_s_);
  double time_s = even_time_s();
  if (!is_known)
    time_s = last_s_ ? time_without_stamp() : time_s;
  else if (std::abs(*stamp_s - time_s) > kRounding_s)
    time_s = *stamp_s;
  if (is_known && last_s_) {
    has_stamps_ = true;
    note_step(time_s - *last_s_);
  }
  if (time_s != even_time_s()) {
    since_s_ = time_s;
    index_ = 0;
  }
  ++index_;
  last_s_ = time_s;
  return time_s;
}

}  // namespace flies
