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

OutputClaims other_inputs(const DetectArguments& arguments) {
  OutputClaims claims;
  claims.reads_calibration(arguments.calib, arguments.camera.right_calib);
  claims.reads_method(arguments.method);
  return claims;
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

/// Where a run writes lines to.
struct LineOutputs {
  explicit LineOutputs(const DetectOutputs& outputs) {
    constexpr auto kLines = flies::OutputFile::Kind::lines;
    if (!outputs.json.empty()) json.emplace(outputs.json, kLines);
    if (!outputs.csv.empty()) csv.emplace(outputs.csv, kLines).write(flies::csv_header());
    if (!outputs.scan.empty()) scan.emplace(outputs.scan, kLines).write(flies::scan_csv_header());
  }
  void write(const flies::FrameRecord& record) {
    if (json) json->write(flies::json_line(record));
    if (csv) csv->write(flies::csv_rows(record));
    if (scan && record.error.empty()) scan->write(flies::scan_csv_rows(record));
  }
  void commit() {
    for (auto* file : {&json, &csv, &scan})
      if (*file) (*file)->commit();
  }

  std::optional<flies::OutputFile> json, csv, scan;
};

void fill_in(flies::FrameRecord& record, const flies::Detection& detection) {
  record.obstacles = detection.obstacles;
  record.pedestrians = detection.pedestrians;
  record.scan = detection.scan;
  record.road = detection.road.plane;
  record.road_found = detection.road.found;
  record.stage_ms = detection.stage_ms;
}

CalibratedRun calibrated(const DetectArguments& arguments, const std::vector<flies::PairPaths>& pairs) {
  const LoadPair load = [pairs, reading = reading_of(arguments.images.reading)](std::size_t i) {
    return flies::load_pair(pairs[i], reading);
  };
  const Calibrate calibrate = [&](const flies::PairPaths& pair, const flies::RectifiedPair& images) {
    return calibration_of_files(arguments.calib, arguments.camera, pair, images);
  };
  return calibrate_run(pairs, load, calibrate, arguments.calib,
                       corrections_for(arguments.corrections, arguments.method));
}

/// A record of nothing found.
flies::FrameRecord empty_record(const DetectArguments& arguments, const CalibratedRun& run,
                                const flies::DetectorOptions& options) {
  const RunWords words = {.method = arguments.method,
                          .camera = arguments.camera,
                          .corrections = arguments.corrections,
                          .reading = reading_of(arguments.images.reading),
                          .pair_by = arguments.images.pair_by};
  flies::FrameRecord record;
  record.seed = options.seed;
  record.preset = preset_name(effective_options(arguments.method));
  record.diagnosis = run.diagnosis.record();
  record.run = run_record(words, options, {}, run.calibration.camera, arguments.calib, run.diagnosis);
  return record;
}

/// What may explain why the pair of a run of one cannot be used.
void say_notes_on_calibration(const DetectArguments& arguments, const CalibratedRun& run) {
  using enum flies::CalibrationNoteKind;
  say_notes(named(arguments.calib, texts(run.calibration.notes, {told})));
  say_notes(named(arguments.calib, texts(run.calibration.notes, {doubt})));
}

void run_detect(const DetectArguments& arguments) {
  const auto threads = static_cast<std::size_t>(effective_options(arguments.method).threads);
  const auto classifier = classifier_of(arguments.method);
  const auto pairs = pairs_of(arguments.images);
  const bool is_single = pairs.size() == 1;
  const DetectOutputs& outputs = arguments.outputs;
  check_outputs(outputs, pairs, other_inputs(arguments));

  // The detector keeps to its own arena; this holds OpenCV, which runs on oneTBB too, to the same number.
  std::optional<tbb::global_control> thread_limit;
  if (threads > 0) thread_limit.emplace(tbb::global_control::max_allowed_parallelism, threads);

  const CalibratedRun run = calibrated(arguments, pairs);
  const flies::StereoCamera& camera = run.calibration.camera;
  const flies::DetectorOptions options = effective_options(arguments.method, camera);
  flies::Detector detector(camera, options, classifier);
  const flies::FrameRecord nothing_found = empty_record(arguments, run, options);
  if (!is_single) say_notes(run.notes(arguments.calib));  // of a single pair when it could be used
  say_run(*nothing_found.run);

  LineOutputs lines(outputs);
  // The table goes to the terminal that the bar would be drawn on.
  const bool prints = !outputs.any() || outputs.json == "-" || outputs.csv == "-" || outputs.scan == "-";
  ProgressBar progress(prints ? 0 : pairs.size());
  const auto make_pair = [&](std::size_t i) {
    auto images = run.usable(i);
    run.require_true_pair(i, images);
    return images;
  };
  ReadAhead<flies::GrayPair> ahead(pairs.size(), make_pair, options.threads != 1);
  std::vector<std::string> faults;
  flies::PairWatch watch;
  const flies::NearEnd near_end{nearest_range_m(options), arguments.method.preset};
  std::optional<std::string> near;  // of a single pair
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    flies::FrameRecord record = nothing_found;
    record.frame = static_cast<int>(i);
    record.left = pairs[i].left;
    record.right = pairs[i].right;
    flies::GrayPair images;
    std::optional<flies::Detection> detection;
    try {
      images = ahead.next();
      if (is_single)
        near = flies::note_on_near_things(images.view(), camera, near_end);
      else
        watch.look(images.view(), camera, record.left, near_end);  // told at the end
      detection = detector.process(images.view());
      fill_in(record, *detection);
    } catch (const flies::InputError& fault) {  // costs this pair, not the others
      if (is_single) say_notes_on_calibration(arguments, run);
      if (is_single) throw;
      faults.emplace_back(fault.what());
      record.error = fault.what();
    }
    lines.write(record);
    if (detection && !outputs.any()) print(result_table(record));
    if (detection)
      write_frame({images.view(), camera, options, &*detection, static_cast<std::uint32_t>(i)}, file_stem(record.left),
                  outputs, is_single);
    progress.show(i + 1);
  }
  lines.commit();
  if (faults.size() == pairs.size())
    throw flies::InputError(arguments.images.left, "", "no pair could be used; the first error: " + faults.front());
  say_notes(is_single ? run.notes(arguments.calib) : watch.counts());
  if (near) say_notes({pairs.front().left + ": " + *near});
  if (!faults.empty())
    throw flies::InputError(arguments.images.left, fmt::format("{} of {} pairs", faults.size(), pairs.size()),
                            "could not be used, the others were; the first error: " + faults.front());
}

