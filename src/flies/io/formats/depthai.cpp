// Calibration of OAK cameras as `depthai` writes it to JSON: sockets, and for each the pose of another; centimetres.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "flies/core/error.hpp"
#include "flies/io/formats/raw_pair.hpp"

namespace flies::detail {
namespace {

constexpr double kMetresPerCentimetre = 1e-2;

/// Where each socket stands in the list.
using Sockets = std::map<int, std::string>;

Sockets sockets_of(const NumberTable& table) {
  Sockets sockets;
  for (int i = 0; table.has(fmt::format("cameraData.{}.0", i)); ++i) {
    const double socket = table.require_number(fmt::format("cameraData.{}.0", i));
    if (socket < 0.0 || socket > 100.0)
      throw InputError(table.source, fmt::format("cameraData.{}.0", i), fmt::format("found socket {}", socket));
    sockets[static_cast<int>(std::lround(socket))] = fmt::format("cameraData.{}.1.", i);
  }
  return sockets;
}

const std::string& prefix_of(const NumberTable& table, const Sockets& sockets, int socket) {
  const auto found = sockets.find(socket);
  if (found == sockets.end())
    throw InputError(table.source, "cameraData", fmt::format("has no camera at socket {}", socket));
  return found->second;
}

RawCamera read_camera(const NumberTable& table, const std::string& prefix) {
  RawCamera raw;
  raw.matrix = matrix_of(table, prefix + "intrinsicMatrix");
  raw.distortion = table.require(prefix + "distortionCoeff");
  constexpr double kFisheye = 1.0;
  constexpr std::size_t kFisheyeCoefficients = 4;
  if (table.has(prefix + "cameraType") && table.require_number(prefix + "cameraType") == kFisheye) {
    raw.lens = Lens::equidistant;
    if (raw.distortion.size() > kFisheyeCoefficients) raw.distortion.resize(kFisheyeCoefficients);
  }
  return raw;
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
    const int next = static_cast<int>(std::lround(table.require_number(extrinsics + "toCameraSocket")));
    if (next < 0) break;
    const auto axis = [&](const char* name) { return table.require_number(extrinsics + "translation." + name); };
    pose = chained(Pose{rotation_of(table, extrinsics + "rotationMatrix", notes), {axis("x"), axis("y"), axis("z")}},
                   pose);
    socket = next;
  }
  return way;
}

Pose right_from_left(const NumberTable& table, const Sockets& sockets, int left, int right, CalibrationNotes& notes) {
  const auto from_left = way_from(table, sockets, left, notes), from_right = way_from(table, sockets, right, notes);
  for (const auto& [socket, pose] : from_left)
    if (const auto meets = from_right.find(socket); meets != from_right.end())
      return scaled(chained(inverse(meets->second), pose), kMetresPerCentimetre);
  throw InputError(table.source, "extrinsics", fmt::format("lead from socket {} to {} nowhere", left, right));
}

Calibration read_depthai(const NumberTable& table, const CalibrationRequest& request) {
  const auto sockets = sockets_of(table);
  const auto named = [&](const char* side, int otherwise) {
    const std::string key = fmt::format("stereoRectificationData.{}CameraSocket", side);
    const double socket = table.has(key) ? table.require_number(key) : -1.0;
    return socket >= 0.0 && socket < 100.0 ? static_cast<int>(std::lround(socket)) : otherwise;
  };
  const auto [left, right] = request.cameras.value_or(std::array{named("left", 1), named("right", 2)});
  const std::string left_prefix = prefix_of(table, sockets, left), right_prefix = prefix_of(table, sockets, right);
  RawPair pair{{}, left_prefix + "intrinsicMatrix", right_prefix + "intrinsicMatrix", left_prefix + "extrinsics"};
  const auto size_of = [&](const std::string& prefix) {
    return ImageSize{table.require_size(prefix + "width"), table.require_size(prefix + "height")};
  };
  const ImageSize size = size_of(left_prefix);
  check_same_size(size, size_of(right_prefix), table.source, right_prefix + "width, height");
  pair.stereo.width_px = size.width_px;
  pair.stereo.height_px = size.height_px;
  pair.stereo.left = read_camera(table, left_prefix);
  pair.stereo.right = read_camera(table, right_prefix);
  set_pose(pair.stereo, right_from_left(table, sockets, left, right, pair.notes));
  auto calibration = calibration_from_raw(std::move(pair), request, table.source);
  calibration.left_name = fmt::format("socket {}", left);
  calibration.right_name = fmt::format("socket {}", right);
  return calibration;
}

}  // namespace

const CalibrationFormat kDepthAi{"DepthAI calibration", true, false,
                                 [](const NumberTable& table) { return table.has("cameraData.0.0"); }, read_depthai};

}  // namespace flies::detail
