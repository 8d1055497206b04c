#include "flies/io/formats/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/core/plausible.hpp"
#include "flies/io/formats/named_keys.hpp"

namespace flies::detail {
namespace {

constexpr Names kFocal = {"fx",           "fxpx",    "f",           "fpx",
                          "focal",        "focalpx", "focallength", "focallengthpx",
                          "focallengthx", "focalx",  "focalxpx",    "fu"};
constexpr Names kFocalDown = {"fy", "fypx", "focallengthy", "focaly", "fv"};
constexpr Names kColumn = {"cx", "cxpx", "cxleft", "cx0", "ppx", "u0", "cu", "principalpointx"};
constexpr Names kRightColumn = {"cxright", "cxrightpx", "cx1"};
constexpr Names kRow = {"cy", "cypx", "ppy", "v0", "cv", "principalpointy"};
constexpr Names kMatrix = {"k",   "cameramatrix", "intrinsicmatrix", "intrinsics", "intrinsic", "cameraintrinsics",
                           "mtx", "kmatrix"};
constexpr Names kFocalLengths = {"focallength", "focallengths", "focal", "focallengthpx"};
constexpr Names kPrincipalPoint = {"principalpoint", "principalpointpx", "center", "centre", "opticalcenter"};
constexpr Names kBaseline = {"baseline", "stereobaseline", "camerabaseline"};
constexpr Names kShortBaseline = {"b"};
constexpr Names kFocalTimesBaseline = {"bf", "fb", "focaltimesbaseline", "fxbaseline"};
constexpr Names kShift = {"tx"};  // of OpenCV, where the right camera's is negative
constexpr Names kOtherShifts = {"ty", "tz"};
constexpr Names kUnit = {"unit",       "units",      "baselineunit",   "baselineunits",
                         "lengthunit", "worldunits", "coordinateunits"};

struct Unit {
  std::string_view name;
  double metres;
};
constexpr Unit kUnits[] = {
    {"m", 1.0},     {"meter", 1.0},       {"meters", 1.0},       {"metre", 1.0},       {"metres", 1.0},
    {"mm", 1e-3},   {"millimeter", 1e-3}, {"millimeters", 1e-3}, {"millimetre", 1e-3}, {"millimetres", 1e-3},
    {"cm", 1e-2},   {"centimeter", 1e-2}, {"centimeters", 1e-2}, {"centimetre", 1e-2}, {"centimetres", 1e-2},
    {"in", 0.0254}, {"inch", 0.0254},     {"inches", 0.0254}};

std::optional<double> metres_per(std::string_view unit) {
  const auto* found = std::ranges::find(kUnits, unit, &Unit::name);
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->metres);
}

/// None is a word, and two are one with a decimal comma: both are told when the number is asked for.
bool is_number(const std::string& key, const NumberEntry& entry) {
  const std::string name = plain_name(key);
  const bool may_be_pair = std::ranges::find(kFocalLengths, name) != kFocalLengths.end();
  return entry.numbers.size() <= (may_be_pair ? 1 : 2);
}

std::string key_of_number(const NumberTable& table, Names names) {
  return chosen(table, keys_of(table, names, is_number));
}

/// @param otherwise the name to miss when there is none
double number_of(const NumberTable& table, Names names, const char* otherwise) {
  const std::string key = key_of_number(table, names);
  return table.require_number(key.empty() ? otherwise : key);
}

bool is_pair(const std::string&, const NumberEntry& entry) { return entry.numbers.size() == 2; }

std::string key_of_pair(const NumberTable& table, Names names) { return chosen(table, keys_of(table, names, is_pair)); }

/// Nine numbers, or fx, fy, cx, cy, which under the name of k may be coefficients of distortion.
bool is_matrix(const std::string& key, const NumberEntry& entry) {
  const std::string name = plain_name(key);
  return entry.numbers.size() == 9 || (entry.numbers.size() == 4 && name != "k" && name != "kmatrix");
}

std::string key_of_matrix(const NumberTable& table) { return chosen(table, keys_of(table, kMatrix, is_matrix)); }

bool has_numbers(const NumberTable& table, Names names) { return !keys_of(table, names, is_number).empty(); }

FoundCamera of_matrix(const NumberTable& table, const std::string& key, CalibrationNotes& notes) {
  const auto& numbers = table.require(key);
  constexpr std::size_t kFew = 4;
  if (numbers.size() == kFew) return {key, numbers[0], numbers[1], numbers[2], numbers[2], numbers[3]};
  auto m = matrix_of(table, key);
  const bool stands_in_columns = m[2] == 0.0 && m[5] == 0.0 && m[8] == 1.0 && (m[6] > 1.0 || m[7] > 1.0);
  if (stands_in_columns) {
    m = transposed(m);
    notes.push_back({key + " is read column by column, as Open3D and MATLAB write it", CalibrationNoteKind::told});
  }
  check_camera_matrix(m, table.source, key);
  return {key, m[0], m[4], m[2], m[2], m[5]};
}

/// fx, fy, cx, cy by their own names; focal lengths alone, or the principal point, may be a list.
FoundCamera of_numbers(const NumberTable& table) {
  FoundCamera camera;
  const std::string lengths = key_of_pair(table, kFocalLengths), centre = key_of_pair(table, kPrincipalPoint);
  if (!lengths.empty() && !has_numbers(table, kFocal)) {
    camera.fx_px = table.require(lengths, 2)[0];
    camera.fy_px = table.require(lengths, 2)[1];
    camera.key = lengths;
  } else {
    camera.fx_px = number_of(table, kFocal, "fx");
    camera.fy_px = has_numbers(table, kFocalDown) ? number_of(table, kFocalDown, "fy") : camera.fx_px;
    camera.key = key_of_number(table, kFocal);
  }
  if (!centre.empty() && !has_numbers(table, kColumn)) {
    camera.cx_px = table.require(centre, 2)[0];
    camera.cy_px = table.require(centre, 2)[1];
  } else {
    camera.cx_px = number_of(table, kColumn, "cx");
    camera.cy_px = number_of(table, kRow, "cy");
  }
  camera.cx_right_px = camera.cx_px;
  return camera;
}

bool has_focal(const NumberTable& table) {
  return has_numbers(table, kFocal) || !keys_of(table, kFocalLengths, is_pair).empty();
}

bool has_centre(const NumberTable& table) {
  return has_numbers(table, kColumn) || !keys_of(table, kPrincipalPoint, is_pair).empty();
}

/// "baseline" and the metres per unit that its name ends in, if it does; nothing of other names.
std::optional<std::optional<double>> unit_of_baseline(std::string_view plain) {
  for (const std::string_view name : kBaseline) {
    if (!plain.starts_with(name)) continue;
    const std::string_view unit = plain.substr(name.size());
    if (unit.empty()) return std::optional<double>();
    if (const auto metres = metres_per(unit)) return metres;
    if (const auto metres = unit.starts_with("in") ? metres_per(unit.substr(2)) : std::nullopt) return metres;
  }
  return std::nullopt;
}

/// Metres per unit that the name of a length ends in behind a `_`: T_mm.
std::optional<double> unit_in_name(const std::string& length) {
  const std::string name = in_small_letters(length.substr(length.rfind('.') + 1));
  const auto sign = name.rfind('_');
  return sign == std::string::npos ? std::nullopt : metres_per(std::string_view(name).substr(sign + 1));
}

/// Where the unit of a length is named, beside it or below no other key; "" when it is not.
std::string key_of_unit(const NumberTable& table, const std::string& length) {
  constexpr std::string_view kPixels[] = {"px", "pixel", "pixels"};  // of focal lengths
  const auto says_unit = [&](const std::string& key, const NumberEntry& entry) {
    return !entry.not_a_number.empty() && std::ranges::find(kPixels, table.word(key)) == std::end(kPixels);
  };
  auto keys = keys_of(table, kUnit, [&](const std::string& key, const NumberEntry& entry) {
    return is_beside(key, length) && says_unit(key, entry);
  });
  if (keys.empty())
    keys = keys_of(table, kUnit, [&](const std::string& key, const NumberEntry& entry) {
      return is_on_top(key) && says_unit(key, entry);
    });
  return keys.empty() ? "" : keys[0];
}

/// A baseline and its unit, which may stand in its name, behind it (120 mm) or beside it.
FoundNumber baseline_at(const NumberTable& table, const std::string& key, std::optional<double> unit) {
  const auto& entry = table.entries.find(key)->second;
  const auto behind = metres_per(table.word(key));
  if (!unit && entry.numbers.size() == 1 && behind) return {key, entry.numbers[0] * *behind};
  return {key, table.require_number(key) * unit.value_or(unit_of(table, key).value_or(1.0))};
}

/// @throws InputError when Tx says another distance than the baseline; it may be in another unit, or times the focal
///         length as the last number of P2 is
void check_same_shift(const NumberTable& table, const FoundNumber& baseline, const std::string& key, double fx_px) {
  constexpr double kAlike = 0.02;
  const double shift_m = std::abs(baseline_at(table, key, std::nullopt).value), baseline_m = std::abs(baseline.value);
  for (const double unit : {1.0, 100.0, 1000.0, fx_px})
    if (std::abs(shift_m - unit * baseline_m) <= kAlike * unit * baseline_m) return;
  if (shift_m != 0.0) check_same_length(baseline, {key, shift_m}, table.source);
}

}  // namespace

