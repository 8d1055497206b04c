#include "flies/io/formats/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/core/plausible.hpp"

namespace flies::detail {
namespace {

/// Small letters and digits alone. The first are looked for first.
using Names = std::initializer_list<const char*>;

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
constexpr Names kWidth = {"width", "widthpx", "imagewidth", "imgwidth"};
constexpr Names kHeight = {"height", "heightpx", "imageheight", "imgheight"};
constexpr Names kSize = {"resolution", "imagesize", "imgsize", "imageresolution", "framesize", "size"};
constexpr Names kShape = {"imageshape", "imgshape", "shape"};  // of a NumPy array: rows, columns
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

/// Whole numbers of pixels of an image.
bool is_size(double number) {
  constexpr double kMost_px = 1e5;
  return number >= 1.0 && number <= kMost_px && number == std::floor(number);
}

/// The last part of a key, its letters and digits, small.
std::string plain_name(std::string_view key) {
  const auto dot = key.rfind('.');
  return plain_letters(dot == std::string_view::npos ? key : key.substr(dot + 1));
}

bool is_on_top(std::string_view key) { return key.find('.') == std::string_view::npos; }

/// Whether a key stands below the same keys as another.
bool is_beside(std::string_view key, std::string_view other) {
  return key.substr(0, key.rfind('.') + 1) == other.substr(0, other.rfind('.') + 1);
}

/// The keys of entries whose name is one of these, as far as `fits` says so.
template <typename Fits>
std::vector<std::string> keys_of(const NumberTable& table, Names names, Fits fits) {
  std::vector<std::string> on_top, below;
  for (const std::string_view name : names)
    for (const auto& [key, entry] : table.entries)
      if (plain_name(key) == name && fits(key, entry)) (is_on_top(key) ? on_top : below).push_back(key);
  return on_top.empty() ? below : on_top;
}

/// Of two places of one thing; a matrix may stand row by row in one and column by column in the other.
bool say_the_same(const std::vector<double>& one, const std::vector<double>& other) {
  constexpr std::size_t kSide = 3;
  if (one == other) return true;
  if (one.size() != kSide * kSide || other.size() != one.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i)
    if (one[i] != other[i % kSide * kSide + i / kSide]) return false;
  return true;
}

/// The one of them that counts: the first below no other key, or that of which all say the same; "" when there is none.
std::string chosen(const NumberTable& table, const std::vector<std::string>& keys) {
  if (keys.empty() || is_on_top(keys[0])) return keys.empty() ? "" : keys[0];
  for (const auto& key : keys)
    if (!say_the_same(table.entries.find(key)->second.numbers, table.entries.find(keys[0])->second.numbers))
      throw InputError(table.source, keys[0],
                       fmt::format("stands in the file as {} too, with other numbers: which is meant? Keep one camera "
                                   "of a rectified pair, or one pair whose keys say left and right",
                                   key));
  return keys[0];
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

/// 640x480 or 640*480 in one word, or with blanks.
std::optional<ImageSize> size_of_words(const NumberTable& table, const std::string& key) {
  const auto& entry = table.entries.find(key)->second;
  const std::string word = table.word(key);
  NumberTable split{table.source, {}};
  if (entry.numbers.size() == 2 && (word == "x" || word == "*")) {
    split.entries[key].numbers = entry.numbers;
    return size_of_list(split, key);
  }
  const auto at = word.find_first_of("x*");
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  if (!entry.numbers.empty() || at == std::string::npos || at == 0 || at + 1 == word.size() || word.size() > 12 ||
      !std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(at), is_digit) ||
      !std::all_of(word.begin() + static_cast<std::ptrdiff_t>(at) + 1, word.end(), is_digit))
    return std::nullopt;
  split.entries[key].numbers = {std::stod(word.substr(0, at)), std::stod(word.substr(at + 1))};
  return size_of_list(split, key);
}

struct SizeAt {
  std::string key;
  ImageSize size;
};

/// Two whole numbers as a size; nothing of others.
std::optional<ImageSize> size_of_numbers(double width, double height) {
  if (!is_size(width) || !is_size(height)) return std::nullopt;
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

bool is_list_of_size(const NumberTable& table, const std::string& key) {
  const auto& entry = table.entries.at(key);
  return entry.not_a_number.empty() && (entry.numbers.size() == 2 || entry.numbers.size() == 3);
}

/// What a key says in one: a list or words; nothing where that is no size.
std::optional<ImageSize> size_in_one(const NumberTable& table, const std::string& key, bool is_rows_first) {
  if (!is_list_of_size(table, key)) return size_of_words(table, key);
  const auto& numbers = table.entries.at(key).numbers;
  if (!std::ranges::all_of(numbers, is_size)) return std::nullopt;
  if (numbers.size() == 3) return size_of_numbers(numbers[1], numbers[0]);  // the shape of a NumPy array
  return is_rows_first ? size_of_numbers(numbers[1], numbers[0]) : size_of_numbers(numbers[0], numbers[1]);
}

/// Width and height of their own keys, pair by pair: image_width with image_height.
std::vector<SizeAt> sizes_of_two(const NumberTable& table) {
  std::vector<SizeAt> sizes;
  const auto is_one = [](const std::string&, const NumberEntry& entry) { return entry.numbers.size() == 1; };
  for (std::size_t name = 0; name < kWidth.size(); ++name) {
    const auto widths = keys_of(table, {*(kWidth.begin() + name)}, is_one);
    const auto heights = keys_of(table, {*(kHeight.begin() + name)}, is_one);
    for (std::size_t i = 0; i < std::min(widths.size(), heights.size()); ++i) {
      const auto size =
          size_of_numbers(table.entries.at(widths[i]).numbers[0], table.entries.at(heights[i]).numbers[0]);
      if (size && is_beside(widths[i], heights[i])) sizes.push_back({widths[i], *size});
    }
  }
  return sizes;
}

bool holds(ImageSize size, const SizeQuery& query) {
  return query.cx_px < size.width_px && query.cy_px < size.height_px;
}

/// Everything in the file that may be the size of the camera's images; below other keys only where nothing is on top.
std::vector<SizeAt> sizes_that_hold(const NumberTable& table, const SizeQuery& query) {
  std::vector<SizeAt> sizes = sizes_of_two(table);
  for (const auto& [key, entry] : table.entries) {
    const std::string name = plain_name(key);
    const bool is_shape = std::ranges::find(kShape, name) != kShape.end();
    if (!is_shape && (std::ranges::find(kSize, name) == kSize.end() || (name == "size" && !is_on_top(key)))) continue;
    if (const auto size = size_in_one(table, key, is_shape)) sizes.push_back({key, *size});
  }
  std::erase_if(sizes, [&](const SizeAt& at) { return !holds(at.size, query); });
  if (std::ranges::any_of(sizes, [](const SizeAt& at) { return is_on_top(at.key); }))
    std::erase_if(sizes, [](const SizeAt& at) { return !is_on_top(at.key); });
  return sizes;
}

/// The same of a size whose width and height may be exchanged.
bool may_hold(ImageSize size, const SizeQuery& query) {
  return holds(size, query) || holds({size.height_px, size.width_px}, query);
}

/// The height beside a width, or the width beside a height, of the same names: image_height beside image_width; "" when
/// there is none.
std::string other_side(const NumberTable& table, const std::string& key) {
  const auto index_in = [](Names names, const std::string& of) {
    return std::ranges::find(names, plain_name(of)) - names.begin();
  };
  const bool is_width = index_in(kWidth, key) < std::ssize(kWidth);
  const auto index = index_in(is_width ? kWidth : kHeight, key);
  for (const auto& [other, entry] : table.entries)
    if (is_beside(other, key) && index_in(is_width ? kHeight : kWidth, other) == index && entry.numbers.size() == 1)
      return other;
  return "";
}

/// Whether a key is the width or height of something that is smaller than the images.
bool is_side_of_other(const NumberTable& table, const std::string& key, const SizeQuery& query) {
  const auto& side = table.entries.at(key).numbers;
  if (side.size() != 1) return false;
  const std::string other = other_side(table, key);
  if (other.empty()) return !is_size(side[0]) || side[0] <= std::min(query.cx_px, query.cy_px);
  const auto size = size_of_numbers(side[0], table.entries.at(other).numbers[0]);
  return !size || !may_hold(*size, query);
}

/// The file without sizes of other things, such as those of a board, which the principal point does not lie in. What
/// stands beside the camera is its own as long as nothing else is.
NumberTable less_other_sizes(const NumberTable& table, const SizeQuery& query) {
  NumberTable rest = table;
  const bool has_size = !sizes_that_hold(table, query).empty();
  std::erase_if(rest.entries, [&](const auto& item) {
    const std::string &key = item.first, name = plain_name(key);
    const auto is_one_of = [&](Names names) { return std::ranges::find(names, name) != names.end(); };
    if (is_beside(key, query.camera_key) && !has_size) return false;
    if (is_one_of(kWidth) || is_one_of(kHeight)) return is_side_of_other(table, key, query);
    if (!is_one_of(kSize) && !is_one_of(kShape)) return false;
    const auto size = size_in_one(table, key, is_one_of(kShape));
    return size && !may_hold(*size, query);
  });
  return rest;
}

/// That of the first of the names.
ImageSize first_size(const NumberTable& table) {
  const std::string width = key_of_number(table, kWidth), height = key_of_number(table, kHeight);
  if (!width.empty() || !height.empty())
    return {table.require_size(width.empty() ? "width" : width),
            table.require_size(height.empty() ? "height" : height)};
  const auto says_size = [&](const std::string& key, const NumberEntry&) {
    return (is_list_of_size(table, key) || size_of_words(table, key)) && (is_on_top(key) || plain_name(key) != "size");
  };
  if (const std::string key = chosen(table, keys_of(table, kSize, says_size)); !key.empty()) {
    const auto of_words = size_of_words(table, key);
    return of_words ? *of_words : size_of_list(table, key);
  }
  if (const std::string key = chosen(table, keys_of(table, kShape, says_size)); !key.empty()) {
    const auto size = size_of_list(table, key);
    return table.require(key).size() == 2 ? ImageSize{size.height_px, size.width_px} : size;
  }
  return {};
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
  const std::string key = key_of_unit(table, length);
  if (key.empty()) return std::nullopt;
  const auto unit = known_unit_of(table, length);
  if (!unit)
    throw InputError(table.source, key, fmt::format("found '{}', expected m, cm, mm or inches", table.word(key)));
  return unit;
}

std::optional<double> known_unit_of(const NumberTable& table, const std::string& length) {
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

ImageSize size_in(const NumberTable& whole, const SizeQuery& query) {
  const NumberTable table = less_other_sizes(whole, query);
  return agreed_size(table, first_size(table), query);
}

ImageSize agreed_size(const NumberTable& table, ImageSize found, const SizeQuery& query) {
  if (found.width_px == 0) return found;
  const auto is = [](ImageSize size, int width_px, int height_px) {
    return size.width_px == width_px && size.height_px == height_px;
  };
  const auto sizes = sizes_that_hold(table, query);
  const auto other = std::ranges::find_if(sizes, [&](const SizeAt& at) {
    // NumPy and MATLAB write rows first.
    return !is(at.size, found.width_px, found.height_px) && !is(at.size, found.height_px, found.width_px);
  });
  if (other == sizes.end() || is(found, query.said_width_px, query.said_height_px)) return found;
  for (const auto& at : sizes)
    if (is(at.size, query.said_width_px, query.said_height_px)) return at.size;
  throw InputError(table.source, other->key,
                   fmt::format("found {} x {} px, but {} x {} px elsewhere in the file: which is the size of the "
                               "images that the calibration is for? --calib-size W,H says it",
                               other->size.width_px, other->size.height_px, found.width_px, found.height_px));
}

}  // namespace flies::detail
