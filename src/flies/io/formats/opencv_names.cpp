#include "flies/io/formats/opencv_names.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/letters.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/named_keys.hpp"

namespace flies::detail {
namespace {

using Words = std::vector<std::string>;
using Pair = std::array<std::string, 2>;

/// What stands before or behind the name of a matrix. "0" and "1" come last: "1" alone is the left one.
const std::vector<Pair> kSides = {{"1", "2"},
                                  {"l", "r"},
                                  {"left", "right"},
                                  {"leftcamera", "rightcamera"},
                                  {"leftcam", "rightcam"},
                                  {"cameraleft", "cameraright"},
                                  {"camleft", "camright"},
                                  {"camera1", "camera2"},
                                  {"cam1", "cam2"},
                                  {"0", "1"},
                                  {"camera0", "camera1"},
                                  {"cam0", "cam1"}};

const Words kMatrix = {"m",
                       "k",
                       "cameramatrix",
                       "matrix",
                       "mtx",
                       "intrinsics",
                       "intrinsic",
                       "intrinsicmatrix",
                       "intrinsicmtx",
                       "cameraintrinsics",
                       "cammat",
                       "cameramat",
                       "mat",
                       "cammats",
                       "cm",
                       "newmtx",
                       "newcameramtx",
                       "newcameramatrix"};
/// Behind the name of a fisheye's distortion, as Stereolabs writes it: D_LEFT_FE.
constexpr const char* kFisheye = "fe";
const Words kProjection = {"p", "projection", "projectionmatrix", "proj", "projmatrix", "projmat"};
const Words kRotation = {"r",
                         "rotation",
                         "rotationmatrix",
                         "rot",
                         "rotmatrix",
                         "rotmat",
                         "rmat",
                         "rmatrix",
                         "rvec",
                         "om",
                         "rotationvector",
                         "rotvec",
                         "rodrigues",
                         "rotationmat",
                         "rotationvec",
                         "rotationlefttoright",
                         "rotationofcamera2"};
const Words kTranslation = {"t",
                            "translation",
                            "translationvector",
                            "trans",
                            "trns",
                            "transvector",
                            "transvec",
                            "tvec",
                            "tmat",
                            "tvector",
                            "translationvec",
                            "translationmat",
                            "translationlefttoright",
                            "translationofcamera2"};
const Words kPose = {"rt",
                     "pose",
                     "extrinsics",
                     "extrinsic",
                     "extrinsicmatrix",
                     "transform",
                     "transformation",
                     "extrinsicslefttoright",
                     "lefttoright",
                     "tlefttoright",
                     "transformlefttoright"};
const Words kOfBoth = {"", "stereo", "extrinsics", "extrinsic", "stereoparams"};
const Words kSize = {"imagesize", "imgsize", "size", "resolution", "imageresolution"};
const Words kShape = {"imageshape", "imgshape", "shape"};  // of a NumPy array: rows, columns
const Words kReprojection = {"q", "qmatrix", "disparitytodepth", "disparitytodepthmatrix", "reprojectionmatrix"};
const std::vector<Pair> kWidthHeight = {{"imagewidth", "imageheight"},         {"width", "height"},
                                        {"imagesizewidth", "imagesizeheight"}, {"imgwidth", "imgheight"},
                                        {"sizewidth", "sizeheight"},           {"resolutionwidth", "resolutionheight"}};

/// Behind lengths whose name says their unit: T_mm.
const Words kUnits = {"", "mm", "cm", "m", "inmm", "incm", "inm", "millimeters", "centimeters", "meters"};

Words with_units(const Words& names) {
  Words found;
  for (const auto& unit : kUnits)
    for (const auto& name : names) found.push_back(name + unit);
  return found;
}

/// Of a left camera in whose frame the right one stands: no turn, or no shift.
bool is_neutral(const std::vector<double>& numbers) {
  constexpr std::size_t kSide = 3;
  if (numbers.size() != kSide * kSide)
    return !numbers.empty() && std::ranges::all_of(numbers, [](double number) { return number == 0.0; });
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != (i % (kSide + 1) == 0 ? 1.0 : 0.0)) return false;
  return true;
}

/// The keys of a file by their letters and digits, small.
class Keys {
 public:
  /// @param single those of single numbers, or all others: k1 may be a coefficient of distortion, and K1 a matrix
  Keys(const NumberTable& table, bool single) {
    for (const auto& [key, entry] : table.entries) {
      if ((entry.numbers.size() == 1) != single) continue;
      keys_.emplace(plain_letters(key), key);
      if (is_neutral(entry.numbers)) neutral_.insert(key);
    }
  }
  std::string find(const std::string& plain) const {
    const auto found = keys_.find(plain);
    return found == keys_.end() ? "" : found->second;
  }
  std::string find_first(const Words& prefixes, const Words& names) const {
    for (const auto& prefix : prefixes)
      for (const auto& name : names)
        if (auto key = find(prefix + name); !key.empty()) return key;
    return "";
  }
  /// Below the key of the right camera, and not below that of the left one, or there of a camera that is not turned or
  /// shifted: `right.R`.
  std::string find_below_right(const Words& names) const {
    const auto find_below = [&](const std::string& side) {
      const std::string key = find_first({side, side + "extrinsics", side + "extrinsic"}, names);
      const bool is_numbered = side == "camera2" || side == "cam2";  // which nothing else is called
      return key.find('.') == std::string::npos && !is_numbered ? "" : key;
    };
    for (const auto& [left, right] : kSides)
      if (auto key = find_below(right); !key.empty() && is_none_or_neutral(find_below(left))) return key;
    return "";
  }
  std::string find_of_side(const Words& names, const std::string& side, const std::string& ending) const {
    for (const auto& name : names)
      for (const auto& plain : {name + side + ending, side + name + ending})
        if (auto key = find(plain); !key.empty()) return key;
    return "";
  }
  /// Of both sides; when no pair of sides is there, of the first side that is.
  /// @param ending behind name and side
  Pair find_of_sides(const Words& names, const std::string& ending = "") const {
    Pair one;
    for (const auto& [left, right] : kSides) {
      Pair found = {find_of_side(names, left, ending), find_of_side(names, right, ending)};
      if (!found[0].empty() && !found[1].empty()) return found;
      if (one[0].empty() && one[1].empty()) one = found;
    }
    return one;
  }

