// What OpenCV's stereoCalibrate and stereoRectify leave behind, as YAML or XML.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/distortion_names.hpp"
#include "flies/io/formats/opencv_names.hpp"
#include "flies/io/formats/quantities.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/formats/stated_size.hpp"

namespace flies::detail {
namespace {

ImageSize first_size(const NumberTable& table, const OpenCvNames& names) {
  constexpr std::size_t kList = 2;  // a longer one tells its order itself
  if (!names.size.empty()) {
    const auto size = size_of_list(table, names.size);
    const bool is_exchanged = names.is_rows_first && table.require(names.size).size() == kList;
    return is_exchanged ? ImageSize{size.height_px, size.width_px} : size;
  }
  if (names.sides[0].empty()) return {};
  return {table.require_size(names.sides[0]), table.require_size(names.sides[1])};
}

/// @throws InputError when the file says two, and the user not which is meant
ImageSize size_of(const NumberTable& table, const OpenCvNames& names, double cx_px, double cy_px,
                  const CalibrationRequest& request) {
  return agreed_size(table, first_size(table, names),
                     {"", cx_px, cy_px, request.calibrated_width_px, request.calibrated_height_px});
}

/// First and last column, first and last row of a cropped image.
ImageSize size_of_crop(const NumberTable& table) {
  if (!table.has("roi")) return {};
  const auto& roi = table.require("roi", 4);
  const auto pixels = [&](double first, double last) {
    NumberTable size{table.source, {}};
    size.entries["roi"].numbers = {last - first + 1.0};
    return size.require_size("roi");
  };
  return {pixels(roi[0], roi[1]), pixels(roi[2], roi[3])};
}

/// A camera matrix, or fx, fy, cx, cy.
std::array<double, 9> intrinsics_of(const NumberTable& table, const std::string& key) {
  constexpr std::size_t kFew = 4;
  const auto& numbers = table.require(key);
  if (numbers.size() != kFew) return matrix_of(table, key);
  return camera_matrix(numbers[0], numbers[1], numbers[2], numbers[3]);
}

/// What looks like coefficients of distortion, whatever its name; "" when nothing does.
std::string key_of_coefficients(const NumberTable& table) {
  constexpr std::size_t kFewest = 4, kMost = 14;
  const auto found = std::ranges::find_if(table.entries, [](const auto& item) {
    const auto& [key, entry] = item;
    const auto count = entry.numbers.size();
    return (key.starts_with('d') || key.starts_with('D')) && count >= kFewest && count <= kMost;
  });
  return found == table.entries.end() ? "" : found->first;
}

/// @throws InputError when a file whose lenses are taken as free of distortion has coefficients under another name
void check_no_other_distortion(const NumberTable& table, const OpenCvNames& names) {
  if (const std::string key = key_of_coefficients(table); !key.empty())
    throw InputError(table.source, key,
                     fmt::format("found {} numbers: are they distortion coefficients? expected those as D1 and D2",
                                 table.entries.at(key).numbers.size()));
  for (const auto& matrix : names.matrices) check_no_distortion(table, matrix.substr(0, matrix.rfind('.') + 1));
}

/// Metres per unit of a distance of the cameras: the unit that the file names, unless that is of something else, as of
/// the board, and the cameras would hardly stand so.
double named_unit(const NumberTable& table, const std::string& key, double distance, CalibrationNotes& notes) {
  constexpr double kLeast_m = 0.015, kMost_m = 3.0;
  const auto is_likely = [](double distance_m) { return distance_m >= kLeast_m && distance_m <= kMost_m; };
  const double unit = known_unit_of(table, key).value_or(1.0);
  if (unit == 1.0 || is_likely(distance * unit) || !is_likely(distance)) return unit;
  notes.push_back({fmt::format("{} is taken as metres, {:.4g} m: in the unit that the file names it would be {:.4g} m",
                               key, distance, distance * unit)});
  return 1.0;
}

/// MATLAB's world units are millimetres unless somebody chose others.
double metres_per_unit(const NumberTable& table, const OpenCvNames& names, const std::vector<double>& t,
                       CalibrationNotes& notes) {
  if (!names.is_of_matlab || known_unit_of(table, names.translation))
    return named_unit(table, names.translation, std::hypot(t[0], t[1], t[2]), notes);
  const bool is_millimetres = are_millimetres(t);
  notes.push_back({fmt::format("{} is taken as {} (correct it with --baseline M)", names.translation,
                               is_millimetres ? "millimetres, as MATLAB's world units are" : "metres")});
  return is_millimetres ? 1e-3 : 1.0;
}

/// From left to right, in metres.
Pose read_pose(const NumberTable& table, const OpenCvNames& names, CalibrationNotes& notes) {
  if (!names.pose.empty()) {
    const Pose pose = pose_of(table, names.pose, notes);
    return scaled(pose, named_unit(table, names.pose, length_of(names.pose, pose).value, notes));
  }
  const auto rotation = rotation_of(table, names.rotation, notes);
  const auto& t = table.require(names.translation, 3);
  return scaled({rotation, {t[0], t[1], t[2]}}, metres_per_unit(table, names, t, notes));
}

/// The same of a file that need not have it: nothing where it cannot be read.
std::optional<FoundNumber> distance_in(const NumberTable& table, const OpenCvNames& names) {
  if (!names.has_pose) return std::nullopt;
  try {
    CalibrationNotes of_unused;
    return length_of(names.pose.empty() ? names.translation : names.pose, read_pose(table, names, of_unused));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Notes that Q or R and T, which are not read, say something else than what is.
/// @param focal that of rectified images; nothing when they are yet to be rectified
void note_other_matrices(const NumberTable& table, const OpenCvNames& names, const FoundNumber& baseline,
                         const FoundNumber* focal, const CalibrationRequest& request, CalibrationNotes& notes) {
  if (const auto distance = distance_in(table, names); distance && distance->key != baseline.key)
    note_other_baseline(baseline, *distance, request, notes);
  note_other_reprojection(table, names.reprojection, baseline, focal, request, notes);
}

/// Of P1 and P2, which raw cameras need not have; nothing where they say none.
std::optional<FoundNumber> baseline_of_projections(const NumberTable& table, const OpenCvNames& names) {
  const auto last_of = [&](const std::string& key) -> std::optional<double> {
    constexpr std::size_t kCount = 12;
    const auto p = table.entries.find(key);
    if (p == table.entries.end() || p->second.numbers.size() != kCount || p->second.numbers[0] == 0.0)
      return std::nullopt;
    return p->second.numbers[3] / p->second.numbers[0];
  };
  const auto left = last_of(names.projections[0]), right = last_of(names.projections[1]);
  if (!left || !right) return std::nullopt;
  const double unit = known_unit_of(table, names.projections[1]).value_or(1.0);
  return FoundNumber{names.projections[1], unit * (*left - *right)};
}

/// Notes that a camera by its own names, as in a file by hand, has another focal length than the projections.
void note_other_camera(const NumberTable& table, const FoundNumber& focal, CalibrationNotes& notes) {
  const auto fx = table.entries.find("fx");
  if (fx == table.entries.end() || fx->second.numbers.size() != 1 || table.has("k1")) return;
  if (key_of_coefficients(table).empty()) note_other_focal_length(focal, {"fx", fx->second.numbers[0]}, notes);
}

/// The pair without its pose.
RawPair raw_pair(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  RawPair pair{{}, names.matrices[0], names.matrices[1], names.pose.empty() ? names.rotation : names.pose};
  const Lens lens = names.are_fisheyes          ? Lens::equidistant
                    : !names.mirrors[0].empty() ? Lens::mei
                                                : named_lens(table, pair.notes);
  // OpenCV's own names stand in for those that are not there.
  const bool is_undistorted = !table.has(names.distortions[0]) && !table.has(names.distortions[1]);
  if (is_undistorted) {
    check_no_other_distortion(table, names);
    pair.notes.push_back(note_on_missing_distortion());
  }
  if (!is_undistorted) pair.distortion_keys = names.distortions;
  const auto camera_of = [&](std::size_t side) {
    RawCamera camera{intrinsics_of(table, names.matrices[side]), {}, lens};
    if (!is_undistorted) camera.distortion = distortion_at(table, names.distortions[side], lens).coefficients;
    if (names.mirrors[side].empty()) return camera;
    camera.lens = Lens::mei;
    camera.distortion.insert(camera.distortion.begin(), table.require_number(names.mirrors[side]));
    return camera;
  };
  pair.stereo.left = camera_of(0);
  pair.stereo.right = camera_of(1);
  const auto& left = pair.stereo.left.matrix;
  const auto size = size_of(table, names, left[2], left[5], request);
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  return pair;
}

Calibration read_raw(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  RawPair pair = raw_pair(table, names, request);
  const Pose pose = read_pose(table, names, pair.notes);
  set_pose(pair.stereo, pose);
  const FoundNumber used = length_of(names.pose.empty() ? names.translation : names.pose, pose);
  note_other_matrices(table, names, used, nullptr, request, pair.notes);
  if (const auto other = baseline_of_projections(table, names)) note_other_baseline(used, *other, request, pair.notes);
  return calibration_from_raw(std::move(pair), request, table.source);
}

bool are_straight(const RawStereo& stereo) {
  const auto is_straight = [](const RawCamera& camera) {
    return camera.lens == Lens::brown &&
           std::ranges::all_of(camera.distortion, [](double coefficient) { return coefficient == 0.0; });
  };
  return is_straight(stereo.left) && is_straight(stereo.right);
}

/// Two cameras without a pose: a baseline is enough for rectified ones, whose lenses bend nothing.
Calibration read_side_by_side(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  RawPair pair = raw_pair(table, names, request);
  const auto baseline = baseline_in(table, pair.stereo.left.matrix[0]);
  if ((!baseline && !request.baseline_m) || !are_straight(pair.stereo) || table.has(names.translation))
    throw InputError(table.source, names.rotation,
                     "is missing, so the pose of the cameras is not known: if that is in a file of its own "
                     "(extrinsics.yml), give it too with --right-calib FILE; for rectified images a baseline is enough "
                     "if no lens has distortion");
  if (!baseline) check_asked_baseline(*request.baseline_m, table.source);
  pair.pose_key = baseline ? baseline->key : "baseline";
  set_pose(pair.stereo, {Pose{}.rotation, {-(baseline ? baseline->value : *request.baseline_m), 0.0, 0.0}});
  auto calibration = calibration_from_pair(std::move(pair), request, table.source);
  if (calibration.rectifier)
    calibration.notes.push_back(
        {"the file does not say how the cameras are turned against each other (R): they are "
         "taken as looking the same way"});
  return calibration;
}

/// Q of rectified images, as stereoRectify gives it.
Calibration read_reprojection(const NumberTable& table, const OpenCvNames& names, const CalibrationRequest& request) {
  const auto& q = table.require(names.reprojection, 16);
  if (!is_reprojection(q))
    throw InputError(table.source, names.reprojection,
                     "is not of the form 1 0 0 -cx, 0 1 0 -cy, 0 0 0 f, 0 0 1/baseline c, as stereoRectify gives it");
  Calibration calibration;
  auto& camera = calibration.camera;
  camera.fx_px = camera.fy_px = q[11];
  camera.cx_px = -q[3];
  camera.cy_px = -q[7];
  camera.cx_right_px = camera.cx_px + q[15] / q[14];
  camera.baseline_m = named_unit(table, names.reprojection, std::abs(1.0 / q[14]), calibration.notes) / q[14];
  const auto [width_px, height_px] = size_of(table, names, camera.cx_px, camera.cy_px, request);
  camera.width_px = width_px;
  camera.height_px = height_px;
  calibration.left_name = calibration.right_name = names.reprojection;
  note_other_camera(table, {names.reprojection, camera.fx_px}, calibration.notes);
  calibration.notes.push_back(
      {"the images are taken as rectified: the camera is that of " + names.reprojection, CalibrationNoteKind::told});
  return calibration;
}

/// Whether two files say the same of one thing, but for rounding; zeros at the end may be left out.
bool say_the_same(const std::vector<double>& one, const std::vector<double>& other) {
  constexpr double kRounding = 1e-4;  // of the largest number
  double largest = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < std::max(one.size(), other.size()); ++i) {
    const double a = i < one.size() ? one[i] : 0.0, b = i < other.size() ? other[i] : 0.0;
    largest = std::max({largest, std::abs(a), std::abs(b)});
    difference = std::max(difference, std::abs(a - b));
  }
  return difference <= kRounding * largest;
}

/// A thing that OpenCV has a name for, as a file calls it; without numbers where the file has none.
struct NamedThing {
  std::string key;
  std::vector<double> numbers;
};

/// The same things in the same order of every file: first those of the cameras, then the size of the images.
constexpr std::size_t kThingsOfCameras = 10;
std::vector<NamedThing> things_in(const NumberTable& file) {
  const NumberTable table = without_common_prefix(file);
  const OpenCvNames names = opencv_names(table);
  std::vector<NamedThing> things;
  for (const auto& key : {names.matrices[0], names.matrices[1], names.distortions[0], names.distortions[1],
                          names.projections[0], names.projections[1], names.rotation, names.translation, names.pose,
                          names.reprojection, names.size, names.sides[0], names.sides[1]}) {
    const auto found = table.entries.find(key);
    things.push_back({key, found == table.entries.end() ? std::vector<double>() : found->second.numbers});
  }
  return things;
}

/// @throws InputError when the second file holds nothing of a pair, or says something else than the first
void check_second_file(const NumberTable& first, const NumberTable& second) {
  const auto things = things_in(first), others = things_in(second);
  const auto is_empty = [](const NamedThing& thing) { return thing.numbers.empty(); };
  if (std::all_of(others.begin(), others.begin() + kThingsOfCameras, is_empty))
    throw InputError(second.source, "right calibration",
                     fmt::format("is not used: it has none of OpenCV's matrices (M1, D1, M2, D2, R, T, P1, P2), of "
                                 "which {} has others",
                                 first.source));
  constexpr std::size_t kMatrix = 9, kVector = 3;
  for (std::size_t i = 0; i < things.size(); ++i) {
    const auto &one = things[i].numbers, &other = others[i].numbers;
    const bool is_other_form =
        std::min(one.size(), other.size()) == kVector && std::max(one.size(), other.size()) == kMatrix;
    if (is_empty(things[i]) || is_empty(others[i]) || is_other_form || say_the_same(one, other)) continue;
    throw InputError(
        second.source, others[i].key,
        fmt::format("says something else than {} in {}: give the two files of one calibration, or one file "
                    "that holds all",
                    things[i].key, first.source));
  }
}

Calibration read_opencv(const NumberTable& file, const CalibrationRequest& request) {
  NumberTable table = file;
  const bool has_second_file = !request.right_path.empty();
  if (has_second_file) {
    const auto second = read_number_table(request.right_path);
    check_second_file(file, second);
    table.entries.insert(second.entries.begin(), second.entries.end());
    table.source += " with " + request.right_path;
  }
  table = with_listed_translation(without_common_prefix(table));
  const OpenCvNames names = opencv_names(table);
  if (names.has_reprojection_only) return read_reprojection(table, names, request);
  const bool has_rectified = names.has_projections;
  const bool has_raw = names.has_matrices && names.has_pose;
  if (names.has_matrices && !has_raw && !has_rectified && !has_second_file && !table.has(names.rotation))
    return read_side_by_side(table, names, request);
  // Intrinsics given as a file of their own say that the images are raw; beside P1 and P2 they are just the record of
  // the calibration.
  if (request.images_are_raw || !has_rectified || (has_raw && has_second_file)) return read_raw(table, names, request);

  // Karlsruhe's sequences of 2010 have rows for the images as they were cropped, beside those of the whole ones.
  const bool is_cropped = table.has("P1_roi") && table.has("P2_roi");
  auto calibration = is_cropped
                         ? calibration_from_projections({table, "P1_roi"}, {table, "P2_roi"})
                         : calibration_from_projections({table, names.projections[0]}, {table, names.projections[1]});
  auto& camera = calibration.camera;
  const auto [width_px, height_px] =
      is_cropped ? size_of_crop(table) : size_of(table, names, camera.cx_px, camera.cy_px, request);
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.baseline_m *= named_unit(table, calibration.right_name, std::abs(camera.baseline_m), calibration.notes);
  const FoundNumber focal{calibration.left_name, camera.fx_px};
  note_other_matrices(table, names, {calibration.left_name + " and " + calibration.right_name, camera.baseline_m},
                      &focal, request, calibration.notes);
  if (!names.has_matrices) note_other_camera(table, focal, calibration.notes);
  if (has_raw)
    calibration.notes.push_back(
        {"the images are taken as rectified because the file holds P1 and P2; M1, D1, M2, D2, R and T are ignored "
         "(give --raw if the images are as the cameras gave them)",
         CalibrationNoteKind::told});
  else if (names.has_matrices && table.has("R1") && table.has("R2"))
    calibration.notes.push_back(
        {"R and T are missing, without which raw images cannot be rectified, so the images are taken as rectified. If "
         "they are raw, give R and T too, as stereoCalibrate returns them",
         has_second_file ? CalibrationNoteKind::doubt : CalibrationNoteKind::told});
  else if (table.has("R1") && table.has("R2"))
    calibration.notes.push_back(
        {"the file holds the extrinsics of raw cameras without their intrinsics, so the images are taken as rectified. "
         "If they are not, give the file of the intrinsics too (--right-calib)",
         CalibrationNoteKind::told});
  return calibration;
}

bool has_pose_of_cameras(const NumberTable& table) {
  const OpenCvNames names = opencv_names(table);
  const auto count = [&](const std::string& key) {
    const auto found = table.entries.find(key);
    return found == table.entries.end() ? 0 : found->second.numbers.size();
  };
  const auto of_pose = count(names.pose), of_rotation = count(names.rotation);
  return of_pose == 12 || of_pose == 16 || ((of_rotation == 9 || of_rotation == 3) && count(names.translation) == 3);
}

/// R and T alone; the intrinsics are in the second file.
Calibration read_extrinsics(const NumberTable& table, const CalibrationRequest& request) {
  if (request.right_path.empty())
    throw InputError(
        table.source, "M1, D1, M2, D2",
        "are missing, at least by names that are known here: the file says only how the cameras stand to each "
        "other (R, T); if the intrinsics are in a file of their own, give it too (--right-calib FILE)");
  return read_opencv(table, request);
}

}  // namespace

const CalibrationFormat kOpenCvExtrinsics{"OpenCV extrinsics", false, true, has_pose_of_cameras, read_extrinsics};

const CalibrationFormat kOpenCvStereo{"OpenCV stereo", false, true,
                                      [](const NumberTable& table) {
                                        const auto names = opencv_names(without_common_prefix(table));
                                        return names.has_matrices || names.has_projections ||
                                               names.has_reprojection_only;
                                      },
                                      read_opencv};

}  // namespace flies::detail
