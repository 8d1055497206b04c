#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluate/evaluation_report.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/eval/evaluation.hpp"
#include "flies/eval/sequence.hpp"
#include "flies/eval/unlabelled.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/output_file.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/listed_options.hpp"
#include "shared/method_arguments.hpp"
#include "shared/named_output.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/progress_bar.hpp"
#include "shared/run_diagnosis.hpp"
#include "shared/standard_output.hpp"

namespace {

struct EvaluateArguments {
  std::string folder;
  std::string calib;
  CameraArguments camera;
  RunCorrections corrections;
  int start = 0, step = 1;
  std::optional<int> end;
  std::vector<std::string> detections;
  std::vector<std::string> yardsticks;
  int seeds = 5;
  MethodArguments method;
  Overrides match, people, estimate, sectors, dense, hog, network, tracker;  ///< dotted name and text
  std::string unlabelled, json, plot, scan_plot;
  bool missed = false;
  std::optional<bool> sequence;  ///< nothing: where it can be followed
};

flies::DatasetRequest dataset_request(const EvaluateArguments& arguments) {
  flies::DatasetRequest request;
  request.calib = arguments.calib;
  fill_in(request, arguments.camera);
  request.find_mount = arguments.corrections.find_mount;
  return request;
}

std::vector<std::size_t> frames_of(const EvaluateArguments& arguments, std::size_t count) {
  std::vector<std::size_t> frames;
  const std::size_t end = arguments.end ? std::min(static_cast<std::size_t>(*arguments.end), count) : count;
  for (auto i = static_cast<std::size_t>(arguments.start); i < end; i += static_cast<std::size_t>(arguments.step))
    frames.push_back(i);
  if (frames.empty() && static_cast<std::size_t>(arguments.start) < count)
    throw flies::InputError(
        "command line", "--end",
        fmt::format("found {}, expected more than --start, which is {}", *arguments.end, arguments.start));
  if (frames.empty())
    throw flies::InputError("command line", "--start",
                            fmt::format("found {}, but {} has {} pairs", arguments.start, arguments.folder, count));
  return frames;
}

flies::EvaluationOptions measuring_of(const EvaluateArguments& arguments) {
  return {with_overrides<flies::MatchOptions>(arguments.match), with_overrides<flies::PeopleOptions>(arguments.people),
          with_overrides<flies::EstimateOptions>(arguments.estimate),
          with_overrides<flies::SectorOptions>(arguments.sectors)};
}

constexpr std::string_view kNetwork = "network:";  // before the file of a yardstick

/// What is held against the method: a dense matcher, a search of the whole image for people, or another preset.
flies::Method yardstick(const std::string& name, const flies::DetectorOptions& options,
                        const EvaluateArguments& arguments, bool is_sequence) {
  constexpr const auto& kMatchers = flies::EnumNames<flies::DenseMatcher>::names;
  constexpr const auto& kSearches = flies::EnumNames<flies::HogDetector>::names;
  constexpr const auto& kPresets = flies::EnumNames<flies::Preset>::names;
  if (const auto matcher = std::find(kMatchers.begin(), kMatchers.end(), name); matcher != kMatchers.end())
    return flies::dense_method(static_cast<flies::DenseMatcher>(matcher - kMatchers.begin()), options,
                               with_overrides<flies::DenseOptions>(arguments.dense), measuring_of(arguments));
  if (const auto search = std::find(kSearches.begin(), kSearches.end(), name); search != kSearches.end()) {
    const auto detector = static_cast<flies::HogDetector>(search - kSearches.begin());
    return flies::hog_method(detector, with_overrides<flies::HogOptions>(arguments.hog));
  }
  if (name.starts_with(kNetwork))
    return flies::network_method(name.substr(kNetwork.size()),
                                 with_overrides<flies::NetworkSearchOptions>(arguments.network));
  const auto preset = std::find(kPresets.begin(), kPresets.end(), name);
  if (preset == kPresets.end())
    throw flies::InputError("command line", "--yardstick",
                            fmt::format("found '{}', expected sgbm, sgbm-3way, hog-48x96, hog-64x128, network:FILE, or "
                                        "a preset: default, paper, robot, handheld",
                                        name));
  flies::DetectorOptions of_preset = flies::preset_options(static_cast<flies::Preset>(preset - kPresets.begin()));
  of_preset.seed = options.seed;
  of_preset.threads = options.threads;
  MethodArguments by_name;
  by_name.preset = name;
  by_name.model = arguments.method.model;
  return flies::flies_method(name, of_preset, arguments.seeds, classifier_of(by_name), is_sequence,
                             measuring_of(arguments));
}

std::vector<flies::Method> methods_of(const EvaluateArguments& arguments, const flies::DetectorOptions& options,
                                      flies::Dataset& dataset) {
  const auto classifier = classifier_of(arguments.method);
  std::vector<flies::Method> methods;
  if (arguments.detections.empty()) {
    methods.push_back(flies::flies_method(arguments.method.preset, options, arguments.seeds, classifier,
                                          dataset.is_sequence, measuring_of(arguments)));
  } else {
    std::vector<std::vector<flies::ReportedFrame>> runs;
    for (const auto& file : arguments.detections) {
      runs.push_back(flies::match_detections(flies::read_detections(file), dataset.pairs, file));
      if (auto note = flies::note_on_unusable(runs.back(), file)) dataset.notes.push_back(std::move(*note));
      std::ranges::move(flies::notes_on_positions(runs.back(), file), std::back_inserter(dataset.notes));
    }
    methods.push_back(flies::reported_method("reported", std::move(runs)));
  }
  for (const auto& name : arguments.yardsticks)
    methods.push_back(yardstick(name, options, arguments, dataset.is_sequence));
  return methods;
}

/// Whether the pairs are to be followed as one sequence as well.
bool wants_sequence(const EvaluateArguments& arguments, const flies::Dataset& dataset) {
  const bool can_follow = flies::is_followable(dataset) && arguments.step == 1;
  if (!arguments.sequence.value_or(can_follow && arguments.detections.empty())) return false;
  if (arguments.step != 1)
    throw flies::InputError("command line", "--sequence",
                            fmt::format("needs every pair, expected --step 1, found {}", arguments.step));
  if (!flies::is_followable(dataset))
    throw flies::InputError(arguments.folder, "--sequence",
                            "times and motion of the pairs are not known, expected a KITTI drive with oxts from its "
                            "first pair on, or a sequence of flies synth --sequence");
  return true;
}

flies::SequenceResult follow(const EvaluateArguments& arguments, const flies::Dataset& dataset,
                             const std::vector<std::size_t>& frames, const EvaluationContext& context) {
  ProgressBar progress(frames.size(), "pairs followed");
  return flies::evaluate_sequence(dataset, frames.front(), frames.back() + 1, context.options, context.tracker,
                                  classifier_of(arguments.method), context.measuring,
                                  [&](std::size_t done) { progress.show(done); });
}

/// Whether all pairs are of one rig, whose rows can be made up for alike.
bool has_one_camera(const flies::Dataset& dataset, const std::string& folder) {
  if (dataset.kind == flies::TruthKind::scenes)
    return !std::filesystem::is_directory(std::filesystem::path(folder) / "calib");
  return dataset.kind == flies::TruthKind::kitti_drive || dataset.kind == flies::TruthKind::foot_points;
}

/// Makes up for rows as `flies detect` does, and adds what the images say to the notes.
void look_at_images(const EvaluateArguments& arguments, const std::vector<std::size_t>& frames,
                    flies::Dataset& dataset) {
  RunCorrections corrections = corrections_for(arguments.corrections, arguments.method);
  corrections.find_mount = false;  // found already, if it was to be
  if (!has_one_camera(dataset, arguments.folder)) corrections.self_rectify = SelfRectify::off;
  flies::Calibration calibration;
  calibration.camera = dataset.load(frames.front()).camera;
  const auto load = [&](std::size_t i) {
    const auto& [left, right] = dataset.pairs[frames[i]];
    return flies::load_pair(left, right);
  };
  const RunDiagnosis run = diagnose(frames.size(), load, calibration, corrections);
  for (const auto& note : run.notes) dataset.notes.push_back(dataset.pairs[frames.front()].left + ": " + note);
  if (!run.correction) return;
  dataset.load = [run, load_as_it_is = std::move(dataset.load)](std::size_t i) {
    flies::TruthFrame frame = load_as_it_is(i);
    run.correct(frame.images);
    return frame;
  };
}

OutputClaims check_outputs(const EvaluateArguments& arguments) {
  OutputClaims claims;
  claims.reads(arguments.detections);
  claims.reads(arguments.unlabelled);
  claims.reads_calibration(arguments.calib, "");
  claims.reads_method(arguments.method);
  for (const auto& name : arguments.yardsticks)
    if (name.starts_with(kNetwork)) claims.reads_model(name.substr(kNetwork.size()));
  claims.writes(arguments.json, "--json");
  require_named_output(arguments.plot, "--plot", ".png");
  require_named_output(arguments.scan_plot, "--scan-plot", ".png");
  claims.writes(arguments.plot, "--plot");
  claims.writes(arguments.scan_plot, "--scan-plot");
  return claims;
}

void run_evaluate(const EvaluateArguments& arguments) {
  OutputClaims claims = check_outputs(arguments);
  EvaluationContext context;
  context.folder = arguments.folder;
  context.preset = arguments.method.preset;
  context.options = effective_options(arguments.method);
  context.measuring = measuring_of(arguments);
  context.dense = with_overrides<flies::DenseOptions>(arguments.dense);
  context.tracker = following_options(arguments.method, arguments.tracker);
  context.hog = with_overrides<flies::HogOptions>(arguments.hog);

  flies::Dataset dataset = flies::open_dataset(arguments.folder, dataset_request(arguments));
  claims.reads(dataset.pairs);
  claims.reads(dataset.files);
  if (!arguments.unlabelled.empty())
    dataset =
        flies::with_unlabelled(std::move(dataset), flies::read_unlabelled(arguments.unlabelled), arguments.unlabelled);
  context.kind = dataset.kind;
  context.options = effective_options(arguments.method, dataset.load(0).camera);
  const auto frames = frames_of(arguments, dataset.pairs.size());
  const bool follows = wants_sequence(arguments, dataset);
  look_at_images(arguments, frames, dataset);
  const auto methods = methods_of(arguments, context.options, dataset);
  context.notes = dataset.notes;
  std::optional<flies::OutputFile> json;
  if (!arguments.json.empty()) json.emplace(arguments.json);

  // Threads of the flies, and as many for OpenCV's matching.
  std::optional<tbb::global_control> thread_limit;
  if (context.options.threads > 0) {
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism,
                         static_cast<std::size_t>(context.options.threads));
    cv::setNumThreads(context.options.threads);
  }
  say_notes(dataset.notes);
  std::optional<ProgressBar> progress(std::in_place, frames.size());
  const auto evaluation =
      flies::evaluate(dataset, frames, methods, context.measuring, [&](std::size_t done) { progress->show(done); });
  progress.reset();
  std::optional<flies::SequenceResult> sequence;
  if (follows) sequence = follow(arguments, dataset, frames, context);