 private:
  bool is_none_or_neutral(const std::string& key) const { return key.empty() || neutral_.contains(key); }

  std::map<std::string, std::string> keys_;
  std::set<std::string> neutral_;
};

Pair or_else(const Pair& found, const Pair& otherwise) {
  return {found[0].empty() ? otherwise[0] : found[0], found[1].empty() ? otherwise[1] : found[1]};
}

/// Lists of coefficients; or the first of those that stand one a key, or lists of radial ones.
Pair distortions_in(const Keys& keys, const Keys& single) {
  Words first = {"k1"}, of_camera = distortion_names();
  for (const auto& name : distortion_names()) first.push_back(name + "k1");
  of_camera.push_back("");
  for (const auto& found : {keys.find_of_sides(distortion_names()), single.find_of_sides(of_camera, "k1"),
                            single.find_of_sides(first), keys.find_of_sides({"radial", "radialdistortion"})})
    if (!found[0].empty() || !found[1].empty()) return found;
  return {};
}

std::string or_else(const std::string& found, const char* otherwise) { return found.empty() ? otherwise : found; }

}  // namespace

OpenCvNames opencv_names(const NumberTable& table) {
  const Keys keys(table, false), single(table, true);
  const auto has_any = [](const Pair& pair) { return !pair[0].empty() || !pair[1].empty(); };
  const Pair matrices = keys.find_of_sides(kMatrix), projections = keys.find_of_sides(kProjection);
  const Words translations = with_units(kTranslation);
  std::string rotation = keys.find_first(kOfBoth, kRotation), translation = keys.find_first(kOfBoth, translations);
  if (rotation.empty()) rotation = keys.find_below_right(kRotation);
  if (translation.empty()) translation = keys.find_below_right(translations);
  OpenCvNames names;
  names.has_matrices = has_any(matrices);
  names.has_projections = has_any(projections);
  names.matrices = or_else(matrices, {"M1", "M2"});
  const Pair distortions = distortions_in(keys, single), of_fisheyes = keys.find_of_sides(distortion_names(), kFisheye);
  names.are_fisheyes = !has_any(distortions) && has_any(of_fisheyes);
  names.distortions = or_else(names.are_fisheyes ? of_fisheyes : distortions, {"D1", "D2"});
  names.projections = or_else(projections, {"P1", "P2"});
  names.mirrors = single.find_of_sides({"xi"});
  names.pose = keys.find_first({""}, kPose);
  constexpr std::size_t kVector = 3;
  if (const auto t = table.entries.find(translation); t != table.entries.end() && t->second.numbers.size() > kVector)
    names.pose = translation;
  names.has_pose = !names.pose.empty() || (!rotation.empty() && !translation.empty());
  names.rotation = or_else(rotation, "R");
  names.translation = or_else(translation, "T");
  names.is_of_matlab = !translation.empty() && translation == keys.find_first(kOfBoth, {"translationofcamera2"});
  names.size = keys.find_first({""}, kSize);
  names.is_rows_first = names.is_of_matlab || names.size.empty();
  if (names.size.empty()) names.size = keys.find_first({""}, kShape);
  names.reprojection = keys.find_first({"", "stereo"}, kReprojection);
  names.has_reprojection_only =
      !names.reprojection.empty() && !names.has_matrices && !names.has_projections && !names.has_pose;
  for (const auto& [width, height] : kWidthHeight) {
    const Pair found = {single.find(width), single.find(height)};
    if (!has_any(found)) continue;
    names.sides = or_else(found, {"image_width", "image_height"});
    break;
  }
  return names;
}