bool has_camera(const NumberTable& table) {
  return (has_focal(table) && has_centre(table)) || !keys_of(table, kMatrix, is_matrix).empty();
}

FoundCamera camera_in(const NumberTable& table, CalibrationNotes& notes) {
  const std::string matrix = key_of_matrix(table);
  const bool has_own_names = has_focal(table) && has_centre(table);
  FoundCamera camera = matrix.empty() || has_own_names ? of_numbers(table) : of_matrix(table, matrix, notes);
  if (!matrix.empty() && has_own_names) {
    constexpr double kAlike = 1e-3;
    const FoundCamera other = of_matrix(table, matrix, notes);
    if (std::abs(other.fx_px - camera.fx_px) > kAlike * std::abs(camera.fx_px) ||
        std::abs(other.cx_px - camera.cx_px) > 1.0)
      throw InputError(table.source, camera.key + ", " + matrix,
                       fmt::format("say fx {:.6g} and {:.6g} px, cx {:.6g} and {:.6g} px: which are meant?",
                                   camera.fx_px, other.fx_px, camera.cx_px, other.cx_px));
  }
  if (has_numbers(table, kRightColumn)) camera.cx_right_px = number_of(table, kRightColumn, "cx_right");
  return camera;
}

std::optional<double> unit_of(const NumberTable& table, const std::string& length) {
  if (const auto unit = unit_in_name(length)) return unit;
  const std::string key = key_of_unit(table, length);
  if (key.empty()) return std::nullopt;
  const auto unit = known_unit_of(table, length);
  if (!unit)
    throw InputError(table.source, key, fmt::format("found '{}', expected m, cm, mm or inches", table.word(key)));
  return unit;
}

