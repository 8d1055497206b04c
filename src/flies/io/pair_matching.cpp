#include "flies/io/pair_matching.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/image_names.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<std::string>;

/// A name without its extension, and without the words that tell left from right.
std::string common_name(const std::string& path) {
  std::string name = fs::path(path).stem().string();
  for (const std::string_view side : {"left", "right", "Left", "Right", "LEFT", "RIGHT", "cam0", "cam1"})
    if (const auto at = name.find(side); at != std::string::npos) name.replace(at, side.size(), "*");
  return name;
}

/// What the names of two folders are compared by.
struct NameKeys {
  Paths left, right;

  std::size_t common() const {
    const std::set<std::string> names(right.begin(), right.end());
    return static_cast<std::size_t>(
        std::count_if(left.begin(), left.end(), [&](const std::string& name) { return names.contains(name); }));
  }
  /// Names speak when most images have a partner by them.
  bool speak() const {
    const std::size_t found = common();
    return found > 0 && 2 * found >= std::min(left.size(), right.size());
  }
};

NameKeys whole_names(const Paths& left, const Paths& right) {
  NameKeys keys;
  for (const auto& path : left) keys.left.push_back(common_name(path));
  for (const auto& path : right) keys.right.push_back(common_name(path));
  return keys;
}

NameKeys bare_names(const Paths& left, const Paths& right) {
  auto [left_names, right_names] = names_without_side(left, right);
  return {std::move(left_names), std::move(right_names)};
}

/// Pairs left images with those that `partner` names, which takes no right image twice.
template <class Partner>
MatchedPairs matched(const Paths& left, const Paths& right, Partner partner) {
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

MatchedPairs match_names(const Paths& left, const Paths& right, const NameKeys& keys) {
  std::map<std::string, std::size_t> by_name;
  for (std::size_t k = 0; k < right.size(); ++k) by_name.emplace(keys.right[k], k);
  return matched(left, right, [&](std::size_t i) -> std::optional<std::size_t> {
    const auto at = by_name.find(keys.left[i]);
    return at == by_name.end() ? std::nullopt : std::optional(at->second);
  });
}

/// Images with their times, in order of time.
struct TimedPaths {
  Paths paths;
  std::vector<double> times_s;
};

TimedPaths in_order_of_time(const Paths& paths) {
  const auto times_s = times_in_names(paths);
  if (!times_s) {
    const auto odd = std::find_if(paths.begin(), paths.end(), [](const auto& path) { return !times_in_names({path}); });
    throw InputError(odd == paths.end() ? paths.front() : *odd, "name",
                     "is no time, expected seconds with a fraction (1698765432.1039), nanoseconds, or date and time");
  }
  std::vector<std::pair<double, std::string>> timed;
  for (std::size_t i = 0; i < paths.size(); ++i) timed.emplace_back((*times_s)[i], paths[i]);
  std::sort(timed.begin(), timed.end());
  TimedPaths found;
  for (auto& [time_s, path] : timed) {
    found.times_s.push_back(time_s);
    found.paths.push_back(std::move(path));
  }
  return found;
}

/// @param times_s in order
std::size_t nearest(const std::vector<double>& times_s, double time_s) {
  const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
  if (after == times_s.begin()) return 0;
  const auto at = static_cast<std::size_t>(after - times_s.begin());
  return after == times_s.end() || time_s - times_s[at - 1] <= *after - time_s ? at - 1 : at;
}

/// The usual time between images, which are in order.
double usual_step_s(const std::vector<double>& times_s) {
  if (times_s.size() < 2) return 2.0;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  return upper_median(std::move(steps_s));
}

/// Cameras that are triggered together differ by a hundredth of their step.
std::optional<std::string> note_on_skew(const std::vector<double>& skews_s, double step_s) {
  constexpr double kMuch = 0.15;  // of a step
  if (skews_s.empty()) return std::nullopt;
  const double skew_s = upper_median(skews_s);
  if (std::abs(skew_s) <= kMuch * step_s) return std::nullopt;
  return fmt::format(
      "by the times in their names right images are {:+.0f} ms after the left ones they are paired with, of {:.0f} ms "
      "from image to image: what moves is misplaced; if only the clocks differ, --pair-by order pairs the first with "
      "the first",
      1e3 * skew_s, 1e3 * step_s);
}

/// Two images are a pair when each is the nearest to the other.
MatchedPairs match_times(const Paths& left, const Paths& right) {
  const TimedPaths lefts = in_order_of_time(left), rights = in_order_of_time(right);
  const double step_s = usual_step_s(lefts.times_s);
  std::vector<double> skews_s;
  auto found = matched(lefts.paths, rights.paths, [&](std::size_t i) -> std::optional<std::size_t> {
    const std::size_t k = nearest(rights.times_s, lefts.times_s[i]);
    const double skew_s = rights.times_s[k] - lefts.times_s[i];
    // What is farther apart than half of a step belongs to the next one.
    if (nearest(lefts.times_s, rights.times_s[k]) != i || std::abs(skew_s) > 0.5 * step_s) return std::nullopt;
    skews_s.push_back(skew_s);
    return k;
  });
  if (auto note = note_on_skew(skews_s, step_s)) found.notes.push_back(std::move(*note));
  return found;
}

MatchedPairs match_order(const Paths& left, const Paths& right, const std::string& left_folder,
                         const std::string& right_folder) {
  if (left.size() != right.size())
    throw InputError(right_folder, "",
                     fmt::format("holds {} images, expected {} as in {}", right.size(), left.size(), left_folder));
  return matched(left, right, [](std::size_t i) { return std::optional(i); });
}

/// Names with numbers that differ within pairs that were made in order.
std::optional<std::string> note_on_order(const Paths& left, const Paths& right) {
  const auto has_number = [](const std::string& name) { return name.find_first_of("0123456789") != std::string::npos; };
  const NameKeys keys = bare_names(left, right);
  constexpr std::size_t kExamples = 3;
  std::vector<std::string> examples;
  std::size_t count = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (keys.left[i] == keys.right[i] || !(has_number(keys.left[i]) || has_number(keys.right[i]))) continue;
    if (++count <= kExamples)
      examples.push_back(
          fmt::format("{} with {}", fs::path(left[i]).filename().string(), fs::path(right[i]).filename().string()));
  }
  if (count == 0) return std::nullopt;
  return fmt::format(
      "images are paired in order though the numbers in {} of {} pairs of names differ ({}): a lost image shifts all "
      "that follow",
      count, left.size(), fmt::join(examples, ", "));
}

