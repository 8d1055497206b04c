// Calibration of OAK cameras as `depthai` writes it to JSON: sockets, and for each the pose of another; centimetres.
// https://github.com/luxonis/depthai-core, CalibrationHandler and EepromData
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/nesting.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

constexpr double kMetresPerCentimetre = 1e-2;
constexpr std::string_view kCameras = "cameraData.";

/// What stands before each socket's numbers.
using Sockets = std::map<int, std::string>;

/// What stands before `cameraData`: nothing, or the key of who keeps more than the EEPROM in one file.
std::optional<std::string> prefix_of(const NumberTable& table) {
  for (const auto& [key, entry] : table.entries)
    if (const auto at = key.find(kCameras); at != std::string::npos && (at == 0 || key[at - 1] == '.'))
      if (key.ends_with(".intrinsicMatrix")) return key.substr(0, at);
  return std::nullopt;
}

/// The last part of a word such as "camerasocket.cam_b", as enumerations print in Python.
std::string_view last_part(std::string_view word) {
  const auto dot = word.rfind('.');
  return dot == std::string_view::npos ? word : word.substr(dot + 1);
}

/// A socket by its number or its name, small; -1 is none.
std::optional<int> socket_named(std::string_view word) {
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && end == word.data() + word.size()) return number;
  const std::string_view name = last_part(word);
  constexpr std::string_view kCam = "cam_";
  if (name.size() == kCam.size() + 1 && name.starts_with(kCam) && name.back() >= 'a' && name.back() <= 'h')
    return name.back() - 'a';
  for (const auto& [known, socket] :
       {std::pair{"rgb", 0}, std::pair{"left", 1}, std::pair{"right", 2}, std::pair{"auto", -1}})
    if (name == known) return socket;
  return std::nullopt;
}

int socket_at(const NumberTable& table, const std::string& key) {
  const auto named = socket_named(table.word(key));
  if (named) return *named;
  const double socket = table.require_number(key);
  if (!(socket >= -1.0 && socket <= 100.0)) throw InputError(table.source, key, fmt::format("found socket {}", socket));
  return static_cast<int>(std::lround(socket));
}

/// Of a list of socket and camera each, as DepthAI writes it, of cameras that name their socket, or of a map of them.
Sockets sockets_of(const NumberTable& table) {
  Sockets sockets;
  for (auto at = table.entries.lower_bound(kCameras); at != table.entries.end() && at->first.starts_with(kCameras);) {
    const std::string camera = at->first.substr(0, at->first.find('.', kCameras.size()));
    const std::string name = camera.substr(kCameras.size()), in_list = camera + ".0", inside = camera + ".socket";
    const auto socket = table.has(in_list)  ? socket_at(table, in_list)
                        : table.has(inside) ? socket_at(table, inside)
                                            : socket_named(in_small_letters(name)).value_or(-1);
    if (socket < 0)
      throw InputError(table.source, camera, "is at no socket that is known, expected 0, 1, ... or CAM_A");
    const std::string prefix = camera + (table.has(in_list) ? ".1." : ".");
    if (!sockets.emplace(socket, prefix).second)
      throw InputError(table.source, camera, fmt::format("is a second camera at socket {}", socket));
    at = table.entries.lower_bound(camera + "/");  // '/' is the letter behind '.'
  }
  return sockets;
}

const std::string& camera_at(const NumberTable& table, const Sockets& sockets, int socket) {
  const auto found = sockets.find(socket);
  if (found == sockets.end())
    throw InputError(table.source, "cameraData", fmt::format("has no camera at socket {}", socket));
  return found->second;
}

/// DepthAI's CameraModel, by number or name.
Lens lens_at(const NumberTable& table, const std::string& key) {
  if (!table.has(key)) return Lens::brown;
  const std::string word = table.word(key);
  const std::string_view name = last_part(word);
  const double number = word.empty() ? table.require_number(key) : -1.0;
  if (number == 0.0 || name == "perspective") return Lens::brown;
  if (number == 1.0 || name == "fisheye") return Lens::equidistant;
  throw InputError(table.source, key,
                   fmt::format("found {}, expected 0 (Perspective) or 1 (Fisheye)",
                               word.empty() ? fmt::format("{}", number) : fmt::format("'{}'", word)));
}

RawCamera depthai_camera(const NumberTable& table, const std::string& prefix) {
  constexpr std::size_t kFisheyeCoefficients = 4;
  RawCamera raw;
  raw.matrix = matrix_of(table, prefix + "intrinsicMatrix");
  raw.distortion = table.require(prefix + "distortionCoeff");
  raw.lens = lens_at(table, prefix + "cameraType");
  if (raw.lens == Lens::equidistant && raw.distortion.size() > kFisheyeCoefficients)
    raw.distortion.resize(kFisheyeCoefficients);
  return raw;
}

