#include "flies/train/picture_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <pugixml.hpp>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/text_file.hpp"
#include "flies/io/yaml_text.hpp"

namespace flies {
namespace {

constexpr std::array<std::string_view, 3> kPeople = {"person", "pedestrian", "pasperson"};
constexpr std::array<std::string_view, 3> kKittiUnclear = {"Person_sitting", "Cyclist", "DontCare"};
constexpr double kMaxTruncation = 0.1;  // a tenth of a person outside the picture is no more than a jitter
constexpr std::size_t kMinKittiFields = 15;

template <class Names>
bool is_one_of(std::string_view name, const Names& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_person(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return is_one_of(lower, kPeople);
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream{line};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

ImageBox box_between(double left, double top, double right, double bottom, const std::string& source,
                     const std::string& field) {
  if (!(right > left && bottom > top))
    throw InputError(
        source, field,
        fmt::format("found the box {} {} {} {}, expected left < right and top < bottom", left, top, right, bottom));
  return {left, top, right - left, bottom - top};
}

double coordinate(const pugi::xml_node& box, const char* name, const std::string& source, const std::string& field) {
  return detail::parse_number(detail::trimmed(box.child_value(name)), source, fmt::format("{}.bndbox.{}", field, name));
}

constexpr int kFewest = 10;  // boxes: fewer people may all sit or lie

}  // namespace

void PeopleCheck::add(const PictureLabels& labels, const std::string& source) {
  const auto is_wide = [](const ImageBox& box) { return box.width_px > box.height_px; };
  const auto wide = static_cast<int>(std::ranges::count_if(labels.people, is_wide));
  const int odd = wide + static_cast<int>(labels.unclear.size());
  if (wide > 0 && wide_ == 0) first_wide_ = source;
  if (odd > 0 && odd_ == 0) first_odd_ = source;
  people_ += static_cast<int>(labels.people.size());
  boxes_ += static_cast<int>(labels.people.size() + labels.unclear.size());
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
    if (!is_person(detail::trimmed(object.child_value("name")))) continue;
    const pugi::xml_node box = object.child("bndbox");
    const auto value = [&](const char* name) { return coordinate(box, name, source, field); };
    const double left = value("xmin"), top = value("ymin"), right = value("xmax"), bottom = value("ymax");
    const ImageBox person = box_between(left, top, right, bottom, source, field);
    const auto is_set = [&](const char* flag) { return object.child(flag).text().as_int() != 0; };
    const bool is_clear = !is_set("difficult") && !is_set("truncated") && !is_set("occluded");
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
    const bool tells_of_person = is_person(fields[0]);
    if (!tells_of_person && !is_one_of(fields[0], kKittiUnclear)) continue;
    const auto value = [&](std::size_t i) { return detail::parse_number(fields[i], source, field); };
    labels.push_back({.is_person = tells_of_person,
                      .truncation = value(1),
                      .occlusion = value(2),
                      .box = box_between(value(4), value(5), value(6), value(7), source, field)});
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

PictureLabels parse_yolo_labels(std::string_view text, const std::string& source, int person, int width_px,
                                int height_px) {
  constexpr std::size_t kBox = 5, kLeastPolygon = 7;
  PictureLabels labels;
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    const std::string field = fmt::format("line {}", ++number);
    const auto fields = words_of(line.substr(0, line.find('#')));
    if (fields.empty()) continue;
    const bool is_polygon = fields.size() >= kLeastPolygon && fields.size() % 2 == 1;
    if (fields.size() != kBox && !is_polygon)
      throw InputError(source, field,
                       fmt::format("found {} fields, expected YOLO's class, middle, width and height", fields.size()));
    if (detail::parse_whole_number(fields[0], source, field) != person) continue;
    std::vector<double> across, down;
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const double share = detail::parse_number(fields[i], source, field);
      if (share < 0.0 || share > 1.0)
        throw InputError(source, field,
                         fmt::format("found {}, expected shares of the picture's size, from 0 to 1", share));
      (i % 2 == 1 ? across : down).push_back(share);
    }
    if (!is_polygon) {
      const double wide_px = (across[1] - across[0]) * width_px, high_px = (down[1] - down[0]) * height_px;
      if (wide_px > 0.0 && high_px > wide_px) ++labels.upright_as_corners;
      across = {across[0] - across[1] / 2.0, across[0] + across[1] / 2.0};
      down = {down[0] - down[1] / 2.0, down[0] + down[1] / 2.0};
    }
    const auto [left, right] = std::ranges::minmax(across);
    const auto [top, bottom] = std::ranges::minmax(down);
    const double outside =
        std::max({-left, right - 1.0, 0.0}) / (right - left) + std::max({-top, bottom - 1.0, 0.0}) / (bottom - top);
    const ImageBox box =
        box_between(left * width_px, top * height_px, right * width_px, bottom * height_px, source, field);
    (outside <= kMaxTruncation ? labels.people : labels.unclear).push_back(box);
  }
  return labels;
}

int parse_yolo_names(std::string_view text, const std::string& source) {
  std::istringstream stream{plain_text(std::string(text))};
  int number = 0;
  for (std::string line; std::getline(stream, line); ++number)
    if (is_person(detail::trimmed(line))) return number;
  throw InputError(source, "", "names no person or pedestrian among the classes");
}

std::optional<int> parse_yolo_yaml(const std::string& text, const std::string& source) {
  const YAML::Node root = detail::load_yaml(plain_text(text), source);
  if (!root.IsMap() || !root["names"]) return std::nullopt;
  const YAML::Node names = root["names"];
  int number = 0;
  for (const auto& entry : names) {
    const YAML::Node& name = names.IsMap() ? entry.second : entry;
    if (name.IsScalar() && is_person(name.Scalar()))
      return names.IsMap() ? detail::parse_whole_number(entry.first.Scalar(), source, "names") : number;
    ++number;
  }
  throw InputError(source, "names", "holds no person or pedestrian");
}

}  // namespace flies