MatchedPairs match_images(const Paths& left, const Paths& right, PairBy by, const std::string& left_folder,
                          const std::string& right_folder) {
  const bool is_automatic = by == PairBy::automatic;
  if (is_automatic || by == PairBy::name) {
    const NameKeys whole = whole_names(left, right), bare = bare_names(left, right);
    if (whole.speak()) return match_names(left, right, whole);
    if (is_automatic && times_in_names(left) && times_in_names(right)) return match_times(left, right);
    if (bare.speak()) return match_names(left, right, bare);
    if (!is_automatic) return match_names(left, right, bare.common() > whole.common() ? bare : whole);
  }
  if (by == PairBy::time) return match_times(left, right);
  auto found = match_order(left, right, left_folder, right_folder);
  if (!is_automatic) return found;
  if (auto note = note_on_order(left, right)) found.notes.push_back(std::move(*note));
  return found;
}

}  // namespace

std::optional<PairBy> pair_by_of(const std::string& word) {
  if (word == "auto") return PairBy::automatic;
  if (word == "order") return PairBy::order;
  if (word == "name") return PairBy::name;
  if (word == "time") return PairBy::time;
  return std::nullopt;
}

MatchedPairs match_pairs(const std::string& left, const std::string& right, PairBy by) {
  const bool left_is_folder = detail::is_folder(left);
  if (left_is_folder != detail::is_folder(right))
    throw InputError(right, "",
                     left_is_folder ? fmt::format("is a file, expected a folder as {} is one", left)
                                    : fmt::format("is a folder, expected a file as {} is one", left));
  if (!left_is_folder) return {{{left, right}}, {}, 0, {}};
  const auto left_images = detail::images_of(left), right_images = detail::images_of(right);
  auto found = match_images(left_images, right_images, by, left, right);
  if (found.pairs.empty())
    throw InputError(right, "",
                     fmt::format("holds no partner of any image in {}; --pair-by order takes them in order", left));
  return found;
}

MatchedPairs match_all(const std::string& left, const std::string& right) {
  auto found = match_pairs(left, right, PairBy::automatic);
  if (found.odd.empty()) return found;
  throw InputError(
      right, "",
      fmt::format("holds {} images, expected {} as in {}: no partner has {}", found.pairs.size() + found.odd_right,
                  found.pairs.size() + found.odd.size() - found.odd_right, left, fmt::join(found.odd, ", ")));
}

}  // namespace flies
