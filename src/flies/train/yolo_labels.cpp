#include "flies/train/yolo_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/text_file.hpp"
#include "flies/io/yaml_text.hpp"
#include "flies/train/label_kind.hpp"

namespace flies {
namespace {

using Fields = std::vector<std::string>;

constexpr std::size_t kBox = 5, kBoxAndOne = 6, kLeastPolygon = 7;

/// Calls `take(number, fields)` for every line that says something.
void for_each_line(std::string_view text, const std::function<void(int, const Fields&)>& take) {
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::istringstream words{line.substr(0, line.find('#'))};
    Fields fields;
    for (std::string word; words >> word;) fields.push_back(word);
    if (!fields.empty()) take(number, fields);
  }
}

/// NaN for what is no number.
double number_of(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? number : std::nan("");
}

bool is_share(double number) { return number >= 0.0 && number <= 1.0; }
bool is_whole(double number) { return number >= 0.0 && number == std::floor(number); }

/// The number of a class, if it is one.
std::optional<int> class_of(const std::string& text) {
  constexpr double kMost = 1e6;
  const double number = number_of(text);
  return is_whole(number) && number < kMost ? std::optional(static_cast<int>(number)) : std::nullopt;
}

/// Whether keypoints of two shares and a visibility, 0 to 2, follow the box.
/// @param most what the largest visibility is to be at least
bool has_keypoints(const Fields& fields, double most) {
  constexpr std::size_t kNumbers = 3;
  if (fields.size() <= kBox || (fields.size() - kBox) % kNumbers != 0) return false;
  double largest = 0.0;
  for (std::size_t i = kBox; i < fields.size(); ++i) {
    const double number = number_of(fields[i]);
    const bool is_visibility = (i - kBox) % kNumbers == kNumbers - 1;
    if (!(is_visibility ? number >= 0.0 && number <= 2.0 : is_share(number))) return false;
    if (is_visibility) largest = std::max(largest, number);
  }
  return largest >= most;
}

/// Whether the two fields after the box may be a confidence and the number of a track.
bool has_track(const Fields& fields) { return is_share(number_of(fields[5])) && is_whole(number_of(fields[6])); }

enum class Line { box, polygon, unknown };

Line kind_of(const Fields& fields, const YoloClasses& classes, const YoloLines& lines) {
  const std::size_t count = fields.size(), keypoints = static_cast<std::size_t>(classes.keypoint_numbers);
  if (count == kBox) return Line::box;
  if (count == kBoxAndOne) {
    const double last = number_of(fields[kBox]);
    return is_share(last) || is_whole(last) ? Line::box : Line::unknown;
  }
  constexpr std::size_t kConfidenceAndTrack = 2;
  if (keypoints > 0 && count >= kBox + keypoints && count <= kBox + keypoints + kConfidenceAndTrack) return Line::box;
  if (count < kLeastPolygon) return Line::unknown;
  if (count % 2 == 1) return lines.are_boxes(count) ? Line::box : Line::polygon;
  return has_keypoints(fields, 0.0) ? Line::box : Line::unknown;
}

/// What is around the box or the polygon, in shares of the picture.
struct Extent {
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
};

Extent extent_of(const Fields& fields, Line kind, const std::string& source, const std::string& field) {
  std::vector<double> across, down;
  for (std::size_t i = 1; i < (kind == Line::box ? kBox : fields.size()); ++i) {
    const double share = detail::parse_number(fields[i], source, field);
    if (!is_share(share))
      throw InputError(source, field,
                       fmt::format("found {}, expected shares of the picture's size, from 0 to 1", share));
    (i % 2 == 1 ? across : down).push_back(share);
  }
  if (kind == Line::box) {
    across = {across[0] - across[1] / 2.0, across[0] + across[1] / 2.0};
    down = {down[0] - down[1] / 2.0, down[0] + down[1] / 2.0};
  }
  const auto [left, right] = std::ranges::minmax(across);
  const auto [top, bottom] = std::ranges::minmax(down);
  return {left, top, right, bottom};
}

/// Of the box's own width and height.
double share_outside(const Extent& box) {
  return std::max({-box.left, box.right - 1.0, 0.0}) / (box.right - box.left) +
         std::max({-box.top, box.bottom - 1.0, 0.0}) / (box.bottom - box.top);
}

bool is_upright_as_corners(const Fields& fields, int width_px, int height_px) {
  const double wide_px = (number_of(fields[3]) - number_of(fields[1])) * width_px;
  const double high_px = (number_of(fields[4]) - number_of(fields[2])) * height_px;
  return wide_px > 0.0 && high_px > wide_px;
}

void sort_in(YoloClasses& classes, int number, const std::string& name) {
  const LabelKind kind = label_kind(name);
  classes.named.insert(number);
  if (kind == LabelKind::person) classes.people.insert(number);
  if (kind == LabelKind::unclear) classes.unclear.insert(number);
}

/// What is wrong with classes among which nobody is learnt from.
std::string no_person(const YoloClasses& classes) {
  return classes.unclear.empty() ? "no person or pedestrian among the classes"
                                 : "no person or pedestrian among the classes, but one that may hold riders or crowds; "
                                   "where each of its boxes is one person, call it person";
}

int keypoint_numbers_of(const YAML::Node& root, const std::string& source) {
  const YAML::Node shape = root["kpt_shape"];
  if (!shape) return 0;
  constexpr int kMostPoints = 1000;
  if (!shape.IsSequence() || shape.size() != 2 || !shape[0].IsScalar() || !shape[1].IsScalar())
    throw InputError(source, "kpt_shape", "expected the number of keypoints and of their numbers: [17, 3]");
  const int points = detail::parse_whole_number(shape[0].Scalar(), source, "kpt_shape");
  const int numbers = detail::parse_whole_number(shape[1].Scalar(), source, "kpt_shape");
  if (points < 1 || points > kMostPoints || numbers < 2 || numbers > 3)
    throw InputError(
        source, "kpt_shape",
        fmt::format("found {} keypoints of {} numbers, expected 1 to {} of 2 or 3", points, numbers, kMostPoints));
  return points * numbers;
}

}  // namespace