NumberTable with_listed_translation(NumberTable table) {
  const Words names = with_units(kTranslation);
  std::vector<std::string> maps;
  for (const auto& [key, entry] : table.entries)
    if (key.ends_with(".x")) maps.push_back(key.substr(0, key.size() - 2));
  for (const auto& map : maps) {
    if (table.has(map) || std::ranges::find(names, plain_name(map)) == names.end()) continue;
    NumberEntry list;
    for (const char* axis : {".x", ".y", ".z"})
      if (const auto entry = table.entries.find(map + axis); entry != table.entries.end())
        list.numbers.insert(list.numbers.end(), entry->second.numbers.begin(), entry->second.numbers.end());
    table.entries.emplace(map, std::move(list));
  }
  return table;
}

NumberTable without_common_prefix(const NumberTable& table) {
  const auto names_both = [](const NumberTable& of) {
    const auto names = opencv_names(of);
    const auto has = [&](const Pair& pair) { return of.has(pair[0]) && of.has(pair[1]); };
    return has(names.matrices) || has(names.projections);
  };
  if (names_both(table)) return table;
  std::set<std::string> prefixes;
  constexpr std::size_t kMost = 100;  // of a file of calibrations no other has
  for (const auto& [key, entry] : table.entries)
    for (auto dot = key.find('.'); dot != std::string::npos && prefixes.size() < kMost; dot = key.find('.', dot + 1))
      prefixes.insert(key.substr(0, dot + 1));
  std::optional<NumberTable> found;
  for (const auto& prefix : prefixes) {
    NumberTable inner{table.source, {}};
    for (const auto& [key, entry] : table.entries)
      if (key.starts_with(prefix)) inner.entries.emplace(key.substr(prefix.size()), entry);
    if (!names_both(inner)) continue;
    if (found) return table;  // two pairs, and nothing says which is meant
    inner.entries.insert(table.entries.begin(), table.entries.end());
    if (plain_letters(prefix).find("fisheye") != std::string::npos)
      inner.entries.try_emplace("distortion_model", NumberEntry{{}, "fisheye"});
    found = std::move(inner);
  }
  return found.value_or(table);
}

}  // namespace flies::detail
