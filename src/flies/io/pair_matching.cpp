#include "flies/io/pair_matching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/io/image_folder.hpp"

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

/// Seconds, of a name that is a number with a fraction, or one so long that it counts nanoseconds.
std::optional<double> time_of(const std::string& path) {
  const std::string name = fs::path(path).stem().string();
  constexpr std::size_t kLeastDigits = 10;
  constexpr double kNanoseconds = 1e-9;
  double number = 0.0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number, std::chars_format::fixed);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  if (name.find('.') != std::string::npos) return number;
  constexpr std::size_t kSecondsDigits = 10;
  if (name.size() < kLeastDigits) return std::nullopt;
  return name.size() == kSecondsDigits ? number : number * kNanoseconds;
}

bool are_times(const Paths& paths) {
  return std::all_of(paths.begin(), paths.end(), [](const std::string& path) { return time_of(path).has_value(); });
}

/// How many left names are right ones, too.
std::size_t common_names(const Paths& left, const Paths& right) {
  std::vector<std::string> names;
  for (const auto& path : right) names.push_back(common_name(path));
  std::sort(names.begin(), names.end());
  return static_cast<std::size_t>(std::count_if(left.begin(), left.end(), [&](const std::string& path) {
    return std::binary_search(names.begin(), names.end(), common_name(path));
  }));
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

MatchedPairs match_names(const Paths& left, const Paths& right) {
  std::map<std::string, std::size_t> by_name;
  for (std::size_t k = 0; k < right.size(); ++k) by_name.emplace(common_name(right[k]), k);
  return matched(left, right, [&](std::size_t i) -> std::optional<std::size_t> {
    const auto at = by_name.find(common_name(left[i]));
    return at == by_name.end() ? std::nullopt : std::optional(at->second);
  });
}

std::vector<double> times_of(const Paths& paths) {
  std::vector<double> times_s;
  for (const auto& path : paths) {
    const auto time_s = time_of(path);
    if (!time_s)
      throw InputError(path, "name", "is no time, expected seconds with a fraction (1698765432.1039) or nanoseconds");
    times_s.push_back(*time_s);
  }
  return times_s;
}

std::size_t nearest(const std::vector<double>& times_s, double time_s) {
  const auto closer = [&](double a, double b) { return std::abs(a - time_s) < std::abs(b - time_s); };
  return static_cast<std::size_t>(std::min_element(times_s.begin(), times_s.end(), closer) - times_s.begin());
}

/// Half of the usual time between images: what is farther apart belongs to the next one.
double patience_s(std::vector<double> times_s) {
  if (times_s.size() < 2) return 1.0;
  std::sort(times_s.begin(), times_s.end());
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  return 0.5 * upper_median(std::move(steps_s));
}

/// Two images are a pair when each is the nearest to the other.
MatchedPairs match_times(Paths left, Paths right) {
  const auto by_time = [](const std::string& a, const std::string& b) { return time_of(a) < time_of(b); };
  times_of(left), times_of(right);  // all must have one
  std::sort(left.begin(), left.end(), by_time);
  std::sort(right.begin(), right.end(), by_time);
  const auto left_s = times_of(left), right_s = times_of(right);
  const double most_s = patience_s(left_s);
  return matched(left, right, [&](std::size_t i) -> std::optional<std::size_t> {
    const std::size_t k = nearest(right_s, left_s[i]);
    if (nearest(left_s, right_s[k]) != i || std::abs(right_s[k] - left_s[i]) > most_s) return std::nullopt;
    return k;
  });
}

MatchedPairs match_order(const Paths& left, const Paths& right, const std::string& left_folder,
                         const std::string& right_folder) {
  if (left.size() != right.size())
    throw InputError(right_folder, "",
                     fmt::format("holds {} images, expected {} as in {}", right.size(), left.size(), left_folder));
  return matched(left, right, [](std::size_t i) { return std::optional(i); });
}

/// Names speak when most images have a partner by them.
PairBy what_speaks(const Paths& left, const Paths& right) {
  const std::size_t common = common_names(left, right);
  if (common > 0 && 2 * common >= std::min(left.size(), right.size())) return PairBy::name;
  return are_times(left) && are_times(right) ? PairBy::time : PairBy::order;
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
  if (!left_is_folder) return {{{left, right}}, {}, 0};
  const auto left_images = detail::images_of(left), right_images = detail::images_of(right);
  if (by == PairBy::automatic) by = what_speaks(left_images, right_images);
  auto found = by == PairBy::name   ? match_names(left_images, right_images)
               : by == PairBy::time ? match_times(left_images, right_images)
                                    : match_order(left_images, right_images, left, right);
  if (found.pairs.empty())
    throw InputError(right, "",
                     fmt::format("holds no partner of any image in {}; --pair-by order takes them in order", left));
  return found;
}

}  // namespace flies
