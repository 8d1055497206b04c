#include "track/timed_film.hpp"

#include <algorithm>

void TimedFilm::add(const cv::Mat& picture, double time_s) {
  if (!last_.empty()) {
    owed_ += kRate_hz * std::clamp(time_s - time_s_, 0.0, kLongestStill_s);
    for (; owed_ >= 0.5; owed_ -= 1.0) film_.add(last_);
  }
  last_ = picture;
  time_s_ = time_s;
}

void TimedFilm::finish() {
  if (last_.empty()) return;
  film_.add(last_);
  film_.commit();
}