  if (!arguments.plot.empty()) flies::write_png(arguments.plot, people_curves(evaluation));
  if (!arguments.scan_plot.empty()) flies::write_png(arguments.scan_plot, scan_curves(evaluation));
  if (json) {
    json->write(evaluation_json(evaluation, context, sequence));
    json->commit();
  }
  if (arguments.json == "-") return;
  print(evaluation_table(evaluation, context));
  if (sequence) print(sequence_table(*sequence, context));
  if (arguments.missed) print(missed_table(evaluation));
}

void add_truth_options(CLI::App& command, EvaluateArguments& arguments) {
  command
      .add_option("TRUTH", arguments.folder,
                  "folder with truth: a KITTI drive, object or stereo folder, a result of flies synth, or foot points "
                  "of people")
      ->required();
  add_cameras_option(command, arguments.camera,
                     "left and right camera of a KITTI drive, e.g. 2,3; default: 0,1 if it has them, or else 2,3");
  command.add_option("--calib", arguments.calib, "calibration file, where the folder holds none")->type_name("FILE");
  add_baseline_option(command, arguments.camera);
  add_disparity_shift_option(command, arguments.camera);
  add_mount_options(command, arguments.camera);
  add_correction_options(command, arguments.corrections);
  command
      .add_option("--unlabelled", arguments.unlabelled,
                  "people who are real but not labelled, and are ignored: one per line, name,left,top,width,height")
      ->type_name("FILE");
  constexpr int kMostPairs = 1'000'000'000;
  command.add_option("--start", arguments.start, "first pair, counted from 0")
      ->check(in_range(0, kMostPairs).description(""))
      ->type_name("N");
  command.add_option("--end", arguments.end, "pair to stop before, counted from 0; default: all pairs")
      ->check(in_range(1, kMostPairs).description(""))
      ->type_name("N");
  command.add_option("--step", arguments.step, "use only every Nth pair")
      ->check(in_range(1, kMostPairs).description(""))
      ->type_name("N");
}

}  // namespace