void add_input_options(CLI::App& command, DetectArguments& arguments) {
  add_pair_options(command, arguments.images);
  command.add_option("--calib", arguments.calib, "calibration of the pair; see `flies calib --help`")
      ->type_name("FILE")
      ->required();
  add_cameras_option(
      command, arguments.camera,
      "left and right camera of a KITTI calibration, e.g. 0,1; default: those in the image paths, or else 2,3");
  add_calibration_options(command, arguments.camera);
  add_mount_options(command, arguments.camera);
  add_correction_options(command, arguments.corrections);
}

void add_output_options(CLI::App& command, DetectOutputs& outputs) {
  const auto add = [&](const char* name, std::string& path, const char* meaning, const char* type) {
    command.add_option(name, path, meaning)->type_name(type)->group("Output");
  };
  add("--json", outputs.json, "one JSON object per line, one line per pair; - is standard output", "FILE");
  add("--csv", outputs.csv, "one line per obstacle or pedestrian; - is standard output", "FILE");
  add("--scan", outputs.scan, "one line per sector of the scan; - is standard output", "FILE");
  add("--ply", outputs.ply, "flies as a point cloud, coloured by fitness", "FILE");
  add("--overlay", outputs.overlay, "boxes and ranges on the left image, free road in green", "PNG");
  add("--top-view", outputs.top_view, "bird's-eye view of obstacles and free ground, in metres", "PNG");
  add("--flies", outputs.flies, "random flies coloured by fitness, Eq. (1) and Eq. (2)", "PNG");
  add("--histogram", outputs.histogram,
      "fitness over x in the view-angle of the nearest pedestrian, or else of the nearest obstacle", "PNG");
  add("--concentrating", outputs.concentrating,
      "steps of concentrating: sample points, objects kept, boxes to classify", "PNG");
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
      "range, default and meaning. --options FILE overrides the preset, and the command line overrides both.\n"
      "Without output options a table is printed. For folders, files that are written per pair get the name of\n"
      "the left image: --overlay found.png writes found_0000000012.png. Files appear when they are complete;\n"
      "an interrupted run keeps the finished lines of --json, --csv and --scan. In folders, a pair that\n"
      "cannot be used gets a line in --json with its error; the others are still processed, and the run ends\n"
      "with status 2.\n"
      "\nExamples:\n"
      "  flies detect left.png right.png --calib calib.txt\n"
      "  flies detect image_00/data image_01/data --calib calib_cam_to_cam.txt --json found.jsonl\n"
      "  flies detect left.png right.png --calib calib.txt --overlay found.png --top-view above.png\n"
      "  flies detect both.png --split side --calib calib.txt\n"
      "\nExit status: 0 done, also when nothing was found; 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_detect(*arguments); });
}
