#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/stereo_camera.hpp"
#include "flies/io/image_borders.hpp"
#include "flies/io/rectifier.hpp"

namespace flies {

/// What the user adds to a calibration file. See docs/formats.md for the formats.
struct CalibrationRequest {
  /// Second file: the right camera of a ROS pair, or the other half of OpenCV's intrinsics.yml and extrinsics.yml.
  /// When empty, the right file of a ROS pair is looked for beside the left one.
  std::string right_path;
  /// Cameras, left and right, of formats that may have more than two; other formats refuse them.
  std::optional<std::array<int, 2>> cameras;
  std::array<int, 2> default_cameras = {2, 3};  ///< KITTI cameras when none are given; other formats ignore them
  /// Size of the images, 0 and 0 when not known: used when the file does not say, and scaled to when it is the file's
  /// but for one scale.
  int width_px = 0;
  int height_px = 0;
  /// Of images of that size: they are refused where the calibration fits what is inside the borders, and them only.
  ImageBorders borders;
  /// The images are as the cameras gave them: matters where a file says both what raw and what rectified images are.
  bool images_are_raw = false;
  /// The images were resized from the calibration's size, as much across and down as the sizes say: cut off nowhere.
  bool images_are_resized = false;
  int calibrated_width_px = 0;  ///< size that a file without one, or with several, is for; 0 and 0: not known
  int calibrated_height_px = 0;
  std::optional<double> baseline_m;  ///< these four overrule the file, whose lengths may be in another unit
  std::optional<double> camera_height_m;
  std::optional<double> camera_pitch_rad;
  std::optional<double> camera_roll_rad;
  /// Pixels of the rectified images, added to every disparity: makes up for cameras that are turned towards or away
  /// from each other, or for a wrong principal point of one of them (docs/adr/0021). Less than the image is wide.
  double disparity_shift_px = 0.0;
};

/// What a note on a calibration asks of its reader.
enum class CalibrationNoteKind {
  told,   ///< nothing: how the file is taken, where it or the request says so
  mount,  ///< nothing, if it is so: how the camera is taken to stand, whatever images and file are
  doubt,  ///< to check something: the file may be wrong or not that of the images, and all ranges with it
};

struct CalibrationNote {
  std::string text;  ///< a sentence
  CalibrationNoteKind kind = CalibrationNoteKind::doubt;
  bool operator==(const CalibrationNote&) const = default;
};

using CalibrationNotes = std::vector<CalibrationNote>;

/// The sentences of these kinds, in their order; of all where none is named.
std::vector<std::string> texts(const CalibrationNotes& notes, std::initializer_list<CalibrationNoteKind> kinds = {});

/// What was understood of a calibration.
struct Calibration {
  StereoCamera camera;
  std::string format;                 ///< "KITTI raw calib_cam_to_cam", ...
  std::string left_name, right_name;  ///< how the file calls the two cameras: "P2" and "P3", "cam0" and "cam1"
  bool has_height = false;            ///< the file or the request gave it; otherwise the default stands in `camera`
  bool has_pitch = false;
  std::optional<Rectifier> rectifier;  ///< present when the images are raw: rectify them before anything else
  CalibrationNotes notes;              ///< on what was ignored or assumed
};

/// Lets a request ask for the calibration of these images, as they were read: of their size and without borders.
void ask_for_images(CalibrationRequest& request, const RectifiedPair& images);

/// Reads a calibration; the format is recognised from the content, not from the name.
/// @throws InputError naming file and key: unreadable, unknown format, missing key, wrong count, not finite, zero focal
///         length, baseline not positive (left and right swapped), not a rectified pair, a unit or size that cannot be,
///         images that were padded
Calibration load_calibration(const std::string& path, const CalibrationRequest& request = {});

/// The camera as the plain YAML that `load_calibration` reads back to the same values.
std::string calibration_yaml(const StereoCamera& camera);

/// Formats that calibrations are converted to.
enum class CalibrationSyntax {
  kitti,   ///< KITTI object calib.txt: rectified images, without their size
  opencv,  ///< P1 and P2 of rectified images; M1 D1 M2 D2 R T of raw ones
  ros,     ///< camera_info, a file for each camera
  yaml,    ///< our own: rectified images, with the mount
};

struct CalibrationTexts {
  std::string text;   ///< the file, or that of the left camera
  std::string right;  ///< that of the right camera, where each has one; otherwise empty
};

/// The calibration in another format. Raw images stay raw, where the format has a place for them.
/// @param source name of the calibration for errors
/// @throws InputError when the format has none: KITTI and our own for raw images, OpenCV and ROS for lenses that they
///         do not have
CalibrationTexts calibration_texts(const Calibration& calibration, CalibrationSyntax syntax,
                                   const std::string& source = "calibration");

/// The KITTI cameras that a pair of paths names: `image_00`, `image_0` and the like in a folder or file name.
/// @returns nothing unless the paths name one each, and not the same
std::optional<std::array<int, 2>> kitti_cameras_from_paths(const std::string& left, const std::string& right);

}  // namespace flies