std::optional<double> known_unit_of(const NumberTable& table, const std::string& length) {
  if (const auto unit = unit_in_name(length)) return unit;
  const std::string word = table.word(key_of_unit(table, length));
  return metres_per(word.substr(word.rfind('.') + 1));  // of Python's Unit.MILLIMETER
}

void check_same_length(const FoundNumber& one, const FoundNumber& other, const std::string& source) {
  constexpr double kAlike = 0.01;
  if (std::abs(std::abs(one.value) - std::abs(other.value)) <= kAlike * std::abs(one.value)) return;
  throw InputError(source, one.key + ", " + other.key,
                   fmt::format("say {:.4g} m and {:.4g} m, expected the same distance of the cameras: which is meant?",
                               one.value, other.value));
}

std::optional<FoundNumber> baseline_in(const NumberTable& table, double fx_px) {
  std::vector<FoundNumber> found;
  for (const auto& [key, entry] : table.entries)
    if (const auto unit = unit_of_baseline(plain_name(key)); unit && is_number(key, entry))
      found.push_back(baseline_at(table, key, *unit));
  if (found.empty())
    for (const auto& key : keys_of(table, kShortBaseline, is_number))
      if (is_on_top(key)) found.push_back(baseline_at(table, key, std::nullopt));
  if (const std::string key = key_of_number(table, kFocalTimesBaseline); !key.empty())
    found.push_back({key, table.require_number(key) / fx_px});
  if (std::ranges::any_of(found, [](const FoundNumber& number) { return is_on_top(number.key); }))
    std::erase_if(found, [](const FoundNumber& number) { return !is_on_top(number.key); });
  for (std::size_t i = 1; i < found.size(); ++i) check_same_length(found[0], found[i], table.source);
  const auto shifts = keys_of(table, kShift, is_number);
  const bool has_shift = !shifts.empty() && is_on_top(shifts[0]);
  if (!found.empty() && has_shift && keys_of(table, kOtherShifts, is_number).empty())
    check_same_shift(table, found[0], shifts[0], fx_px);
  if (!found.empty()) return found[0];
  if (!has_shift) return std::nullopt;
  return FoundNumber{shifts[0], std::abs(baseline_at(table, shifts[0], std::nullopt).value)};
}

std::vector<FoundNumber> named_baselines(const NumberTable& table) {
  std::vector<FoundNumber> found;
  for (const auto& [key, entry] : table.entries) {
    const auto unit = unit_of_baseline(plain_name(key));
    if (!unit || !is_on_top(key) || entry.numbers.size() != 1) continue;
    const auto behind = metres_per(table.word(key));
    if (!entry.not_a_number.empty() && !behind) continue;
    const auto beside = behind ? behind : known_unit_of(table, key);
    found.push_back({key, entry.numbers[0] * unit->value_or(beside.value_or(1.0))});
  }
  return found;
}

std::optional<FoundNumber> doffs_in(const NumberTable& table) {
  const std::string key = key_of_number(table, {"doffs"});
  return key.empty() ? std::nullopt : std::optional(FoundNumber{key, table.require_number(key)});
}

std::optional<FoundNumber> calibration_error_in(const NumberTable& table) {
  std::optional<FoundNumber> worst;
  for (const auto& [key, entry] : table.entries) {
    const std::string name = plain_name(key);
    const bool is_error = name.starts_with("rms") || name.ends_with("rms") || name.ends_with("rmse") ||
                          name.find("reprojectionerror") != std::string::npos;
    if (!is_error || entry.numbers.size() != 1) continue;
    if (!worst || entry.numbers[0] > worst->value) worst = FoundNumber{key, entry.numbers[0]};
  }
  return worst;
}

}  // namespace flies::detail
