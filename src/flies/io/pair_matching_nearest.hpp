#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/quantile.hpp"
#include "flies/io/pair_matching.hpp"

/// What all ways to match the images of two folders have in common.
namespace flies::detail {

/// Pairs left images with those that `partner` names, which takes no right image twice.
template <class Partner>
MatchedPairs matched(const std::vector<std::string>& left, const std::vector<std::string>& right, Partner partner) {
  MatchedPairs found;
  std::vector<bool> is_taken(right.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::optional<std::size_t> k = partner(i);
    if (k && !is_taken[*k]) {
      is_taken[*k] = true;
      found.pairs.push_back({left[i], right[*k]});
    } else {
      found.odd.push_back(left[i]);
    }
  }
  for (std::size_t k = 0; k < right.size(); ++k)
    if (!is_taken[k]) {
      found.odd.push_back(right[k]);
      ++found.odd_right;
    }
  return found;
}

/// Images with their times, or other numbers that ascend, in order of these.
struct TimedPaths {
  std::vector<std::string> paths;
  std::vector<double> times_s;
};

/// @param times_s in order
inline std::size_t nearest(const std::vector<double>& times_s, double time_s) {
  const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
  if (after == times_s.begin()) return 0;
  const auto at = static_cast<std::size_t>(after - times_s.begin());
  return after == times_s.end() || time_s - times_s[at - 1] <= *after - time_s ? at - 1 : at;
}

/// The usual time between images, which are in order.
inline double usual_step_s(const std::vector<double>& times_s) {
  if (times_s.size() < 2) return 2.0;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  return upper_median(std::move(steps_s));
}

struct NearestPairs {
  MatchedPairs found;
  std::vector<double> skews_s;  ///< how much later the right image of each pair is
};

/// Two images are a pair when each is the nearest to the other.
inline NearestPairs match_nearest(const TimedPaths& lefts, const TimedPaths& rights) {
  const double step_s = usual_step_s(lefts.times_s);
  NearestPairs nearest_pairs;
  nearest_pairs.found = matched(lefts.paths, rights.paths, [&](std::size_t i) -> std::optional<std::size_t> {
    const std::size_t k = nearest(rights.times_s, lefts.times_s[i]);
    const double skew_s = rights.times_s[k] - lefts.times_s[i];
    // What is farther apart than half of a step belongs to the next one.
    if (nearest(lefts.times_s, rights.times_s[k]) != i || std::abs(skew_s) > 0.5 * step_s) return std::nullopt;
    nearest_pairs.skews_s.push_back(skew_s);
    return k;
  });
  return nearest_pairs;
}

}  // namespace flies::detail