void YoloLines::add(std::string_view text) {
  for_each_line(text, [&](int, const Fields& fields) {
    constexpr double kVisible = 2.0;
    if (const auto of_class = class_of(fields[0])) ++labels_of_class_[*of_class];
    if (has_keypoints(fields, kVisible)) boxes_.insert(fields.size());
    if (fields.size() != kLeastPolygon) return;
    ++sevens_;
    if (!has_track(fields)) return;
    ++sevens_with_track_;
    if (number_of(fields.back()) > 1.0) boxes_.insert(kLeastPolygon);
  });
}

bool YoloLines::are_boxes(std::size_t fields) const {
  // Nobody draws all triangles down to the border.
  return boxes_.contains(fields) || (fields == kLeastPolygon && sevens_ > 0 && sevens_ == sevens_with_track_);
}

PictureLabels parse_yolo_labels(std::string_view text, const std::string& source, const YoloClasses& classes,
                                const YoloLines& lines, int width_px, int height_px) {
  PictureLabels labels;
  for_each_line(text, [&](int number, const Fields& fields) {
    const std::string field = fmt::format("line {}", number);
    const Line kind = kind_of(fields, classes, lines);
    if (kind == Line::unknown)
      throw InputError(
          source, field,
          fmt::format("found {} fields, expected YOLO's class, middle, width and height, or the corners of "
                      "a polygon; keypoints need kpt_shape in the YAML file of the set",
                      fields.size()));
    const int of_class = detail::parse_whole_number(fields[0], source, field);
    const bool is_person = classes.people.contains(of_class);
    if (!is_person && !classes.unclear.contains(of_class)) return;
    const Extent extent = extent_of(fields, kind, source, field);
    const ImageBox box = detail::box_between(extent.left * width_px, extent.top * height_px, extent.right * width_px,
                                             extent.bottom * height_px, source, field);
    const bool is_inside = share_outside(extent) <= kMaxTruncation;
    (is_person && is_inside ? labels.people : labels.unclear).push_back(box);
    if (!is_person) return;
    labels.leaving += !is_inside;
    labels.upright_as_corners += kind == Line::box && is_upright_as_corners(fields, width_px, height_px);
  });
  return labels;
}

YoloClasses parse_yolo_names(std::string_view text, const std::string& source) {
  YoloClasses classes{.people = {}, .unclear = {}, .source = source};
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line); ++number)
    if (const auto name = detail::trimmed(line); !name.empty()) sort_in(classes, number, std::string(name));
  if (classes.people.empty()) throw InputError(source, "", "names " + no_person(classes));
  return classes;
}

std::optional<YoloClasses> parse_yolo_yaml(const std::string& text, const std::string& source) {
  const YAML::Node root = detail::load_yaml(plain_text(text), source);
  if (!root.IsMap() || !root["names"]) return std::nullopt;
  const YAML::Node names = root["names"];
  YoloClasses classes{
      .people = {}, .unclear = {}, .keypoint_numbers = keypoint_numbers_of(root, source), .source = source};
  int number = 0;
  for (const auto& entry : names) {
    const YAML::Node& name = names.IsMap() ? entry.second : entry;
    const std::string key = names.IsMap() ? entry.first.Scalar() : std::to_string(number);
    if (name.IsScalar() && label_kind(name.Scalar()) != LabelKind::other)
      sort_in(classes, detail::parse_whole_number(key, source, "names"), name.Scalar());
    else if (const auto of_class = class_of(key))
      classes.named.insert(*of_class);
    ++number;
  }
  if (classes.people.empty()) throw InputError(source, "names", "holds " + no_person(classes));
  return classes;
}

}  // namespace flies
