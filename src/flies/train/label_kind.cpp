#include "flies/train/label_kind.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "flies/core/letters.hpp"

namespace flies {
namespace {

constexpr std::array<std::string_view, 9> kPeople = {"person",    "pedestrian",        "human",
                                                     "persons",   "pedestrians",       "humans",
                                                     "pasperson", "paspersonstanding", "paspersonwalking"};
constexpr std::array<std::string_view, 8> kHoldsPerson = {"person",  "pedestrian", "human",    "people",
                                                          "cyclist", "rider",      "dontcare", "crowd"};

}  // namespace

LabelKind label_kind(std::string_view name) {
  std::string plain = detail::in_small_letters(name);  // "person?" is not "person"
  std::erase_if(plain, [](char c) { return c == '-' || c == '_' || c == ' '; });
  if (std::ranges::find(kPeople, plain) != kPeople.end()) return LabelKind::person;
  const auto is_in_it = [&](std::string_view part) { return plain.find(part) != std::string::npos; };
  const bool is_unclear = std::ranges::any_of(kHoldsPerson, is_in_it) || plain.starts_with("ignore");
  return is_unclear ? LabelKind::unclear : LabelKind::other;
}

}  // namespace flies
