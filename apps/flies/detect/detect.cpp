#include <fmt/format.h>
#include <tbb/global_control.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "detect/detect_outputs.hpp"
#include "detect/detect_pictures.hpp"
#include "flies/core/error.hpp"
#include "flies/core/pair_check.hpp"
#include "flies/diagnose/pair_watch.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/pair_source.hpp"
#include "flies/io/writers.hpp"
#include "flies/pipeline/detector.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/commands.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"
#include "shared/pair_arguments.hpp"
#include "shared/progress_bar.hpp"
#include "shared/read_ahead.hpp"
#include "shared/result_table.hpp"
#include "shared/run_diagnosis.hpp"
#include "shared/standard_output.hpp"

namespace {

struct DetectArguments {
  PairArguments images;
  std::string calib;
  CameraArguments camera;
  RunCorrections corrections;
  MethodArguments method;
  DetectOutputs outputs;
};

std::vector<std::string> other_inputs(const DetectArguments& arguments) {
  std::vector<std::string> inputs = {arguments.calib};
  for (const auto& path : {arguments.camera.right_calib, arguments.method.options_file, arguments.method.model})
    if (!path.empty()) inputs.push_back(path);
  return inputs;
}

std::vector<std::string> calibration_notes(const flies::Calibration& calibration, const std::string& path) {
  std::vector<std::string> notes;
  for (const auto& note : calibration.notes) notes.push_back(path + ": " + note);
  return notes;
}

/// The files of one pair, each whole or not at all.
void write_frame(const ProcessedFrame& frame, const std::string& name, const DetectOutputs& outputs, bool is_single) {
  const auto write_picture = [&](const std::string& path, const auto& draw) {
    if (!path.empty()) flies::write_png(path_of_frame(path, name, is_single), draw(frame));
  };
  write_picture(outputs.overlay, overlay_picture);
  write_picture(outputs.top_view, top_view_picture);
  write_picture(outputs.flies, fitness_picture);
  write_picture(outputs.histogram, histogram_picture);
  write_picture(outputs.concentrating, concentrating_picture);
  if (!outputs.ply.empty())
    flies::write_file(path_of_frame(outputs.ply, name, is_single), flies::ply_text(frame.detection->evolved.flies));
}

/// A pair as the detector wants it. @throws flies::InputError when it cannot be
flies::GrayPair usable_pair(const flies::PairPaths& paths, const flies::PairReading& reading,
                            const flies::Calibration& calibration, const RunDiagnosis& run) {
  flies::GrayPair images = flies::load_pair(paths, reading);
  if (calibration.rectifier) images = calibration.rectifier->rectify(images);
  const flies::RectifiedPair pair = images.view();
  flies::check_camera_fits(calibration.camera, pair.left.width_px, pair.left.height_px, paths.left);
  run.correct(images);
  flies::check_true_pair(images.view(), calibration.camera, paths.left, paths.right);
  return images;
}

void run_detect(const DetectArguments& arguments) {
  const flies::DetectorOptions unfitted = effective_options(arguments.method);
  const auto classifier = classifier_of(arguments.method);
  const flies::PairReading reading = reading_of(arguments.images.reading);
  const auto pairs = pairs_of(arguments.images);
  const bool is_single = pairs.size() == 1;
  check_outputs(arguments.outputs, pairs, other_inputs(arguments));

  // The detector keeps to its own arena; this holds OpenCV, which runs on oneTBB too, to the same number.
  std::optional<tbb::global_control> thread_limit;
  if (unfitted.threads > 0)
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(unfitted.threads));

  auto [first, images] =
      first_readable(pairs.size(), [&](std::size_t i) { return flies::load_pair(pairs[i], reading); });
  if (const auto note = orientation_note(pairs[first])) say_notes({*note});
  const auto request = calibration_request(arguments.camera, pairs[first].left, pairs[first].right, images.view());
  flies::Calibration calibration = flies::load_calibration(arguments.calib, request);
  if (calibration.rectifier) images = calibration.rectifier->rectify(images);
  flies::check_camera_fits(calibration.camera, images.view().left.width_px, images.view().left.height_px,
                           arguments.calib);
  calibration.camera.width_px = images.view().left.width_px;
  calibration.camera.height_px = images.view().left.height_px;
  const RunDiagnosis run = diagnose(pairs, reading, calibration, arguments.corrections);
  const flies::DetectorOptions options = effective_options(arguments.method, calibration.camera);
  flies::Detector detector(calibration.camera, options, classifier);
  const auto run_of = run_record(arguments.method, options, calibration.camera, arguments.calib);
  auto notes = calibration_notes(calibration, arguments.calib);
  for (const auto& note : run.notes) notes.push_back(pairs[first].left + ": " + note);
  // Before a long run; a single pair that cannot be used has one line to say.
  if (!is_single) say_notes(notes);
  say_run(*run_of);
  constexpr auto kLines = flies::OutputFile::Kind::lines;
  std::optional<flies::OutputFile> json, csv, scan;
  if (!arguments.outputs.json.empty()) json.emplace(arguments.outputs.json, kLines);
  if (!arguments.outputs.csv.empty()) csv.emplace(arguments.outputs.csv, kLines).write(flies::csv_header());
  if (!arguments.outputs.scan.empty()) scan.emplace(arguments.outputs.scan, kLines).write(flies::scan_csv_header());