void setup_evaluate(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate", "measure obstacles and people against known truth");
  const auto arguments = std::make_shared<EvaluateArguments>();
  add_truth_options(*command, *arguments);
  command
      ->add_option("--detections", arguments->detections,
                   "evaluate results that any program wrote as JSON Lines, instead of detecting now; give it again for "
                   "another run")
      ->allow_extra_args(false)
      ->type_name("FILE");
  add_method_options(*command, arguments->method);
  command->add_option("--seeds", arguments->seeds, "number of runs, with seeds from --seed upwards; default 5")
      ->check(in_range(1, 10000))
      ->type_name("N")
      ->group("Method");
  command
      ->add_option("--yardstick", arguments->yardsticks,
                   "compare with these in the same run: sgbm, sgbm-3way (OpenCV's dense matching), hog-48x96, "
                   "hog-64x128 (OpenCV's search of the whole image for people), network:NAME.weights (a Darknet "
                   "network, with NAME.cfg beside it, on the whole image), or a preset")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->group("Method");
  add_listed_options<flies::DenseOptions>(*command, "dense.", "Measuring", arguments->dense);
  add_listed_options<flies::HogOptions>(*command, "hog.", "Measuring", arguments->hog);
  add_listed_options<flies::NetworkSearchOptions>(*command, "network.", "Measuring", arguments->network);
  add_listed_options<flies::MatchOptions>(*command, "match.", "Measuring", arguments->match);
  add_listed_options<flies::SectorOptions>(*command, "sectors.", "Measuring", arguments->sectors);
  add_listed_options<flies::PeopleOptions>(*command, "people.", "Measuring", arguments->people);
  add_listed_options<flies::EstimateOptions>(*command, "estimate.", "Measuring", arguments->estimate);
  add_listed_options<flies::TrackerOptions>(*command, "", "Measuring", arguments->tracker);
  auto* const follow = command->add_flag_callback(
      "--sequence", [arguments] { arguments->sequence = true; },
      "follow the pairs as one sequence and measure its tracks, too; default where times and motion are known");
  command
      ->add_flag_callback(
          "--no-sequence", [arguments] { arguments->sequence = false; }, "measure the pairs one by one only")
      ->excludes(follow)
      ->group("Method");
  follow->group("Method");
  command->add_flag("--missed", arguments->missed, "list, pair by pair, what was missed, and false alarms on people")
      ->group("Output");
  command->add_option("--plot", arguments->plot, "PNG of the miss rate of people over false alarms per pair")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--scan-plot", arguments->scan_plot, "PNG of blind over ghost sectors of the scan")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--json", arguments->json, "all numbers as JSON; - is standard output, without the table")
      ->type_name("FILE")
      ->group("Output");
  command->footer(
      "\nThe kind of truth is recognised from the folder's content; docs/evaluation.md describes each\n"
      "kind, the measures and the JSON. Times are measured with one pair after another. --start 0 --step 2\n"
      "takes the even pairs, --start 1 --step 2 the odd ones, --end 30 the first thirty.\n"
      "\nExamples:\n"
      "  flies evaluate data/kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --yardstick sgbm,sgbm-3way\n"
      "  flies evaluate data/kitti_object/training --preset paper --missed\n"
      "  flies synth street --frames 20 && flies evaluate street --json measures.json\n"
      "  flies evaluate street --detections found.jsonl\n"
      "  flies evaluate data/kitti_stereo2012 --start 1 --step 2 --yardstick sgbm-3way\n"
      "  flies evaluate data/eth_bahnhof/rectified --camera-height 0.98 --yardstick hog-48x96 --missed\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_evaluate(*arguments); });
}
