#pragma once

#include <optional>
#include <string>

#include "flies/core/plausible.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/number_table.hpp"

namespace flies::detail {

/// A calibration format: how to know it and how to read it.
struct CalibrationFormat {
  const char* name;
  bool has_cameras;      ///< may say more than two, of which a pair is chosen
  bool has_second_file;  ///< may be split into two
  bool (*matches)(const NumberTable& table);
  /// Fills camera, names and notes; name, mount defaults and the checks common to all are the caller's.
  Calibration (*read)(const NumberTable& table, const CalibrationRequest& request);
};

extern const CalibrationFormat kKittiObject, kKittiRaw, kKittiOdometry, kMiddlebury, kPlainYaml, kRosCameraInfo,
    kOpenCvStereo, kKalibr, kEuroc, kOrbSlam, kZed, kDepthAi, kBasalt, kMatlab, kCameraMatrixText, kStereodemo, kStixel,
    kCityscapes, kVins, kRealSense, kStellaVslam, kOkvis, kOv2Slam, kKimera, kFlat, kVirtualKitti, kMrpt, kTwoCameras,
    kDsec, kBouguet, kArgoverse, kOpenCvExtrinsics, kMaplab;

/// The one whose keys a file has. @throws InputError that names all when it has those of none
const CalibrationFormat& recognised_format(const NumberTable& table);

/// A 3 x 4 projection matrix and where it was read.
struct ProjectionKey {
  const NumberTable& table;
  std::string key;
};

/// The rectified camera of two projection matrices K [I | t].
/// @throws InputError when they are not the two halves of a rectified pair
Calibration calibration_from_projections(const ProjectionKey& left, const ProjectionKey& right);

/// Where one camera of ROS is described: its keys ("P", "projection_matrix", "roi.width", ...) begin with `prefix`.
struct RosCameraKeys {
  const NumberTable& table;
  std::string prefix;
};

/// What two camera_info say, of a file or of a recording: of images as the cameras gave them where the request says so,
/// else of rectified ones.
/// @throws InputError when they are not calibrated, or not as a pair
Calibration calibration_from_ros(const RosCameraKeys& left, const RosCameraKeys& right,
                                 const CalibrationRequest& request);

/// What is common to all formats once one was read: what the request overrules, the size of the images, all checks.
/// @param source of the calibration, for errors
Calibration completed(Calibration calibration, const CalibrationRequest& request, const std::string& source);

/// 0, for `override_baseline`, in a file without a baseline.
/// @param key where it would stand
/// @throws InputError naming --baseline unless the user says it
double missing_baseline(const CalibrationRequest& request, const std::string& source, const std::string& key);

/// @throws InputError when the baseline that the user says is not above 0
void check_asked_baseline(double baseline_m, const std::string& source);

/// Takes the baseline that the user says, in the direction that was read, with a note. 0 of rectified cameras is one
/// that the file leaves out; one that was read as below 0, or as 0 of raw cameras, is left to who refuses it.
/// @throws InputError when it is not above 0
void override_baseline(double baseline_m, const std::string& source, Calibration& calibration);

/// The baseline that the user says, or that of the file.
/// @throws InputError when it is not above 0, or one in metres where the format has it times the focal length
void settle_baseline(const CalibrationRequest& request, const std::string& source, Calibration& calibration);

/// @throws InputError when the user says that the calibration is for images of another size than this one
void check_said_size(int width_px, int height_px, const CalibrationRequest& request, const std::string& source);

/// @throws InputError when the images were padded from this size, or its shape
void check_not_padded(int width_px, int height_px, const CalibrationRequest& request, const std::string& source);

/// How the images were resized from this size: by one scale, or by any that the request says.
std::optional<ImageScale> scale_to_images(int width_px, int height_px, const CalibrationRequest& request);

/// A doubt where images cut out of larger ones would look the same.
CalibrationNote note_on_scale(int width_px, int height_px, const ImageScale& scale, const CalibrationRequest& request);

/// The sentence on a size that the principal point told where the file has none.
std::string note_on_deduced_size(double cx_px, double cy_px, int width_px, int height_px);

/// Whether the numbers are those of the images, whatever size the file says, and the user says nothing else.
bool is_of_other_size(const StereoCamera& camera, const CalibrationRequest& request);

/// A doubt where a file says a size that its numbers are not for, and the images have the one that they are for.
CalibrationNote note_on_wrong_size(const StereoCamera& camera, int width_px, int height_px);

/// The sentence on a size whose width and height were exchanged.
/// @param width_px, height_px as they are taken
std::string note_on_exchanged_size(int width_px, int height_px);

}  // namespace flies::detail