/// What was measured; or what the camera was built to, of files that say nothing else.
std::array<double, 3> translation_of(const NumberTable& table, const std::string& extrinsics, CalibrationNotes& notes) {
  const auto numbers = [&](const std::string& name) {
    const auto axis = [&](const char* letter) { return table.require_number(extrinsics + name + letter); };
    return std::array{axis("x"), axis("y"), axis("z")};
  };
  constexpr std::array kNothing = {0.0, 0.0, 0.0};
  const auto measured = numbers("translation.");
  if (measured != kNothing || !table.has(extrinsics + "specTranslation.x") ||
      table.word("stereoUseSpecTranslation") == "false")
    return measured;
  const auto built = numbers("specTranslation.");
  const CalibrationNote note{
      extrinsics + "translation is 0: specTranslation, as the camera was built, is taken instead",
      CalibrationNoteKind::told};
  if (built != kNothing && std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  return built;
}

/// Follows the poses of a socket until there is no next one.
/// @returns for each socket on the way its pose: that socket from the first
std::map<int, Pose> way_from(const NumberTable& table, const Sockets& sockets, int first, CalibrationNotes& notes) {
  std::map<int, Pose> way;
  Pose pose;
  for (int socket = first; sockets.contains(socket) && !way.contains(socket);) {
    way[socket] = pose;
    const std::string extrinsics = sockets.at(socket) + "extrinsics.";
    if (!table.has(extrinsics + "toCameraSocket")) break;
    const int next = socket_at(table, extrinsics + "toCameraSocket");
    if (next < 0) break;
    pose = chained(
        Pose{rotation_of(table, extrinsics + "rotationMatrix", notes), translation_of(table, extrinsics, notes)}, pose);
    socket = next;
  }
  return way;
}

/// By the socket where the ways from both meet; sockets that point at each other meet at two.
Pose right_from_left(const NumberTable& table, const Sockets& sockets, int left, int right,
                     const CalibrationRequest& request, CalibrationNotes& notes) {
  const auto from_left = way_from(table, sockets, left, notes), from_right = way_from(table, sockets, right, notes);
  const auto by = [](int socket) { return fmt::format("extrinsics by way of socket {}", socket); };
  std::optional<Pose> found;
  std::string by_found;
  for (const auto& [socket, pose] : from_left) {
    const auto meets = from_right.find(socket);
    if (meets == from_right.end()) continue;
    const Pose by_this = scaled(chained(inverse(meets->second), pose), kMetresPerCentimetre);
    if (found) {
      note_other_baseline(length_of(by_found, *found), length_of(by(socket), by_this), request, notes);
      continue;
    }
    found = by_this;
    by_found = by(socket);
  }
  if (found) return *found;
  throw InputError(table.source, "extrinsics", fmt::format("lead from socket {} to {} nowhere", left, right));
}

/// Images of a video mode, 16:9, of a sensor with more rows: DepthAI scales them to the sensor's width and keeps the
/// middle rows (CalibrationHandler::getCameraIntrinsics), as 720 of the 800 of an OV9282. The size that the user says
/// may be that of the sensor or of these rows.
/// @returns whether it was so
bool keep_middle_rows(RawPair& pair, const CalibrationRequest& request) {
  auto& raw = pair.stereo;
  const bool is_video = 9 * request.width_px == 16 * request.height_px && request.width_px > 0;
  if (!is_video || request.images_are_resized || 9 * raw.width_px >= 16 * raw.height_px) return false;
  const int rows = 9 * raw.width_px / 16, cut_off = raw.height_px - rows;
  const bool says_other = request.calibrated_width_px != raw.width_px ||
                          (request.calibrated_height_px != raw.height_px && request.calibrated_height_px != rows);
  if (request.calibrated_width_px > 0 && says_other) return false;
  pair.notes.push_back(
      {fmt::format("the calibration is for {} x {} px, of which the images have the middle {} rows, as DepthAI's 16:9 "
                   "modes have (--resized: they were squeezed instead)",
                   raw.width_px, raw.height_px, rows),
       CalibrationNoteKind::told});
  raw.height_px = rows;
  for (RawCamera* camera : {&raw.left, &raw.right}) camera->matrix[5] -= 0.5 * cut_off;
  return true;
}

Calibration read_depthai(const NumberTable& file, const CalibrationRequest& request) {
  const NumberTable table = below(file, prefix_of(file).value_or(""));
  const auto sockets = sockets_of(table);
  const auto named = [&](const char* side, int otherwise) {
    const std::string key = fmt::format("stereoRectificationData.{}CameraSocket", side);
    const int socket = table.has(key) ? socket_at(table, key) : -1;
    return socket >= 0 ? socket : otherwise;
  };
  const auto [left, right] = request.cameras.value_or(std::array{named("left", 1), named("right", 2)});
  const std::string left_prefix = camera_at(table, sockets, left), right_prefix = camera_at(table, sockets, right);
  RawPair pair{{}, left_prefix + "intrinsicMatrix", right_prefix + "intrinsicMatrix", left_prefix + "extrinsics"};
  const auto size_of = [&](const std::string& prefix) {
    return ImageSize{table.require_size(prefix + "width"), table.require_size(prefix + "height")};
  };
  const ImageSize size = size_of(left_prefix);
  check_same_size(size, size_of(right_prefix), table.source, right_prefix + "width, height");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  pair.stereo.left = depthai_camera(table, left_prefix);
  pair.stereo.right = depthai_camera(table, right_prefix);
  set_pose(pair.stereo, right_from_left(table, sockets, left, right, request, pair.notes));
  CalibrationRequest of_rows = request;
  if (keep_middle_rows(pair, request)) of_rows.calibrated_width_px = of_rows.calibrated_height_px = 0;
  auto calibration = calibration_from_raw(std::move(pair), of_rows, table.source);
  calibration.left_name = fmt::format("socket {}", left);
  calibration.right_name = fmt::format("socket {}", right);
  return calibration;
}

}  // namespace

const CalibrationFormat kDepthAi{"DepthAI calibration", true, false,
                                 [](const NumberTable& table) { return prefix_of(table).has_value(); }, read_depthai};

}  // namespace flies::detail
