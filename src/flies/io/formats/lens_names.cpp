#include "flies/io/formats/lens_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/formats/distortion_names.hpp"

namespace flies::detail {
namespace {

struct NamedLens {
  const char* name;
  std::optional<Lens> lens;  ///< nothing: a model that is not read
};

/// As ROS, Kalibr, EuRoC, ORB-SLAM, Basalt, COLMAP, camodocal, RealSense and OpenCV's users write them, in small
/// letters and digits alone. Of RealSense's also the first word, as files that are no text of librealsense are read by
/// words.
constexpr NamedLens kLenses[] = {{"", Lens::brown},
                                 {"none", Lens::brown},
                                 {"pinhole", Lens::brown},
                                 {"perspective", Lens::brown},
                                 {"plumbbob", Lens::brown},
                                 {"radtan", Lens::brown},
                                 {"radtan5", Lens::brown},
                                 {"radtan8", Lens::brown},
                                 {"radialtangential", Lens::brown},
                                 {"radialtangential8", Lens::brown},
                                 {"rational", Lens::brown},
                                 {"rationalpolynomial", Lens::brown},
                                 {"thinprism", Lens::brown},
                                 {"brown", Lens::brown},
                                 {"brownconrady", Lens::brown},
                                 {"opencv", Lens::brown},
                                 {"fullopencv", Lens::brown},
                                 {"pinholeradtan", Lens::brown},
                                 {"pinholeradtan8", Lens::brown},
                                 {"equidistant", Lens::equidistant},
                                 {"equi", Lens::equidistant},
                                 {"fisheye", Lens::equidistant},
                                 {"opencvfisheye", Lens::equidistant},
                                 {"fisheyeopencv", Lens::equidistant},
                                 {"pinholeequi", Lens::equidistant},
                                 {"pinholeequidistant", Lens::equidistant},
                                 {"kb", Lens::equidistant},
                                 {"kb4", Lens::equidistant},
                                 {"kb8", Lens::equidistant},
                                 {"kannala", Lens::equidistant},
                                 {"kannalabrandt", Lens::equidistant},
                                 {"kannalabrandt4", Lens::equidistant},
                                 {"kannalabrandt8", Lens::equidistant},
                                 {"ds", Lens::double_sphere},
                                 {"doublesphere", Lens::double_sphere},
                                 {"eucm", Lens::unified},
                                 {"ucm", Lens::unified},
                                 {"omni", Lens::mei},
                                 {"omnidir", Lens::mei},
                                 {"omnidirectional", Lens::mei},
                                 {"omniradtan", Lens::mei},
                                 {"catadioptric", Lens::mei},
                                 {"mei", Lens::mei},
                                 {"fov", Lens::fov},
                                 {"pinholefov", Lens::fov},
                                 {"ftheta", {}},
                                 {"inversebrownconrady", {}},
                                 {"inverse", {}},
                                 {"modifiedbrownconrady", {}},
                                 {"modified", {}},
                                 {"ocam", {}},
                                 {"ocamcalib", {}},
                                 {"scaramuzza", {}},
                                 {"stereographic", {}},
                                 {"equisolid", {}},
                                 {"equisolidangle", {}},
                                 {"orthographic", {}},
                                 {"equirectangular", {}},
                                 {"cylinder", {}},
                                 {"cylindrical", {}},
                                 {"spherical", {}},
                                 {"division", {}},
                                 {"kb6", {}},
                                 {"fisheye62", {}},
                                 {"fisheye624", {}},
                                 {"radialfisheye", {}},
                                 {"simpleradialfisheye", {}},
                                 {"thinprismfisheye", {}}};

/// By RealSense's numbers (rs2_distortion).
constexpr const char* kRealSenseModels[] = {"none",   "modified_brown_conrady", "inverse_brown_conrady",
                                            "ftheta", "brown_conrady",          "kannala_brandt4"};

bool is_one_of(const std::string& word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Letters and digits: "kannalabrandt4" of "RS2_DISTORTION_KANNALA_BRANDT4" and of "<distortion.kannala_brandt4: 5>",
/// of which the first word is read.
std::string plain_word(std::string_view word) {
  std::string plain = plain_letters(word);
  for (const std::string_view of_realsense : {"rs2distortion", "distortion"})
    if (plain.starts_with(of_realsense)) plain.erase(0, of_realsense.size());
  return plain;
}

const NamedLens* find_lens(std::string_view word) {
  const auto* found = std::ranges::find(kLenses, plain_word(word), &NamedLens::name);
  return found == std::end(kLenses) ? nullptr : found;
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

/// What a key such as `use_fisheye_model` begins and ends with beside the word that counts.
bool asks_for_fisheye(std::string name) {
  for (const std::string_view start : {"is", "use"})
    if (name.starts_with(start)) name.erase(0, start.size());
  for (const std::string_view end : {"model", "lens", "camera"})
    if (name.ends_with(end)) name.erase(name.size() - end.size());
  return name == "fisheye";
}

/// What stands before the last part of a key: "left." of "left.model".
std::string_view place_of(std::string_view key) {
  const auto dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : key.substr(0, dot + 1);
}

/// Whether coefficients of distortion that stand there, or below, are not all 0.
bool bends_rays(const NumberTable& table, std::string_view place) {
  constexpr std::string_view kOneByOne[] = {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"};
  return std::ranges::any_of(table.entries, [&](const auto& item) {
    const std::string_view key = item.first;
    if (!key.starts_with(place)) return false;
    const bool holds_coefficients =
        is_distortion_name(plain_name(key)) ||
        std::ranges::find(kOneByOne, key.substr(place_of(key).size())) != std::end(kOneByOne);
    return holds_coefficients && std::ranges::any_of(item.second.numbers, [](double c) { return c != 0.0; });
  });
}

/// The model that a key names, by RealSense's number where its intrinsics stand beside it.
std::string model_at(const std::string& key, const NumberEntry& entry, const NumberTable& table) {
  const std::string place(place_of(key));
  const bool is_realsense = table.has(place + "ppx") || table.has(place + "coeffs");
  if (!is_realsense || !entry.not_a_number.empty() || entry.numbers.size() != 1) return table.word(key);
  for (std::size_t i = 0; i < std::size(kRealSenseModels); ++i)
    if (entry.numbers[0] == static_cast<double>(i)) return kRealSenseModels[i];
  return table.word(key);
}

/// What is said of the lenses in one place and must not be contradicted in another.
struct SaidLens {
  std::optional<Lens> lens;
  std::string key;
  bool is_no_fisheye = false;
};

/// The lens that one entry names, if it does.
std::optional<Lens> lens_at(const std::string& key, const NumberEntry& entry, const NumberTable& table, SaidLens& said,
                            CalibrationNotes& notes) {
  const std::string name = plain_name(key);
  if (is_one_of(name, {"distortionmodel", "distortiontype", "projectionmodel", "projectiontype", "modeltype"}))
    return lens_of_model(model_at(key, entry, table), bends_rays(table, place_of(key)), key, table.source);
  if (is_one_of(name, {"cameramodel", "lensmodel", "model", "lens", "lenstype", "cameratype", "calibrationtype",
                       "projection"})) {
    const std::string word = model_at(key, entry, table);
    if (find_lens(word) != nullptr) return lens_of_model(word, bends_rays(table, place_of(key)), key, table.source);
    if (!is_one_of(name, {"cameratype", "calibrationtype"}))
      notes.push_back({fmt::format("{}: '{}' is not a known lens model, and is taken as a product name: if it is a "
                                   "model, name it with distortion_model",
                                   key, word),
                       CalibrationNoteKind::told});
    return std::nullopt;
  }
  if (!asks_for_fisheye(name)) return std::nullopt;
  const std::string word = table.word(key);
  const auto answer = answer_of(entry, word);
  if (answer == false) said.is_no_fisheye = true;
  return answer == true ? Lens::equidistant : word.empty() ? std::nullopt : known_lens(word);
}

void add(const std::string& key, const NumberEntry& entry, const NumberTable& table, SaidLens& said,
         CalibrationNotes& notes) {
  const auto lens = lens_at(key, entry, table, said, notes);
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
  const NamedLens* found = find_lens(word);
  return found == nullptr ? std::nullopt : found->lens;
}

Lens lens_of(const std::string& word, const std::string& key, const std::string& source) {
  if (const auto lens = known_lens(word)) return *lens;
  throw InputError(source, key,
                   fmt::format("found '{}', expected plumb_bob, radtan, rational_polynomial, equidistant, fisheye, ds, "
                               "eucm, omni or fov",
                               word));
}

std::optional<Lens> lens_of_model(const std::string& word, bool is_bent, const std::string& key,
                                  const std::string& source) {
  const std::string plain = plain_word(word);
  if (is_one_of(plain, {"", "pinhole", "perspective"})) return std::nullopt;
  if (is_one_of(plain, {"none", "ftheta", "inverse", "inversebrownconrady", "modified", "modifiedbrownconrady"})) {
    if (!is_bent) return std::nullopt;
    throw InputError(source, key,
                     fmt::format("found '{}', expected brown_conrady, kannala_brandt4, or coefficients of 0", word));
  }
  return lens_of(word, key, source);
}

Lens named_lens(const NumberTable& table, CalibrationNotes& notes) {
  SaidLens said;
  for (const auto& [key, entry] : table.entries) add(key, entry, table, said, notes);
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
