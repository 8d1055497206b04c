#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/name_hint.hpp"
#include "flies/core/options.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/output_file.hpp"
#include "flies/pipeline/detector.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/standard_output.hpp"

namespace {

struct CalibArguments {
  std::string file;
  std::vector<int> size_px;
  CameraArguments camera;
  bool json = false;
  std::string format, output;  ///< to convert to; empty: print what was understood
};

flies::CalibrationRequest request_of(const CalibArguments& arguments) {
  flies::CalibrationRequest request = calibration_request(arguments.camera);
  if (arguments.size_px.size() == 2) {
    request.width_px = arguments.size_px[0];
    request.height_px = arguments.size_px[1];
  }
  return request;
}

/// The angle between the first and the last column (or row), or nothing when the size is not known.
std::optional<double> field_of_view_deg(double focal_px, double centre_px, int size_px) {
  if (size_px == 0) return std::nullopt;
  return flies::degrees(std::atan(centre_px / focal_px) + std::atan((size_px - 1 - centre_px) / focal_px));
}

/// Ranges that deviations are told for.
constexpr double kTold_m[] = {2.0, 5.0, 10.0, 20.0};

/// What a patch of a fly covers: a smaller thing may be missed.
constexpr double kPatchColumns_px = 6.0, kPatchRows_px = 9.0;

std::string deviations(const flies::StereoCamera& camera) {
  std::string text;
  for (const double range_m : kTold_m)
    text += fmt::format("{}{:.2f} m at {:.0f} m", text.empty() ? "" : ", ", flies::range_deviation_m(camera, range_m),
                        range_m);
  return text;
}

std::string smallest(const flies::StereoCamera& camera) {
  std::string text;
  for (const double range_m : kTold_m)
    text += fmt::format("{}{:.0f} x {:.0f} cm at {:.0f} m", text.empty() ? "" : ", ",
                        100.0 * kPatchColumns_px * range_m / camera.fx_px,
                        100.0 * kPatchRows_px * range_m / camera.fy_px, range_m);
  return text;
}

/// The field of detection of the preset `default` for this camera.
flies::FieldOptions field_of(const flies::StereoCamera& camera) {
  return flies::fitted_options(camera, flies::preset_options(flies::Preset::standard)).field;
}

double depth_at_one_pixel_m(const flies::StereoCamera& camera) { return camera.fx_px * camera.baseline_m; }

/// Where a number of the mount comes from.
std::string origin(bool on_command_line, bool known) {
  if (on_command_line) return "command line";
  return known ? "file" : "default";
}

std::string table(const flies::Calibration& calibration, const CalibArguments& arguments) {
  const auto& camera = calibration.camera;
  std::string text;
  const auto line = [&](const char* name, const std::string& value) { text += fmt::format("{:<24}{}\n", name, value); };
  line("format", calibration.format);
  line("left, right", calibration.left_name + ", " + calibration.right_name);
  line("images", calibration.rectifier ? "raw, rectified first" : "rectified");
  line("image size", camera.width_px > 0 ? fmt::format("{} x {} px", camera.width_px, camera.height_px)
                                         : "not in the file; taken from the images");
  line("focal length", fmt::format("{:.3f} px horizontally, {:.3f} px vertically", camera.fx_px, camera.fy_px));
  line("principal point", fmt::format("({:.3f}, {:.3f}) px", camera.cx_px, camera.cy_px));
  if (camera.cx_right_px != camera.cx_px)
    line("  of the right image", fmt::format("({:.3f}, {:.3f}) px", camera.cx_right_px, camera.cy_px));
  line("baseline", fmt::format("{:.4f} m", camera.baseline_m));
  line("camera height", fmt::format("{:.3f} m ({})", camera.mount.height_m,
                                    origin(arguments.camera.height_m.has_value(), calibration.has_height)));
  line("camera pitch", fmt::format("{:.3f} deg, down is positive ({})", flies::degrees(camera.mount.pitch_rad),
                                   origin(arguments.camera.pitch_deg.has_value(), calibration.has_pitch)));
  line("camera roll", fmt::format("{:.3f} deg, left side up is positive", flies::degrees(camera.mount.roll_rad)));
  const auto across_deg = field_of_view_deg(camera.fx_px, camera.cx_px, camera.width_px);
  const auto down_deg = field_of_view_deg(camera.fy_px, camera.cy_px, camera.height_px);
  line("field of view", across_deg && down_deg
                            ? fmt::format("{:.1f} deg horizontally, {:.1f} deg vertically", *across_deg, *down_deg)
                            : "not known without the image size");
  line("range at 1 px disparity", fmt::format("{:.1f} m", depth_at_one_pixel_m(camera)));
  line("range error (1 sd)", deviations(camera));
  line("smallest thing seen", smallest(camera));
  const flies::FieldOptions field = field_of(camera);
  line("looked at", fmt::format("{:.1f} to {:.1f} m ahead", field.x_min_m, field.x_max_m));
  for (const auto& note : calibration.notes) line("note", note.text);
  return text;
}

std::string json(const flies::Calibration& calibration) {
  const auto& camera = calibration.camera;
  const flies::FieldOptions field = field_of(camera);
  const nlohmann::ordered_json object = {
      {"format", calibration.format},
      {"left", calibration.left_name},
      {"right", calibration.right_name},
      {"rectified", !calibration.rectifier.has_value()},
      {"fx_px", camera.fx_px},
      {"fy_px", camera.fy_px},
      {"cx_px", camera.cx_px},
      {"cx_right_px", camera.cx_right_px},
      {"cy_px", camera.cy_px},
      {"baseline_m", camera.baseline_m},
      {"width_px", camera.width_px},
      {"height_px", camera.height_px},
      {"height_m", camera.mount.height_m},
      {"height_is_default", !calibration.has_height},
      {"pitch_deg", flies::degrees(camera.mount.pitch_rad)},
      {"pitch_is_default", !calibration.has_pitch},
      {"roll_deg", flies::degrees(camera.mount.roll_rad)},
      {"range_sd_at_10_m", flies::range_deviation_m(camera, 10.0)},
      {"field_x_min_m", field.x_min_m},
      {"field_x_max_m", field.x_max_m},
      {"notes", texts(calibration.notes)},
  };
  constexpr int kIndent = 2;
  return object.dump(kIndent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

constexpr std::array<std::pair<const char*, flies::CalibrationSyntax>, 4> kSyntaxes = {
    {{"kitti", flies::CalibrationSyntax::kitti},
     {"opencv", flies::CalibrationSyntax::opencv},
     {"ros", flies::CalibrationSyntax::ros},
     {"yaml", flies::CalibrationSyntax::yaml}}};

flies::CalibrationSyntax syntax_of(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& [known, syntax] : kSyntaxes) {
    if (name == known) return syntax;
    names.emplace_back(known);
  }
  throw flies::InputError(
      "--write", name,
      fmt::format("unknown format, allowed: {}{}", fmt::join(names, ", "), flies::did_you_mean(name, names)));
}

/// "rig/left.yaml" -> "rig/right.yaml"
std::string right_path_of(const std::string& left) {
  const std::filesystem::path path(left);
  std::string name = path.filename().string();
  const auto at = name.rfind("left");
  if (at == std::string::npos)
    throw flies::InputError(left, "file name",
                            "has no 'left' in it: ROS has one file per camera, and the name of the right one is made "
                            "from that of the left one (--output left.yaml)");
  name.replace(at, std::string_view("left").size(), "right");
  return (path.parent_path() / name).string();
}

/// Height, pitch and roll of a camera that has them from file or command line, as options.
std::string mount_options(const flies::Calibration& calibration) {
  const auto& mount = calibration.camera.mount;
  std::string options;
  if (calibration.has_height) options += fmt::format(" --camera-height {:.6g}", mount.height_m);
  if (calibration.has_pitch) options += fmt::format(" --camera-pitch {:.6g}", flies::degrees(mount.pitch_rad));
  if (mount.roll_rad != 0.0) options += fmt::format(" --camera-roll {:.6g}", flies::degrees(mount.roll_rad));
  return options;
}

/// What the file does not hold any more, and what it holds as if somebody had said it.
std::vector<std::string> losses(const flies::Calibration& calibration, flies::CalibrationSyntax syntax) {
  std::vector<std::string> notes;
  const bool is_yaml = syntax == flies::CalibrationSyntax::yaml;
  if (const std::string options = mount_options(calibration); !is_yaml && !options.empty())
    notes.push_back("this format cannot hold height, pitch and roll of the camera: give them again with" + options);
  if (is_yaml && (!calibration.has_height || !calibration.has_pitch))
    notes.push_back(
        fmt::format("the new file has the height {:.3g} m and the pitch {:.3g} degrees, as if they were known: "
                    "correct what was not given",
                    calibration.camera.mount.height_m, flies::degrees(calibration.camera.mount.pitch_rad)));
  if (syntax == flies::CalibrationSyntax::kitti && calibration.camera.width_px > 0)
    notes.emplace_back("this format cannot hold the size of the images");
  if (syntax == flies::CalibrationSyntax::ros && calibration.rectifier)
    notes.emplace_back("the files describe raw images: read them with --raw");
  return notes;
}

void check_outputs(const CalibArguments& arguments, bool is_ros) {
  OutputClaims claims;
  claims.reads_calibration(arguments.file, arguments.camera.right_calib);
  claims.writes(arguments.output, "--output");
  if (is_ros) claims.writes(right_path_of(arguments.output), "--output");
}

void convert(const flies::Calibration& calibration, const CalibArguments& arguments) {
  const auto syntax = syntax_of(arguments.format);
  if (calibration.rectifier && arguments.camera.disparity_shift_px != 0.0)
    throw flies::InputError("--disparity-shift", arguments.file,
                            "describes raw images, and a shift of rectified ones cannot be written into such a file: "
                            "calibrate again, or give --disparity-shift to detect, track or live");
  const bool is_ros = syntax == flies::CalibrationSyntax::ros;
  if (is_ros && arguments.output.empty())
    throw flies::InputError("--write", "ros", "writes two files: name the one of the left camera (--output left.yaml)");
  check_outputs(arguments, is_ros);
  const auto texts = flies::calibration_texts(calibration, syntax, arguments.file);
  if (is_ros) {
    flies::OutputFile left(arguments.output), right(right_path_of(arguments.output));
    left.write(texts.text);
    right.write(texts.right);
    left.commit();
    right.commit();
  } else if (arguments.output.empty()) {
    print(texts.text);
  } else {
    flies::write_file(arguments.output, texts.text);
  }
  say_notes(flies::texts(calibration.notes, {flies::CalibrationNoteKind::doubt}));  // which the new file may not raise
  say_notes(losses(calibration, syntax));
}

void run_calib(const CalibArguments& arguments) {
  if (!arguments.output.empty() && arguments.format.empty())
    throw flies::InputError("--output", arguments.output, "needs a format: --write kitti, opencv, ros or yaml");
  const auto request = request_of(arguments);
  const auto calibration = flies::load_calibration(arguments.file, request);
  if (request.width_px > 0)
    flies::check_camera_fits(calibration.camera, request.width_px, request.height_px, arguments.file);
  if (!arguments.format.empty()) return convert(calibration, arguments);
  print(arguments.json ? json(calibration) : table(calibration, arguments));
}

}  // namespace

void setup_calib(CLI::App& app) {
  CLI::App* command = app.add_subcommand("calib", "print what a calibration file says, in metres and pixels");
  const auto arguments = std::make_shared<CalibArguments>();
  command->add_option("FILE", arguments->file, "calibration; the format is recognised from its content")->required();
  command->add_option("--right,--right-calib", arguments->camera.right_calib,
                      "second file: the right camera of a ROS pair, or OpenCV's other half (intrinsics beside "
                      "extrinsics)");
  add_cameras_option(*command, arguments->camera,
                     "left and right camera in a file of KITTI (default 2,3), Kalibr, DepthAI, DSEC or Basalt");
  command->add_option("--size", arguments->size_px, "size of the images, where the file gives none or another one")
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(1, 100000))
      ->type_name("W,H");
  add_raw_option(*command, arguments->camera);
  add_resized_option(*command, arguments->camera);
  add_calibrated_size_option(*command, arguments->camera);
  add_baseline_option(*command, arguments->camera);
  add_disparity_shift_option(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  command->add_option("--write", arguments->format, "convert to: kitti, opencv, ros, yaml")->type_name("FORMAT");
  command
      ->add_option("--output", arguments->output,
                   "file to write, default standard output; ros writes one file per camera: name that of the left one, "
                   "e.g. left.yaml")
      ->type_name("FILE");
  command->add_flag("--json", arguments->json, "print JSON instead of a table");
  command->footer(
      "\nFormats: KITTI object, raw and odometry, OpenCV stereo YAML or XML, ROS camera_info pair, Kalibr,\n"
      "EuRoC sensor.yaml pair, ORB-SLAM2 and 3, VINS-Fusion, ZED, RealSense, DepthAI, Basalt, MATLAB\n"
      "stereoParameters, Middlebury, FoundationStereo, the YAML that flies synth writes, others, and by hand:\n"
      "fx: 700, fy: 700, cx: 320, cy: 240, baseline: 0.12, width: 640, height: 480 (docs/formats.md).\n"
      "\nExamples:\n"
      "  flies calib calib_cam_to_cam.txt --cameras 0,1\n"
      "  flies calib left.yaml --right right.yaml --camera-height 0.98\n"
      "  flies calib camchain.yaml --write opencv --output stereo.yml\n"
      "\nExit status: 0 understood, 2 not.");
  command->callback([arguments] { run_calib(*arguments); });
}
