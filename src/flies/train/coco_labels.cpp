#include "flies/train/coco_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "flies/core/convert.hpp"
#include "flies/core/error.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/text_file.hpp"
#include "flies/train/label_kind.hpp"

namespace flies {
namespace {

using nlohmann::json;

/// An entry of one of the lists, for errors.
struct Entry {
  const json& object;
  const std::string& source;
  std::string field;  ///< "images[2]"

  [[noreturn]] void fail(std::string_view key, const std::string& complaint) const {
    throw InputError(source, fmt::format("{}.{}", field, key), complaint);
  }
  const json& at(const char* key) const {
    const auto found = object.find(key);
    if (found == object.end()) fail(key, "is missing");
    return *found;
  }
  double number(const json& value, std::string_view key) const {
    if (!value.is_number()) fail(key, fmt::format("found {}, expected a number", value.type_name()));
    detail::check_number(value.get<double>(), source, fmt::format("{}.{}", field, key));
    return value.get<double>();
  }
  std::string text(const char* key) const {
    const json& value = at(key);
    if (!value.is_string()) fail(key, fmt::format("found {}, expected a text", value.type_name()));
    return value.get<std::string>();
  }
  /// Numbers, or texts, that only tell entries apart.
  std::string id(const char* key) const {
    const json& value = at(key);
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_number_integer()) fail(key, fmt::format("found {}, expected a whole number", value.type_name()));
    return value.dump();
  }
  /// 1 or true.
  bool is_set(const char* key) const {
    const auto found = object.find(key);
    if (found == object.end()) return false;
    return found->is_boolean() ? found->get<bool>() : found->is_number() && found->get<double>() != 0.0;
  }
};

template <class Take>
void for_each_entry(const json& root, const char* list, const std::string& source, const Take& take) {
  std::size_t index = 0;
  for (const json& object : root.at(list)) {
    const std::string field = fmt::format("{}[{}]", list, index++);
    if (!object.is_object())
      throw InputError(source, field, fmt::format("found {}, expected an object", object.type_name()));
    take(Entry{object, source, field});
  }
}

std::vector<double> box_of(const Entry& annotation) {
  const json& box = annotation.at("bbox");
  if (!box.is_array() || box.size() != 4) annotation.fail("bbox", "expected left, top, width and height");
  std::vector<double> numbers;
  for (const json& number : box) numbers.push_back(annotation.number(number, "bbox"));
  if (numbers[2] < 0.0 || numbers[3] < 0.0)
    annotation.fail("bbox", fmt::format("found a width of {} and a height of {} px, expected none below 0", numbers[2],
                                        numbers[3]));
  return numbers;
}

bool is_clear(const Entry& annotation) {
  if (annotation.is_set("iscrowd") || annotation.is_set("ignore")) return false;
  const auto attributes = annotation.object.find("attributes");
  if (attributes == annotation.object.end() || !attributes->is_object()) return true;
  const Entry inside{*attributes, annotation.source, annotation.field};
  return !inside.is_set("occluded") && !inside.is_set("truncated") && !inside.is_set("difficult");
}

int side_of(const Entry& image, const char* key) {
  if (!image.object.contains(key)) return 0;
  return whole_number<int>(image.number(image.at(key), key)).value_or(0);
}

}  // namespace

std::vector<PictureLabels> parse_coco_labels(const std::string& text, const std::string& source) {
  const json root = json::parse(plain_text(text), nullptr, false);
  constexpr std::array kLists = {"images", "annotations", "categories"};
  const auto is_list = [&](const char* list) { return root.contains(list) && root.at(list).is_array(); };
  if (!root.is_object() || !std::ranges::all_of(kLists, is_list))
    throw InputError(source, "",
                     root.is_discarded()
                         ? "is no JSON, expected COCO's labels"
                         : "is JSON, but not as COCO's labels are, with images, annotations and "
                           "categories; other labels in JSON are not read, and a file without labels is to be "
                           "moved away");
  std::map<std::string, LabelKind> kinds;
  for_each_entry(root, "categories", source,
                 [&](const Entry& category) { kinds[category.id("id")] = label_kind(category.text("name")); });
  std::vector<PictureLabels> pictures;
  std::map<std::string, std::size_t> by_id;
  for_each_entry(root, "images", source, [&](const Entry& image) {
    if (!by_id.emplace(image.id("id"), pictures.size()).second) image.fail("id", "found twice");
    PictureLabels& labels = pictures.emplace_back();
    labels.picture = image.text("file_name");
    labels.width_px = side_of(image, "width");
    labels.height_px = side_of(image, "height");
  });
  for_each_entry(root, "annotations", source, [&](const Entry& annotation) {
    const auto kind = kinds.find(annotation.id("category_id"));
    if (kind == kinds.end()) annotation.fail("category_id", "found none of the categories");
    if (kind->second == LabelKind::other) return;
    const auto picture = by_id.find(annotation.id("image_id"));
    if (picture == by_id.end()) annotation.fail("image_id", "found none of the images");
    const auto box = box_of(annotation);
    if (box[2] == 0.0 || box[3] == 0.0) return;
    PictureLabels& labels = pictures[picture->second];
    const bool is_person = kind->second == LabelKind::person && is_clear(annotation);
    (is_person ? labels.people : labels.unclear).push_back({box[0], box[1], box[2], box[3]});
  });
  return pictures;
}

}  // namespace flies
