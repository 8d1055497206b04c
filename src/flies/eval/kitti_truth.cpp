#include "flies/eval/kitti_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "flies/core/error.hpp"
#include "flies/core/letters.hpp"
#include "flies/eval/text.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/number_table.hpp"

namespace flies {
namespace {

constexpr double kMinInView = 0.5;  // at least half of the box inside the image
constexpr double kMaxTruncation = 0.5;
constexpr double kMinFree = 0.5;          // of a box whose occlusion is labelled "unknown"
constexpr double kMinDepth_m = 0.5;       // objects beside and behind the camera are not looked at
constexpr double kLidarReach_m = 1000.0;  // of any sensor; farther returns, and those that are no numbers, are damage
constexpr int kMostFrames = 1'000'000;    // of a drive
constexpr int kFullyOccluded = 2, kOcclusionUnknown = 3, kOutsideImage = 2;

using detail::LidarPlace;
using detail::parse_number;
using Matrix3 = std::array<std::array<double, 3>, 3>;

std::vector<std::string> split_words(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

Point3 rotate(const Matrix3& m, const Point3& p) {
  const auto row = [&](std::size_t i) { return m[i][0] * p.x_m + m[i][1] * p.y_m + m[i][2] * p.z_m; };
  return {row(0), row(1), row(2)};
}

Point3 add(const Point3& a, const Point3& b) { return {a.x_m + b.x_m, a.y_m + b.y_m, a.z_m + b.z_m}; }

Matrix3 matrix3(const std::vector<double>& v, std::size_t columns) {
  Matrix3 m{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = v[i * columns + j];
  }
  return m;
}

/// What P = K [I | t] adds to a rectified camera-0 point to reach the frame of its own camera: K^-1 times column 4.
Point3 left_camera_offset(const std::vector<double>& p) {
  return {(p[3] - p[2] * p[11]) / p[0], (p[7] - p[6] * p[11]) / p[5], p[11]};
}

LidarPlace read_drive_place(const std::filesystem::path& day, int left_camera) {
  const NumberTable lidar = read_number_table((day / "calib_velo_to_cam.txt").string());
  const NumberTable cameras = read_number_table((day / "calib_cam_to_cam.txt").string());
  const auto& shift = lidar.require("T", 3);
  return {matrix3(lidar.require("R", 9), 3),
          {shift[0], shift[1], shift[2]},
          matrix3(cameras.require("R_rect_00", 9), 3),
          left_camera_offset(cameras.require(fmt::format("P_rect_{:02}", left_camera), 12))};
}

LidarPlace read_object_place(const std::filesystem::path& file) {
  const NumberTable calibration = read_number_table(file.string());
  const auto& lidar = calibration.require("Tr_velo_to_cam", 12);
  return {matrix3(lidar, 4),
          {lidar[3], lidar[7], lidar[11]},
          matrix3(calibration.require("R0_rect", 9), 3),
          left_camera_offset(calibration.require("P2", 12))};
}

std::vector<LidarPoint> read_lidar(const std::filesystem::path& path, const LidarPlace& place,
                                   const StereoCamera& camera) {
  if (!detail::is_there(path)) return {};
  const std::string bytes = detail::read_truth(path);
  constexpr std::size_t kRecord = 4 * sizeof(float);  // x y z reflectance
  if (bytes.size() % kRecord != 0) {
    throw InputError(path.string(), "", fmt::format("found {} bytes, expected a multiple of 16", bytes.size()));
  }
  const Projection projection(camera);
  std::vector<Point3> points;
  for (std::size_t at = 0; at < bytes.size(); at += kRecord) {
    std::array<float, 3> xyz{};
    std::memcpy(xyz.data(), bytes.data() + at, sizeof(xyz));
    const Point3 in_camera = place.in_left_camera({xyz[0], xyz[1], xyz[2]});
    const bool is_near = std::hypot(in_camera.x_m, in_camera.y_m, in_camera.z_m) < kLidarReach_m;  // not so a NaN
    if (is_near && in_camera.z_m > kMinDepth_m)
      points.push_back(vehicle_from_left_camera(camera, projection, in_camera));
  }
  return measure_above_road(points);
}

/// Places a box given by its bottom centre and a second point along its heading, both in the left camera's frame.
void place_object(const StereoCamera& camera, const Point3& centre, const Point3& ahead, LabelledObject& object) {
  const Projection projection(camera);
  const Point3 base = vehicle_from_left_camera(camera, projection, centre);
  const Point3 tip = vehicle_from_left_camera(camera, projection, ahead);
  object.footprint.x_m = base.x_m;
  object.footprint.y_m = base.y_m;
  object.footprint.yaw_rad = std::atan2(tip.y_m - base.y_m, tip.x_m - base.x_m);
  object.bottom_z_m = base.z_m;
}

/// Distance along the heading of the second point: small, so that it stays ahead of the camera.
constexpr double kHeadingStep_m = 0.1;

double child_number(const pugi::xml_node& node, const char* field, const std::string& source) {
  const auto child = node.child(field);
  if (!child) throw InputError(source, field, "not found in a tracklet");
  return parse_number(detail::trimmed(child.text().get()), source, field);
}

int child_int(const pugi::xml_node& node, const char* field, const std::string& source) {
  child_number(node, field, source);  // tells what is missing
  return detail::parse_whole_number(detail::trimmed(node.child(field).text().get()), source, field);
}

void check_has_size(const StereoCamera& camera) {
  if (camera.width_px > 0 && camera.height_px > 0) return;
  throw InputError("camera of the labels", "width_px, height_px", "found none, expected the size of the left image");
}

LabelledObject place_tracklet(const TrackletPose& pose, const LidarPlace& place, const StereoCamera& camera) {
  LabelledObject object{pose.type, pose.track, {0, 0, 0, pose.length_m, pose.width_m}};
  object.height_m = pose.height_m;
  object.occlusion = pose.occlusion < 0 ? kOcclusionUnknown : pose.occlusion;
  const Point3 ahead =
      add(pose.bottom_centre, {kHeadingStep_m * std::cos(pose.yaw_rad), kHeadingStep_m * std::sin(pose.yaw_rad), 0.0});
  place_object(camera, place.in_left_camera(pose.bottom_centre), place.in_left_camera(ahead), object);
  return object;
}

}  // namespace

std::vector<TrackletPose> parse_tracklets(std::string_view xml, const std::string& source) {
  pugi::xml_document document;
  const auto result = document.load_buffer(xml.data(), xml.size());
  if (!result) throw InputError(source, "", fmt::format("not XML: {}", result.description()));
  const auto tracklets = document.child("boost_serialization").child("tracklets");
  if (!tracklets) throw InputError(source, "tracklets", "not found in the file");

  std::vector<TrackletPose> poses;
  int track = 0;
  for (const auto& item : tracklets.children("item")) {
    TrackletPose pose;
    pose.type = item.child("objectType").text().get();
    pose.track = track++;
    pose.height_m = child_number(item, "h", source);
    pose.width_m = child_number(item, "w", source);
    pose.length_m = child_number(item, "l", source);
    if (!(std::min({pose.height_m, pose.width_m, pose.length_m}) > 0.0)) {
      throw InputError(source, "h, w, l", fmt::format("tracklet {}: found a size that is not positive", pose.track));
    }
    pose.frame = child_int(item, "first_frame", source);
    if (pose.frame < 0 || pose.frame > kMostFrames)
      throw InputError(source, "first_frame", fmt::format("found {}, expected 0 to {}", pose.frame, kMostFrames));
    for (const auto& place : item.child("poses").children("item")) {
      pose.bottom_centre = {child_number(place, "tx", source), child_number(place, "ty", source),
                            child_number(place, "tz", source)};
      pose.yaw_rad = child_number(place, "rz", source);
      pose.occlusion = child_int(place, "occlusion", source);
      pose.truncation = child_int(place, "truncation", source);
      poses.push_back(pose);
      ++pose.frame;
    }
  }
  return poses;
}

/// All are compared with all; KITTI has some thirty at most.
constexpr std::size_t kMostLabels = 2000;

std::vector<KittiLabel> parse_labels(std::string_view text, const std::string& source) {
  std::vector<KittiLabel> labels;
  for (const auto& [number, content] : detail::lines_of(text)) {
    const auto words = split_words(content);
    const std::string field = fmt::format("line {}", number);
    if (labels.size() == kMostLabels)
      throw InputError(source, field, fmt::format("there are more than {} labels of one picture", kMostLabels));
    if (words.size() != 15 && words.size() != 16) {
      throw InputError(source, field, fmt::format("found {} fields, expected 15", words.size()));
    }
    const auto at = [&](std::size_t i) { return parse_number(words[i], source, field); };
    labels.push_back({words[0],
                      at(1),
                      detail::parse_whole_number(words[2], source, field),
                      {at(4), at(5), at(6) - at(4), at(7) - at(5)},
                      at(8),
                      at(9),
                      at(10),
                      {at(11), at(12), at(13)},
                      at(14)});
  }
  return labels;
}

Point3 detail::LidarPlace::in_left_camera(const Point3& in_lidar) const {
  const Point3 in_camera0 = add(rotate(camera0_from_lidar, in_lidar), camera0_from_lidar_shift);
  return add(rotate(rectification, in_camera0), left_offset);
}

KittiDrive::KittiDrive(const std::filesystem::path& drive, const StereoCamera& camera, int left_camera)
    : drive_(drive), camera_(camera), place_(read_drive_place(drive.parent_path(), left_camera)) {
  check_has_size(camera);
  const auto tracklets = drive / "tracklet_labels.xml";
  poses_ = parse_tracklets(detail::read_truth(tracklets), tracklets.string());
}

FrameTruth KittiDrive::read(const std::string& name) const {
  FrameTruth truth;
  truth.name = name;
  truth.frame = detail::parse_whole_number(name, drive_.string(), "image name");
  truth.lidar = read_lidar(drive_ / "velodyne_points" / "data" / (name + ".bin"), place_, camera_);
  std::vector<bool> labelled_in_view;
  for (const auto& pose : poses_) {
    if (pose.frame != truth.frame || place_.in_left_camera(pose.bottom_centre).z_m < 2 * kMinDepth_m) continue;
    truth.objects.push_back(place_tracklet(pose, place_, camera_));
    labelled_in_view.push_back(pose.occlusion != kFullyOccluded && pose.truncation < kOutsideImage);
  }
  measure_visibility(camera_, truth);
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    auto& object = truth.objects[i];
    object.visible = labelled_in_view[i] && object.in_view_fraction >= kMinInView &&
                     (truth.lidar.empty() || object.lidar_points >= kMinLidarPoints);
  }
  return truth;
}

std::vector<FrameTruth> read_kitti_drive(const std::filesystem::path& drive, const StereoCamera& camera,
                                         int left_camera) {
  const KittiDrive truth(drive, camera, left_camera);
  const auto images = drive / fmt::format("image_{:02}", left_camera) / "data";
  if (!detail::is_there_as_folder(images)) throw InputError(images.string(), "", "is not a folder");
  std::set<std::string> names;
  for (const auto& file : detail::files_of(images))
    if (detail::is_image_name(file)) names.insert(file.stem().string());
  std::vector<FrameTruth> frames;
  for (const auto& name : names) frames.push_back(truth.read(name));
  return frames;
}

FrameTruth read_kitti_object(const std::filesystem::path& folder, const std::string& name, const StereoCamera& camera) {
  check_has_size(camera);
  const LidarPlace place = read_object_place(folder / "calib" / (name + ".txt"));
  const auto label_path = folder / "label_2" / (name + ".txt");
  FrameTruth truth;
  truth.name = name;
  const auto all_digits = std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
  truth.frame = all_digits ? detail::parse_whole_number(name, label_path.string(), "file name") : 0;
  truth.lidar = read_lidar(folder / "velodyne" / (name + ".bin"), place, camera);
  int line = 0;
  for (const auto& label : parse_labels(detail::read_truth(label_path), label_path.string())) {
    if (label.type == "DontCare") {
      truth.ignored_regions.push_back(label.box);
      continue;
    }
    LabelledObject object{label.type, line++, {0, 0, 0, label.length_m, label.width_m}};
    object.box = label.box;
    object.height_m = label.height_m;
    object.occlusion = label.occlusion;
    object.truncation = label.truncation;
    const Point3 centre = add(label.bottom_centre, place.left_offset);
    if (centre.z_m < 2 * kMinDepth_m) continue;
    const Point3 ahead = add(centre, {kHeadingStep_m * std::cos(label.rotation_y_rad), 0.0,
                                      -kHeadingStep_m * std::sin(label.rotation_y_rad)});
    place_object(camera, centre, ahead, object);
    truth.objects.push_back(object);
  }
  measure_visibility(camera, truth);
  for (auto& object : truth.objects) {
    const bool free = object.occlusion == kOcclusionUnknown ? free_fraction(camera, truth, object) >= kMinFree
                                                            : object.occlusion < kFullyOccluded;
    object.visible = free && object.truncation <= kMaxTruncation && object.in_view_fraction >= kMinInView &&
                     (truth.lidar.empty() || object.lidar_points >= kMinLidarPoints);
  }
  return truth;
}

}  // namespace flies
