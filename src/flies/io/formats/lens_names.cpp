#include "flies/io/formats/lens_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"

namespace flies::detail {
namespace {

struct NamedLens {
  const char* name;
  Lens lens;
};

/// As ROS, Kalibr, EuRoC, ORB-SLAM, Basalt, COLMAP, RealSense (the first word) and OpenCV's users write them.
constexpr NamedLens kLenses[] = {{"", Lens::brown},
                                 {"none", Lens::brown},
                                 {"pinhole", Lens::brown},
                                 {"perspective", Lens::brown},
                                 {"plumb_bob", Lens::brown},
                                 {"radtan", Lens::brown},
                                 {"radial-tangential", Lens::brown},
                                 {"radialtangential", Lens::brown},
                                 {"radialtangential8", Lens::brown},
                                 {"rational_polynomial", Lens::brown},
                                 {"thin_prism", Lens::brown},
                                 {"brown", Lens::brown},
                                 {"brown_conrady", Lens::brown},
                                 {"opencv", Lens::brown},
                                 {"pinhole-radtan8", Lens::brown},
                                 {"equidistant", Lens::equidistant},
                                 {"equi", Lens::equidistant},
                                 {"fisheye", Lens::equidistant},
                                 {"opencv_fisheye", Lens::equidistant},
                                 {"kb4", Lens::equidistant},
                                 {"kannala", Lens::equidistant},
                                 {"kannala_brandt", Lens::equidistant},
                                 {"kannala_brandt4", Lens::equidistant},
                                 {"kannala_brandt8", Lens::equidistant},
                                 {"kannala-brandt", Lens::equidistant},
                                 {"kannalabrandt", Lens::equidistant},
                                 {"kannalabrandt4", Lens::equidistant},
                                 {"kannalabrandt8", Lens::equidistant},
                                 {"ds", Lens::double_sphere},
                                 {"double_sphere", Lens::double_sphere},
                                 {"eucm", Lens::unified},
                                 {"ucm", Lens::unified},
                                 {"omni", Lens::mei},
                                 {"mei", Lens::mei},
                                 {"fov", Lens::fov}};

bool is_one_of(const std::string& word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Letters and no side: "distortionmodel" of "left_distortionModel_1".
std::string plain_part(std::string_view part) {
  std::string name, word;
  const auto end_word = [&] {
    if (!is_one_of(word, {"left", "right", "l", "r", "cam"})) name += word;
    word.clear();
  };
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto letter = static_cast<unsigned char>(part[i]);
    const bool is_hump = i > 0 && std::isupper(letter) && std::islower(static_cast<unsigned char>(part[i - 1]));
    if (is_hump || !std::isalpha(letter)) end_word();
    if (std::isalpha(letter)) word += static_cast<char>(std::tolower(letter));
  }
  end_word();
  return name;
}

/// The last part of a key that says more than which camera it is of: that of "left.distortion_model" and
/// "distortion_model.right".
std::string plain_name(std::string_view key) {
  while (true) {
    const auto dot = key.rfind('.');
    auto name = plain_part(dot == std::string_view::npos ? key : key.substr(dot + 1));
    if (!name.empty() || dot == std::string_view::npos) return name;
    key = key.substr(0, dot);
  }
}

/// Whether an entry such as `is_fisheye: true` says yes or no; nothing when it says neither.
std::optional<bool> answer_of(const NumberEntry& entry, const std::string& word) {
  if (is_one_of(word, {"true", "yes", "on"})) return true;
  if (is_one_of(word, {"false", "no", "off"})) return false;
  if (entry.numbers.size() != 1 || !word.empty()) return std::nullopt;
  if (entry.numbers[0] == 0.0) return false;
  return entry.numbers[0] == 1.0 ? std::optional(true) : std::nullopt;
}

/// What is said of the lenses in one place and must not be contradicted in another.
struct SaidLens {
  std::optional<Lens> lens;
  std::string key;
  bool is_no_fisheye = false;
};

void add(const std::string& key, const NumberEntry& entry, const NumberTable& table, SaidLens& said) {
  const std::string name = plain_name(key), word = table.word(key);
  std::optional<Lens> lens;
  if (is_one_of(name, {"distortionmodel", "distortiontype"})) {
    if (!is_one_of(word, {"", "pinhole", "perspective", "none"}))  // which say nothing of what bends rays
      lens = lens_of(word, key, table.source);
  } else if (is_one_of(name, {"cameramodel", "lensmodel", "model", "lens", "lenstype", "cameratype", "calibrationtype",
                              "projection"})) {
    if (!is_one_of(word, {"", "pinhole", "perspective", "none"})) lens = known_lens(word);  // or the name of a product
  } else if (is_one_of(name, {"fisheye", "isfisheye", "usefisheye", "fisheyemodel", "fisheyelens"})) {
    const auto answer = answer_of(entry, word);
    if (answer == false) said.is_no_fisheye = true;
    lens = answer == true ? Lens::equidistant : word.empty() ? std::nullopt : known_lens(word);
  }
  if (!lens) return;
  if (said.lens && *said.lens != *lens)
    throw InputError(table.source, key,
                     fmt::format("says that the lens is of the {} model, and {} that it is of the {} one, expected the "
                                 "same of both cameras",
                                 lens_name(*lens), said.key, lens_name(*said.lens)));
  said.lens = lens;
  said.key = key;
}

}  // namespace

std::optional<Lens> known_lens(const std::string& word) {
  constexpr std::string_view kOfRealSense = "distortion.";  // as its values print in Python
  std::string_view name = word;
  if (name.starts_with(kOfRealSense)) name.remove_prefix(kOfRealSense.size());
  const auto* found =
      std::find_if(std::begin(kLenses), std::end(kLenses), [&](const NamedLens& lens) { return name == lens.name; });
  return found == std::end(kLenses) ? std::nullopt : std::optional(found->lens);
}

Lens lens_of(const std::string& word, const std::string& key, const std::string& source) {
  if (const auto lens = known_lens(word)) return *lens;
  throw InputError(source, key,
                   fmt::format("found '{}', expected plumb_bob, radtan, rational_polynomial, equidistant, fisheye, ds, "
                               "eucm, omni or fov",
                               word));
}

Lens named_lens(const NumberTable& table) {
  SaidLens said;
  for (const auto& [key, entry] : table.entries) add(key, entry, table, said);
  if (said.lens || said.is_no_fisheye) return said.lens.value_or(Lens::brown);
  for (const auto& [key, entry] : table.entries) {
    const std::string word = table.word(key);
    const bool is_path = word.find_first_of("/\\") != std::string::npos;
    if (!is_path && (word.find("fisheye") != std::string::npos || word.find("equidistant") != std::string::npos))
      throw InputError(table.source, key,
                       fmt::format("found '{}', and no model of the lens: say distortion_model: equidistant, or "
                                   "plumb_bob where it is no fisheye",
                                   word));
  }
  return Lens::brown;
}

}  // namespace flies::detail
