#include "flies/train/picture_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <pugixml.hpp>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"

namespace flies {
namespace {

constexpr std::array<std::string_view, 3> kVocPeople = {"person", "pedestrian", "PASperson"};
constexpr std::array<std::string_view, 3> kKittiUnclear = {"Person_sitting", "Cyclist", "DontCare"};
constexpr double kMaxTruncation = 0.1;  // a tenth of a person outside the picture is no more than a jitter
constexpr std::size_t kMinKittiFields = 15;

template <class Names>
bool is_one_of(std::string_view name, const Names& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
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

}  // namespace

PictureLabels parse_voc_labels(std::string_view xml, const std::string& source) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) throw InputError(source, fmt::format("byte {}", parsed.offset), parsed.description());
  const pugi::xml_node root = document.child("annotation");
  if (!root) throw InputError(source, "annotation", "not found, expected a Pascal VOC annotation");

  PictureLabels labels;
  labels.picture = detail::trimmed(root.child_value("filename"));
  int number = 0;
  for (const pugi::xml_node object : root.children("object")) {
    const std::string field = fmt::format("object {}", ++number);
    if (!is_one_of(detail::trimmed(object.child_value("name")), kVocPeople)) continue;
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

PictureLabels parse_kitti_boxes(std::string_view text, const std::string& source) {
  PictureLabels labels;
  std::istringstream stream{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    const std::string field = fmt::format("line {}", ++number);
    std::istringstream words{line};
    std::vector<std::string> fields;
    for (std::string word; words >> word;) fields.push_back(word);
    if (fields.empty()) continue;
    if (fields.size() < kMinKittiFields)
      throw InputError(source, field, fmt::format("found {} fields, expected {}", fields.size(), kMinKittiFields));
    const bool is_person = fields[0] == "Pedestrian";
    if (!is_person && !is_one_of(fields[0], kKittiUnclear)) continue;
    const auto value = [&](std::size_t i) { return detail::parse_number(fields[i], source, field); };
    const ImageBox box = box_between(value(4), value(5), value(6), value(7), source, field);
    const bool is_clear = is_person && value(1) <= kMaxTruncation && value(2) == 0.0;
    (is_clear ? labels.people : labels.unclear).push_back(box);
  }
  return labels;
}

}  // namespace flies
