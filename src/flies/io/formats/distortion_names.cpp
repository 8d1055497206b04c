#include "flies/io/formats/distortion_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/formats/named_keys.hpp"

namespace flies::detail {
namespace {

/// OpenCV's order.
constexpr std::array kBrown = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"};
constexpr std::array kFisheye = {"k1", "k2", "k3", "k4"};
constexpr std::string_view kRadial[] = {"radial", "radialdistortion", "radialcoefficients", "radialcoeffs"};

bool is_one_of_several(std::string_view plain) { return std::ranges::find(kBrown, plain) != kBrown.end(); }

bool is_radial(std::string_view plain) { return std::ranges::find(kRadial, plain) != std::end(kRadial); }

/// Likewise, with the side of the camera before or behind it.
bool names_radial(std::string_view plain) {
  return plain.find("radial") != std::string_view::npos && plain.find("tangential") == std::string_view::npos;
}

bool is_zero(const std::vector<double>& numbers, std::size_t from = 0) {
  return std::all_of(numbers.begin() + static_cast<std::ptrdiff_t>(std::min(from, numbers.size())), numbers.end(),
                     [](double number) { return number == 0.0; });
}

/// Numbers that may be coefficients: one alone under a short name is a distance, or a flag.
bool may_be_list(std::string_view plain, const NumberEntry& entry) {
  constexpr std::size_t kMost = 14;
  const std::size_t least = plain.starts_with("distortion") ? 1 : 2;
  return entry.numbers.size() >= least && entry.numbers.size() <= kMost;
}

/// K is a camera matrix, or fx, fy, cx, cy, if it is no list of coefficients.
bool is_list_of_k(std::string_view plain, const NumberEntry& entry) {
  constexpr double kMost = 10.0;
  const auto count = entry.numbers.size();
  return plain == "k" && (count == 4 || count == 5 || count == 8) &&
         std::ranges::all_of(entry.numbers, [](double number) { return std::abs(number) < kMost; });
}

/// A name that says distortion in other words, as `lens_distortion_left` does.
bool speaks_of_distortion(std::string_view plain) {
  const auto has = [&](std::string_view part) { return plain.find(part) != std::string_view::npos; };
  return (has("distor") || has("distco") || has("radial") || has("tangential")) && !has("undist");
}

/// What stands before and behind "k1" in the last part of a key.
struct Around {
  std::string before, behind;
};

std::optional<Around> around_first(const std::string& key) {
  for (const char* name : {"k1", "K1"}) {
    const auto at = key.rfind(name);
    if (at == std::string::npos || key.find('.', at) != std::string::npos) continue;
    return Around{key.substr(0, at), key.substr(at + 2)};
  }
  return std::nullopt;
}

/// Coefficients of these names, missing ones 0.
template <std::size_t Count>
std::vector<double> one_by_one(const NumberTable& table, const Around& around, bool in_capitals,
                               const std::array<const char*, Count>& names) {
  std::vector<double> found;
  for (std::string name : names) {
    if (in_capitals) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    const std::string key = around.before + name + around.behind;
    found.push_back(table.has(key) ? table.require_number(key) : 0.0);
  }
  return found;
}

/// As short as OpenCV takes them.
void shorten(std::vector<double>& coefficients, Lens lens) {
  for (const std::size_t count : {4U, 5U, 8U})
    if (is_zero(coefficients, count) && (count != 4U || lens == Lens::mei)) return coefficients.resize(count);
}

std::vector<double> one_by_one_at(const NumberTable& table, const std::string& key, Lens lens) {
  const Around around = *around_first(key);
  const bool in_capitals = key[around.before.size()] == 'K';
  if (lens == Lens::equidistant) return one_by_one(table, around, in_capitals, kFisheye);
  auto found = one_by_one(table, around, in_capitals, kBrown);
  constexpr std::size_t kFirstTangential = 2, kFourth = 5;
  const bool is_like_fisheye = found[kFourth] != 0.0 && found[kFourth + 1] == 0.0 && found[kFourth + 2] == 0.0 &&
                               found[kFirstTangential] == 0.0 && found[kFirstTangential + 1] == 0.0;
  if (is_like_fisheye)
    throw InputError(table.source, around.before + (in_capitals ? "K4" : "k4") + around.behind,
                     "stands beside k1, k2 and k3 without p1 and p2: are they a fisheye's (distortion_model: "
                     "equidistant)? For the rational model k5, k6, p1 and p2 are expected too");
  shorten(found, lens);
  return found;
}

/// k1, k2, perhaps k3, and in a list beside them p1, p2.
std::vector<double> radial_at(const NumberTable& table, const std::string& key) {
  const auto& radial = table.require(key);
  if (radial.size() != 2 && radial.size() != 3)
    throw InputError(table.source, key, fmt::format("found {} numbers, expected k1, k2, or k1, k2, k3", radial.size()));
  std::vector<double> found = {radial[0], radial[1], 0.0, 0.0, radial.size() == 3 ? radial[2] : 0.0};
  for (const auto& [from, to] : {std::array{"radial", "tangential"}, std::array{"Radial", "Tangential"}}) {
    std::string beside = key;
    const auto at = beside.rfind(from);
    if (at == std::string::npos) continue;
    beside.replace(at, std::string_view(from).size(), to);
    if (!table.has(beside)) continue;
    const auto& tangential = table.require(beside, 2);
    found[2] = tangential[0];
    found[3] = tangential[1];
  }
  return found;
}

/// How far coefficients stand below the camera's own keys, and whether they are numbers; the least comes first.
constexpr int kNotThere = 100;
int order_of(std::string_view below, const NumberEntry& entry) {
  constexpr int kPerKey = 3, kOfWords = 50;
  int order = 0;
  for (auto dot = below.find('.'); dot != std::string_view::npos; dot = below.find('.')) {
    if (!is_distortion_name(plain_letters(below.substr(0, dot)))) return kNotThere;
    below.remove_prefix(dot + 1);
    order += kPerKey;
  }
  if (below == "k1" || below == "K1") return entry.numbers.size() == 1 ? order : kNotThere;
  const std::string name = plain_letters(below);
  const bool is_list = may_be_list(name, entry);
  if (is_distortion_name(name) && is_list) return order + 1;
  if (is_distortion_name(name) && entry.numbers.empty()) return order + kOfWords;
  return is_radial(name) && is_list ? order + 2 : kNotThere;
}

/// Whether a key stands directly below one of coefficients: distortion.values.
bool is_below_distortion(std::string_view key) {
  const auto dot = key.rfind('.');
  return dot != std::string_view::npos && is_distortion_name(plain_name(key.substr(0, dot)));
}

}  // namespace

const std::vector<std::string>& distortion_names() {
  static const std::vector<std::string> names = {"d",
                                                 "distcoeffs",
                                                 "distcoeff",
                                                 "dist",
                                                 "distortion",
                                                 "distortioncoefficients",
                                                 "distortioncoefficient",
                                                 "distortioncoeffs",
                                                 "distortioncoeff",
                                                 "distortions",
                                                 "distortionvector",
                                                 "distortionparameters",
                                                 "distortionparams",
                                                 "discoeffs",
                                                 "disto",
                                                 "distcoef",
                                                 "distcoefs",
                                                 "distparams",
                                                 "lensdistortion",
                                                 "lensdistortioncoefficients",
                                                 "lensdistortioncoeffs",
                                                 "coeffs",
                                                 "coefficients",
                                                 "kc"};
  return names;
}

bool is_distortion_name(std::string_view plain) {
  return std::ranges::find(distortion_names(), plain) != distortion_names().end();
}

bool holds_distortion(std::string_view key, const NumberEntry& entry) {
  constexpr std::size_t kFewest = 4;  // of names that only speak of it: a centre of distortion has two
  const std::string name = plain_name(key);
  if (is_zero(entry.numbers)) return false;
  if (is_one_of_several(name)) return entry.numbers.size() == 1;
  if ((is_distortion_name(name) || is_radial(name)) && may_be_list(name, entry)) return true;
  if (is_list_of_k(name, entry)) return true;
  return (speaks_of_distortion(name) || is_below_distortion(key)) && entry.numbers.size() >= kFewest &&
         may_be_list(name, entry);
}

FoundDistortion distortion_at(const NumberTable& table, const std::string& key, Lens lens) {
  constexpr std::size_t kOfFisheye = 4;
  const auto entry = table.entries.find(key);
  if (names_radial(plain_name(key))) return {key, radial_at(table, key)};
  const bool is_single = entry != table.entries.end() && entry->second.numbers.size() == 1;
  if (is_single && around_first(key)) return {key, one_by_one_at(table, key, lens)};
  FoundDistortion found{key, table.require(key)};
  auto& numbers = found.coefficients;  // RealSense writes five of every model
  if (lens == Lens::equidistant && numbers.size() == kOfFisheye + 1 && numbers.back() == 0.0) numbers.pop_back();
  return found;
}

FoundDistortion distortion_below(const NumberTable& table, const std::string& place, Lens lens) {
  int least = kNotThere;
  std::string found;
  for (const auto& [key, entry] : table.entries) {
    if (!key.starts_with(place)) continue;
    const int order = order_of(std::string_view(key).substr(place.size()), entry);
    if (order >= least) continue;
    least = order;
    found = key;
  }
  return found.empty() ? FoundDistortion{} : distortion_at(table, found, lens);
}

void check_no_distortion(const NumberTable& table, const std::string& place) {
  for (const auto& [key, entry] : table.entries) {
    if (!key.starts_with(place) || !holds_distortion(key, entry)) continue;
    const std::string below = key.substr(place.size());
    const std::string first = plain_letters(below.substr(0, below.find('.')));
    // A file that says of cameras below no other key may say of others below theirs.
    if (place.empty() && !is_on_top(below) && !speaks_of_distortion(first) && !is_distortion_name(first)) continue;
    throw InputError(table.source, key,
                     fmt::format("found {} number{}: are they distortion coefficients? expected those as "
                                 "distortion_coefficients (k1 k2 p1 p2 k3) of each camera, or as k1, k2, ...",
                                 entry.numbers.size(), entry.numbers.size() == 1 ? "" : "s"));
  }
}

std::vector<double> distortion_of(const NumberTable& table, const std::string& place, Lens lens) {
  const auto found = distortion_below(table, place, lens);
  if (found.key.empty()) check_no_distortion(table, place);
  return found.coefficients;
}

CalibrationNote note_on_missing_distortion() {
  return {"the file has no distortion coefficients: the lenses are taken as free of distortion"};
}

}  // namespace flies::detail
