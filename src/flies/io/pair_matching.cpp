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
#include "flies/io/pair_matching_nearest.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using Paths = std::vector<std::string>;
using detail::match_nearest;
using detail::matched;
using detail::TimedPaths;
using detail::usual_step_s;

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

MatchedPairs match_names(const Paths& left, const Paths& right, const NameKeys& keys) {
  std::map<std::string, std::size_t> by_name;
  for (std::size_t k = 0; k < right.size(); ++k) by_name.emplace(keys.right[k], k);
  return matched(left, right, [&](std::size_t i) -> std::optional<std::size_t> {
    const auto at = by_name.find(keys.left[i]);
    return at == by_name.end() ? std::nullopt : std::optional(at->second);
  });
}

TimedPaths in_order_of_time(const Paths& paths) {
  const auto times_s = times_in_names(paths);
  if (!times_s) {
    const auto odd = std::find_if(paths.begin(), paths.end(), [](const auto& path) { return !times_in_names({path}); });
    throw InputError(
        odd == paths.end() ? paths.front() : *odd, "name",
        "is not a time, expected seconds with a fraction (1698765432.1039), nanoseconds, or date and time");
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

/// Cameras that are triggered together differ by a hundredth of their step.
std::optional<std::string> note_on_skew(const std::vector<double>& skews_s, double step_s) {
  constexpr double kMuch = 0.15;  // of a step
  if (skews_s.empty()) return std::nullopt;
  const double skew_s = upper_median(skews_s);
  if (std::abs(skew_s) <= kMuch * step_s) return std::nullopt;
  return fmt::format(
      "by the times in their names, right images are {:+.0f} ms after the left ones they are paired with, while {:.0f} "
      "ms pass from image to image: moving things are misplaced; if only the clocks differ, --pair-by order pairs the "
      "first with the first",
      1e3 * skew_s, 1e3 * step_s);
}

MatchedPairs match_times(const Paths& left, const Paths& right) {
  const TimedPaths lefts = in_order_of_time(left), rights = in_order_of_time(right);
  auto [found, skews_s] = match_nearest(lefts, rights);
  if (auto note = note_on_skew(skews_s, usual_step_s(lefts.times_s))) found.notes.push_back(std::move(*note));
  return found;
}

/// Numbers in names, which count something that the folders have in common, if only but for a constant.
std::optional<TimedPaths> in_order_of_number(const Paths& paths) {
  const auto numbers = finest_numbers_in_names(paths);
  if (!numbers || numbers->size() < 2) return std::nullopt;
  return TimedPaths{paths, {numbers->begin(), numbers->end()}};
}

/// Whether the difference of the numbers changes by about a step somewhere in pairs in order, as where an image is
/// lost, and not by jitter, which is everywhere.
bool order_jumps(const TimedPaths& lefts, const TimedPaths& rights, double step) {
  constexpr double kCalm = 0.3, kOutstanding = 10.0;  // of the changes, even where a few images have many jumps
  if (lefts.paths.size() != rights.paths.size()) return true;
  std::vector<double> changes;
  for (std::size_t i = 1; i < lefts.paths.size(); ++i)
    changes.push_back(std::abs(rights.times_s[i] - rights.times_s[i - 1] - lefts.times_s[i] + lefts.times_s[i - 1]));
  return *std::ranges::max_element(changes) > std::max(0.5 * step, kOutstanding * quantile(changes, kCalm));
}

/// By the numbers in names, as times of one clock or counts that differ by a constant.
/// @returns nothing where they do not tell more than the order does
std::optional<MatchedPairs> match_numbers(const Paths& left, const Paths& right) {
  constexpr double kNear = 0.1;  // of a step: cameras that are triggered together differ by a hundredth
  const auto lefts = in_order_of_number(left);
  auto rights = in_order_of_number(right);
  if (!lefts || !rights) return std::nullopt;
  const double step = usual_step_s(lefts->times_s);
  const bool jumps = order_jumps(*lefts, *rights, step);
  const auto most_pair = [&](const MatchedPairs& found) {
    return 2 * found.pairs.size() > std::min(left.size(), right.size());
  };

  auto [found, skews] = match_nearest(*lefts, *rights);
  if (most_pair(found) && std::abs(upper_median(skews)) <= kNear * step) {
    if (!jumps && !found.odd.empty()) return std::nullopt;
    found.notes.push_back(
        fmt::format("images are paired by the numbers in their names, each with the nearest: the numbers of right "
                    "images are {:+.0f} from those of left ones, and {:.0f} from image to image",
                    upper_median(skews), step));
    return found;
  }
  // Where images are lost on the way, the first and the last ones still tell the constant.
  const double constant = rights->times_s.front() - lefts->times_s.front();
  if (!jumps || std::abs(rights->times_s.back() - lefts->times_s.back() - constant) > kNear * step) return std::nullopt;
  for (double& number : rights->times_s) number -= constant;
  found = match_nearest(*lefts, *rights).found;
  if (!most_pair(found)) return std::nullopt;
  found.notes.push_back(
      fmt::format("images are paired by the numbers in their names, right numbers {:+.0f} from left ones as in the "
                  "first and the last pair, because images are missing in between; --pair-by order pairs them in order",
                  constant));
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
      "images are paired in order although the numbers in {} of {} pairs of names differ ({}): a missing image shifts "
      "all that follow",
      count, left.size(), fmt::join(examples, ", "));
}

/// Pairs that were made in order where the names tell of others for most images.
std::optional<std::string> note_on_others(const MatchedPairs& ordered, const MatchedPairs& told) {
  std::set<std::pair<std::string, std::string>> pairs;
  for (const auto& pair : told.pairs) pairs.emplace(pair.left, pair.right);
  const auto differs = [&](const PairPaths& pair) { return !pairs.contains({pair.left, pair.right}); };
  const auto first = std::ranges::find_if(ordered.pairs, differs);
  if (first == ordered.pairs.end() || 2 * pairs.size() < ordered.pairs.size()) return std::nullopt;
  return fmt::format(
      "images are paired in order, but by their names {} of {} are not pairs, such as {} with {}: a missing image "
      "shifts all that follow; --pair-by auto goes by the names",
      std::ranges::count_if(ordered.pairs, differs), ordered.pairs.size(), fs::path(first->left).filename().string(),
      fs::path(first->right).filename().string());
}

/// The pairs that the names tell of, if they do.
std::optional<MatchedPairs> match_by_itself(const Paths& left, const Paths& right) {
  const NameKeys whole = whole_names(left, right), bare = bare_names(left, right);
  if (whole.speak()) return match_names(left, right, whole);
  if (times_in_names(left) && times_in_names(right)) {
    auto found = match_times(left, right);
    // Numbers may only look like times.
    if (!bare.speak() || 2 * found.pairs.size() >= std::min(left.size(), right.size())) return found;
  }
  if (bare.speak()) return match_names(left, right, bare);
  return match_numbers(left, right);
}

MatchedPairs match_images(const Paths& left, const Paths& right, PairBy by, const std::string& left_folder,
                          const std::string& right_folder) {
  if (by == PairBy::time) return match_times(left, right);
  if (by == PairBy::name) {
    const NameKeys whole = whole_names(left, right), bare = bare_names(left, right);
    return match_names(left, right, whole.speak() || bare.common() <= whole.common() ? whole : bare);
  }
  auto told = match_by_itself(left, right);
  if (told && by == PairBy::automatic) return std::move(*told);
  auto found = match_order(left, right, left_folder, right_folder);
  if (auto note = told ? note_on_others(found, *told) : std::nullopt) found.notes.push_back(std::move(*note));
  if (by == PairBy::order) return found;
  if (auto note = note_on_order(left, right)) found.notes.push_back(std::move(*note));
  return found;
}

/// A folder that holds the images of both cameras.
MatchedPairs match_one_folder(const std::string& folder, PairBy by) {
  const auto sides = sides_in_names(detail::images_of(folder));
  if (!sides)
    throw InputError(folder, "",
                     "is given as both folders, expected one of left and one of right images, or names that all say "
                     "which they are (left01 and right01, 01_l and 01_r, cam0_01 and cam1_01, 01_0 and 01_1)");
  auto found = match_images(sides->first, sides->second, by, folder + " (left)", folder + " (right)");
  found.notes.insert(
      found.notes.begin(),
      fmt::format("{}: is given as both folders: the names in it say which images are left and which are right",
                  folder));
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
  std::error_code error;
  auto found = fs::equivalent(left, right, error)
                   ? match_one_folder(left, by)
                   : match_images(detail::images_of(left), detail::images_of(right), by, left, right);
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