  // The table goes to the terminal that the bar would be drawn on.
  const DetectOutputs& outputs = arguments.outputs;
  const bool prints = !outputs.any() || outputs.json == "-" || outputs.csv == "-" || outputs.scan == "-";
  ProgressBar progress(prints ? 0 : pairs.size());
  ReadAhead<flies::GrayPair> ahead(
      pairs.size(), [&](std::size_t i) { return usable_pair(pairs[i], reading, calibration, run); },
      options.threads != 1);
  std::vector<std::string> faults;
  flies::PairWatch watch;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [left_path, right_path] = pairs[i];
    flies::FrameRecord record{.frame = static_cast<int>(i),
                              .left = left_path,
                              .right = right_path,
                              .seed = options.seed,
                              .preset = preset_name(unfitted),
                              .obstacles = {},
                              .pedestrians = {},
                              .scan = {},
                              .diagnosis = run.record(),
                              .run = run_of,
                              .error = {}};
    std::optional<flies::Detection> detection;
    try {
      images = ahead.next();
      if (!is_single) watch.look(images.view(), calibration.camera, left_path);  // told at the end
      detection = detector.process(images.view());
      record.obstacles = detection->obstacles;
      record.pedestrians = detection->pedestrians;
      record.scan = detection->scan;
      record.road = detection->road.plane;
      record.road_found = detection->road.found;
      record.stage_ms = detection->stage_ms;
    } catch (const flies::InputError& fault) {  // costs this pair, not the others
      if (is_single) throw;
      faults.emplace_back(fault.what());
      record.error = fault.what();
    }
    if (json) json->write(flies::json_line(record));
    if (csv) csv->write(flies::csv_rows(record));
    if (scan && detection) scan->write(flies::scan_csv_rows(record));
    if (detection && !arguments.outputs.any()) print(result_table(record));
    if (detection)
      write_frame({images.view(), calibration.camera, options, &*detection, static_cast<std::uint32_t>(i)},
                  file_stem(left_path), arguments.outputs, is_single);
    progress.show(i + 1);
  }
  if (json) json->commit();
  if (csv) csv->commit();
  if (scan) scan->commit();
  if (faults.size() == pairs.size())
    throw flies::InputError(arguments.images.left, "", "no pair could be used; the first: " + faults.front());
  say_notes(is_single ? notes : watch.counts());
  if (!faults.empty())
    throw flies::InputError(arguments.images.left, fmt::format("{} of {} pairs", faults.size(), pairs.size()),
                            "could not be used, the others were; the first: " + faults.front());
}

void add_input_options(CLI::App& command, DetectArguments& arguments) {
  add_pair_options(command, arguments.images);
  command.add_option("--calib", arguments.calib, "calibration of the pair; see `flies calib --help`")
      ->type_name("FILE")
      ->required();
  add_cameras_option(command, arguments.camera, "KITTI cameras, e.g. 0,1; else by image path, else 2,3");
  add_calibration_options(command, arguments.camera);
  add_mount_options(command, arguments.camera);
  add_correction_options(command, arguments.corrections);
}

void add_output_options(CLI::App& command, DetectOutputs& outputs) {
  const auto add = [&](const char* name, std::string& path, const char* meaning, const char* type) {
    command.add_option(name, path, meaning)->type_name(type)->group("Output");
  };
  add("--json", outputs.json, "one JSON object a line, a line a pair; - is standard output", "FILE");
  add("--csv", outputs.csv, "one line an obstacle or pedestrian; - is standard output", "FILE");
  add("--scan", outputs.scan, "one line a sector of the scan; - is standard output", "FILE");
  add("--ply", outputs.ply, "flies as a point cloud, coloured by fitness", "FILE");
  add("--overlay", outputs.overlay, "boxes and ranges on the left image, free road in green", "PNG");
  add("--top-view", outputs.top_view, "bird's-eye view of obstacles and free ground, in metres", "PNG");
  add("--flies", outputs.flies, "random flies coloured by fitness, Eq. (1) and Eq. (2)", "PNG");
  add("--histogram", outputs.histogram, "view-angle of the nearest pedestrian, else obstacle: fitness over x", "PNG");
  add("--concentrating", outputs.concentrating, "sample points, objects kept, boxes to classify", "PNG");
}

}  // namespace

void setup_detect(CLI::App& app) {
  CLI::App* command = app.add_subcommand("detect", "find obstacles and pedestrians in pairs of images");
  const auto arguments = std::make_shared<DetectArguments>();
  add_input_options(*command, *arguments);
  add_method_options(*command, arguments->method);
  add_output_options(*command, arguments->outputs);
  command->footer(
      "\nImages are PNG, JPEG, PGM, PPM, TIFF, WebP or BMP, grey or colour. Every option of the method can be\n"
      "given by its dotted name, e.g. --evolve.flies 3000; `flies config --list` prints them all with their\n"
      "range, default and meaning. The preset is overruled by --options FILE, and that by the command line.\n"
      "Without output options a table is printed. On folders, files written per pair carry the name of the\n"
      "left image: --overlay found.png writes found_0000000012.png. Files appear when they are complete;\n"
      "an interrupted run keeps the finished lines of --json, --csv and --scan. In folders, a pair that\n"
      "cannot be used gets a line in --json with its error, and the run ends with status 2 after the others.\n"
      "\nExamples:\n"
      "  flies detect left.png right.png --calib calib.txt\n"
      "  flies detect image_00/data image_01/data --calib calib_cam_to_cam.txt --json found.jsonl\n"
      "  flies detect left.png right.png --calib calib.txt --overlay found.png --top-view above.png\n"
      "  flies detect both.png --split side --calib calib.txt\n"
      "\nExit status: 0 done, also when nothing was found; 2 a fault in the input, told in one line.");
  command->callback([arguments] { run_detect(*arguments); });
}
