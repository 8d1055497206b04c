#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace flies {

/// Times of a film's pictures: by its rate as long as its own stamps go with that, so that stamps rounded to whole
/// milliseconds do no harm; else by the stamps.
class FilmClock {
 public:
  /// @param rate_hz pictures a second
  explicit FilmClock(double rate_hz);

  /// @param stamp_s of the next picture, since the film began; one that does not grow is taken as none
  /// @returns its time
  double next(std::optional<double> stamp_s);

  /// Whether there was a stamp that could be a time, after the first picture's, which may be 0 for want of one.
  bool has_stamps() const { return has_stamps_; }

 private:
  double even_time_s() const;
  double time_without_stamp() const;
  void note_step(double step_s);

  double rate_hz_;
  double since_s_ = 0.0;     ///< from here on the pictures come at the film's rate
  std::uint64_t index_ = 0;  ///< of the next picture, from there
  std::optional<double> last_s_;
  std::deque<double> steps_s_;  ///< the last ones by stamps
  bool has_stamps_ = false;
};

}  // namespace flies
