#include "flies/train/picture_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/text_file.hpp"
#include "flies/train/label_kind.hpp"

namespace flies {
namespace {

constexpr std::size_t kMinKittiFields = 15;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream{line};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// What stands between the first two quotation marks.
std::string quoted_in(const std::string& text) {
  const auto first = text.find('"'), last = text.find('"', first + 1);
  return first == std::string::npos || last == std::string::npos ? "" : text.substr(first + 1, last - first - 1);
}

/// "(164, 176) - (433, 784)", "1124 x 826 x 3".
std::vector<double> numbers_in(std::string text, const std::string& source, const std::string& field) {
  std::ranges::replace_if(
      text, [](char c) { return c == '(' || c == ')' || c == ',' || c == 'x'; }, ' ');
  std::vector<double> numbers;
  for (const auto& word : words_of(text))
    if (word != "-") numbers.push_back(detail::parse_number(word, source, field));
  return numbers;
}

/// Whether an element of an object says yes, or how much of it: 1, true, 0.3.
bool is_set(const pugi::xml_node& object, const char* flag) {
  const pugi::xml_text text = object.child(flag).text();
  return text.as_bool() || text.as_double() > kMaxTruncation;
}

double coordinate(const pugi::xml_node& box, const char* name, const std::string& source, const std::string& field) {
  return detail::parse_number(detail::trimmed(box.child_value(name)), source, fmt::format("{}.bndbox.{}", field, name));
}

constexpr int kFewest = 10;  // boxes: fewer people may all sit or lie

}  // namespace

namespace detail {

ImageBox box_between(double left, double top, double right, double bottom, const std::string& source,
                     const std::string& field) {
  if (!(right > left && bottom > top))
    throw InputError(
        source, field,
        fmt::format("found the box {} {} {} {}, expected left < right and top < bottom", left, top, right, bottom));
  return {left, top, right - left, bottom - top};
}

}  // namespace detail

void PeopleCheck::add(const PictureLabels& labels, const std::string& source) {
  const auto is_wide = [](const ImageBox& box) { return box.width_px > box.height_px; };
  const auto wide = static_cast<int>(std::ranges::count_if(labels.people, is_wide));
  const int odd = wide + labels.leaving;
  if (wide > 0 && wide_ == 0) first_wide_ = source;
  if (odd > 0 && odd_ == 0) first_odd_ = source;
  people_ += static_cast<int>(labels.people.size());
  boxes_ += static_cast<int>(labels.people.size()) + labels.leaving;
  wide_ += wide;
  odd_ += odd;
  upright_as_corners_ += labels.upright_as_corners;
}

void PeopleCheck::finish() const {
  constexpr double kNearlyAll = 0.9, kTooMany = 0.2;  // people at the border leave the picture, a few lie
  if (boxes_ >= kFewest && upright_as_corners_ >= kNearlyAll * boxes_ && odd_ >= kTooMany * boxes_)
    throw InputError(first_odd_, "",
                     fmt::format("of {} boxes of the set {} are wider than tall or leave the picture, but {} stand "
                                 "upright as left, top, right and bottom: expected YOLO's middle, width and height",
                                 boxes_, odd_, upright_as_corners_));
  if (people_ >= kFewest && 2 * wide_ > people_)
    throw InputError(first_wide_, "",
                     fmt::format("of {} people of the set {} are wider than tall, expected people who stand: are x and "
                                 "y, or width and height, exchanged, or the corners taken for something else?",
                                 people_, wide_));
}

PictureLabels parse_voc_labels(std::string_view xml, const std::string& source) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) throw InputError(source, fmt::format("byte {}", parsed.offset), parsed.description());
  const pugi::xml_node root = document.child("annotation");
  if (!root) throw InputError(source, "annotation", "not found, expected a Pascal VOC annotation");

  PictureLabels labels;
  labels.picture = detail::trimmed(root.child_value("filename"));
  const int width_px = root.child("size").child("width").text().as_int(),
            height_px = root.child("size").child("height").text().as_int();
  if (width_px > 0 && height_px > 0) labels.width_px = width_px, labels.height_px = height_px;
  int number = 0;
  for (const pugi::xml_node object : root.children("object")) {
    const std::string field = fmt::format("object {}", ++number);
    const LabelKind kind = label_kind(detail::trimmed(object.child_value("name")));
    if (kind == LabelKind::other) continue;
    const pugi::xml_node box = object.child("bndbox");
    const auto value = [&](const char* name) { return coordinate(box, name, source, field); };
    const double left = value("xmin"), top = value("ymin"), right = value("xmax"), bottom = value("ymax");
    const ImageBox person = detail::box_between(left, top, right, bottom, source, field);
    const bool is_clear = kind == LabelKind::person && !is_set(object, "difficult") && !is_set(object, "truncated") &&
                          !is_set(object, "occluded");
    (is_clear ? labels.people : labels.unclear).push_back(person);
  }
  return labels;
}

std::vector<KittiPersonLabel> parse_kitti_people(std::string_view text, const std::string& source) {
  std::vector<KittiPersonLabel> labels;
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    const std::string field = fmt::format("line {}", ++number);
    const auto fields = words_of(line);
    if (fields.empty()) continue;
    if (fields.size() < kMinKittiFields)
      throw InputError(source, field, fmt::format("found {} fields, expected {}", fields.size(), kMinKittiFields));
    const LabelKind kind = label_kind(fields[0]);
    if (kind == LabelKind::other) continue;
    const auto value = [&](std::size_t i) { return detail::parse_number(fields[i], source, field); };
    labels.push_back({.is_person = kind == LabelKind::person,
                      .truncation = value(1),
                      .occlusion = value(2),
                      .box = detail::box_between(value(4), value(5), value(6), value(7), source, field)});
  }
  return labels;
}

PictureLabels parse_kitti_boxes(std::string_view text, const std::string& source) {
  PictureLabels labels;
  for (const auto& label : parse_kitti_people(text, source)) {
    const bool is_clear = label.is_person && label.truncation <= kMaxTruncation && label.occlusion == 0.0;
    (is_clear ? labels.people : labels.unclear).push_back(label.box);
  }
  return labels;
}

bool is_pascal_text(std::string_view text) { return plain_text(std::string(text)).starts_with("# PASCAL Annotation"); }

PictureLabels parse_pascal_text(std::string_view text, const std::string& source) {
  PictureLabels labels;
  for (const auto& line : detail::lines_of(text)) {
    const std::string field = fmt::format("line {}", line.number);
    const auto colon = line.content.find(" : ");
    if (colon == std::string::npos) continue;
    const std::string value = line.content.substr(colon + 3);
    if (line.content.starts_with("Image filename")) labels.picture = quoted_in(value);
    if (line.content.starts_with("Image size")) {
      const auto size = numbers_in(value, source, field);
      if (size.size() >= 2) labels.width_px = static_cast<int>(size[0]), labels.height_px = static_cast<int>(size[1]);
    }
    if (!line.content.starts_with("Bounding box for object")) continue;
    const LabelKind kind = label_kind(quoted_in(line.content));
    if (kind == LabelKind::other) continue;
    const auto corners = numbers_in(value, source, field);
    if (corners.size() != 4)
      throw InputError(source, field, fmt::format("found {} numbers, expected a box of four", corners.size()));
    const ImageBox box = detail::box_between(corners[0], corners[1], corners[2], corners[3], source, field);
    (kind == LabelKind::person ? labels.people : labels.unclear).push_back(box);
  }
  return labels;
}

}  // namespace flies
