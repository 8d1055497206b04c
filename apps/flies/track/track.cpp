#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <exception>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "channels/recording.hpp"
#include "flies/core/error.hpp"
#include "flies/diagnose/calibrated_pair.hpp"
#include "flies/diagnose/pair_watch.hpp"
#include "flies/draw/track_view.hpp"
#include "flies/ego/shift_watch.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/pipeline/tracker.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/line_file.hpp"
#include "shared/listed_options.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/pair_arguments.hpp"
#include "shared/progress_bar.hpp"
#include "shared/read_ahead.hpp"
#include "shared/run_diagnosis.hpp"
#include "shared/sequence_source.hpp"
#include "shared/standard_output.hpp"
#include "track/timed_film.hpp"
#include "track/track_outputs.hpp"
#include "track/track_picture.hpp"

namespace {

struct TrackArguments {
  SequenceRequest sequence;
  CameraArguments camera;
  RunCorrections corrections;
  MethodArguments method;
  Overrides following;  ///< options of ego and track: dotted name and text
  ReadingArguments reading;
  std::string json, kitti, video;
};

/// Before the work; the files themselves are opened when the first pair is known to be good.
OutputClaims check_outputs(const TrackArguments& arguments) {
  OutputClaims claims;
  claims.reads(arguments.sequence.sources);
  claims.reads(arguments.sequence.times);
  claims.reads_method(arguments.method);
  claims.reads_calibration(arguments.sequence.calib, arguments.camera.right_calib);
  claims.writes_in_place(arguments.json, "--json");
  claims.writes_in_place(arguments.kitti, "--kitti");
  claims.writes(arguments.video, "--video");
  return claims;
}

/// Where a run writes to.
class TrackOutputFiles {
 public:
  explicit TrackOutputFiles(const TrackArguments& arguments) {
    if (!arguments.video.empty()) {
      film_.emplace(arguments.video);
      outlive_readers();
    }
    if (!arguments.json.empty()) json_.emplace(arguments.json);
    if (!arguments.kitti.empty()) kitti_.emplace(arguments.kitti);
    prints_ = (!film_ && !json_ && !kitti_) || arguments.json == "-" || arguments.kitti == "-";
  }

  /// Of a run that another output ended, the film shows what came until then.
  ~TrackOutputFiles() {
    if (!film_ || is_committed_) return;
    try {
      film_->finish();
    } catch (const std::exception&) {  // the fault that ended the run is told
    }
  }
  TrackOutputFiles(const TrackOutputFiles&) = delete;
  TrackOutputFiles& operator=(const TrackOutputFiles&) = delete;

  /// Whether results go where a progress bar would be drawn.
  bool use_the_terminal() const { return prints_; }

  void write(const TrackedFrame& frame, const flies::RectifiedPair& pair) {
    if (json_) json_->write(track_json_line(frame));
    if (kitti_) kitti_->write(kitti_tracking_lines(frame));
    if (film_) film_->add(track_picture(view_, pair.left, frame), frame.tracking.time_s);
    if (!json_ && !kitti_ && !film_) print(track_table(frame));
  }
  /// Of a pair that could not be used: its line says why.
  void write_error(const TrackedFrame& frame, const std::string& error) {
    if (json_) json_->write(track_json_line(frame, error));
  }
  void commit() {
    is_committed_ = true;
    if (film_) film_->finish();
  }

 private:
  std::optional<LineFile> json_, kitti_;
  std::optional<TimedFilm> film_;
  flies::TrackView view_;
  bool prints_ = false, is_committed_ = false;
};

/// Watches over a run for speeds that nothing has which carries a camera. Times that no camera has were told before.
class SpeedWatch {
 public:
  /// @param ego of the next pair of the run
  /// @returns what to say, once
  std::optional<std::string> look(const flies::EgoMotion& ego) {
    constexpr double kLeastStep_s = 0.99e-3;
    constexpr int kEnough = 3;
    const double speed_mps = std::hypot(ego.vx_mps, ego.vy_mps);
    if (!ego.is_known || ego.dt_s < kLeastStep_s || speed_mps < flies::kMostSpeed_mps) return std::nullopt;
    if (++fast_pairs_ != kEnough) return std::nullopt;
    return fmt::format(
        "the camera seems to move at {:.4g} m/s, faster than any vehicle: check the times, which may be too close "
        "together (--rate, --times), and the unit of the baseline",
        speed_mps);
  }

 private:
  int fast_pairs_ = 0;
};

flies::Calibration calibration_of(const TrackArguments& arguments, const SequenceSource& source,
                                  const flies::PairPaths& pair, const flies::RectifiedPair& images) {
  if (!source.recording) return calibration_of_files(source.calib, arguments.camera, pair, images);
  if (arguments.sequence.calib.empty()) return source.recording->calibration(arguments.camera, images);
  return flies::load_calibration(source.calib, calibration_request(arguments.camera, pair.left, pair.right, images));
}

void run_track(TrackArguments arguments) {
  OutputClaims claims = check_outputs(arguments);
  const flies::DetectorOptions unfitted = effective_options(arguments.method);
  const flies::TrackerOptions following = following_options(arguments.method, arguments.following);
  const auto classifier = classifier_of(arguments.method);
  if (!arguments.camera.cameras.empty())
    arguments.sequence.cameras = std::array{arguments.camera.cameras[0], arguments.camera.cameras[1]};
  arguments.sequence.reading = reading_of(arguments.reading);
  const SequenceSource source = open_sequence(arguments.sequence);
  claims.reads(source.pairs);
  claims.reads(source.files);

  // The detector keeps to its own arena; this holds OpenCV, which runs on oneTBB too, to the same number.
  std::optional<tbb::global_control> thread_limit;
  if (unfitted.threads > 0) {
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(unfitted.threads));
    cv::setNumThreads(unfitted.threads);
  }

  const CalibratedRun run = calibrate_run(
      source.pairs, [&](std::size_t i) { return source.load(i); },
      [&](const auto& pair, const auto& images) { return calibration_of(arguments, source, pair, images); },
      source.calib, corrections_for(arguments.corrections, arguments.method));
  const flies::StereoCamera& camera = run.calibration.camera;
  const auto options = effective_options(arguments.method, camera);
  flies::Tracker tracker(camera, options, following, classifier);
  const auto run_of = run_record({.method = arguments.method,
                                  .camera = arguments.camera,
                                  .corrections = arguments.corrections,
                                  .reading = source.reading},
                                 options, following, camera, source.calib, run.diagnosis);
  say_notes(source.notes);
  say_notes(run.notes(source.calib));
  say_run(*run_of);
  if (run.refusal) throw flies::InputError(*run.refusal);

  TrackOutputFiles outputs(arguments);
  ProgressBar progress(outputs.use_the_terminal() ? 0 : source.pairs.size());
  ReadAhead<flies::GrayPair> ahead(
      source.pairs.size(), [&](std::size_t i) { return run.usable(i); }, options.threads != 1);
  flies::PairWatch watch;
  flies::DisparityShiftWatch shift_watch;
  SpeedWatch speed_watch;
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < source.pairs.size(); ++i) {
    TrackedFrame frame{.frame = static_cast<int>(i),
                       .left = source.pairs[i].left,
                       .right = source.pairs[i].right,
                       .seed = unfitted.seed,
                       .preset = preset_name(unfitted),
                       .camera = camera,
                       .tracking = {},
                       .run = run_of,
                       .diagnosis = run.diagnosis.record()};
    flies::GrayPair images;
    std::string fault;
    try {
      images = ahead.next();
      say_notes(watch.look(images.view(), camera, frame.left, {nearest_range_m(options), arguments.method.preset}));
      if (watch.is_no_pair()) flies::check_calibrated_pair(images.view(), run.calibration, {}, frame.left, frame.right);
      frame.tracking = tracker.process(images.view(), source.times_s[i]);
      if (const auto note = speed_watch.look(frame.tracking.ego)) say_notes({*note});
      shift_watch.look(frame.tracking.ego);
      if (const auto note = shift_watch.first_note(camera); !note.empty()) say_notes({note});
    } catch (const flies::InputError& error) {  // costs this pair, not the others
      if (source.pairs.size() == 1) throw;
      fault = error.what();
    }
    if (fault.empty()) {
      outputs.write(frame, images.view());
    } else {
      faults.push_back(fault);
      frame.tracking.time_s = source.times_s[i];
      outputs.write_error(frame, fault);
    }
    progress.show(i + 1);
  }
  outputs.commit();
  say_notes(watch.counts());
  if (faults.size() == source.pairs.size())
    throw flies::InputError(arguments.sequence.sources.front(), "",
                            "no pair could be used; the first error: " + faults.front());
  if (!faults.empty())
    throw flies::InputError(arguments.sequence.sources.front(),
                            fmt::format("{} of {} pairs", faults.size(), source.pairs.size()),
                            "could not be used, the others were; the first error: " + faults.front());
}

}  // namespace

void setup_track(CLI::App& app) {
  CLI::App* command = app.add_subcommand("track", "follow things through a sequence: identity, velocity, ego-motion");
  const auto arguments = std::make_shared<TrackArguments>();
  command
      ->add_option("SOURCE", arguments->sequence.sources,
                   "a recording (.mcap, .bag), a KITTI raw drive, a sequence of flies synth, or the folders of left "
                   "and right images; with --split one folder")
      ->required()
      ->expected(1, 2);
  command
      ->add_option("--calib", arguments->sequence.calib,
                   "calibration file; default for a KITTI drive or a drawn sequence: the one that belongs to it")
      ->type_name("FILE");
  command->add_option("--rate", arguments->sequence.rate_hz, "pairs per second; used instead of the pairs' own times")
      ->check(in_range(0.01, 10000.0).description(""))
      ->type_name("HZ");
  command
      ->add_option("--times", arguments->sequence.times,
                   "times of the pairs, one per line: seconds, or date and time (KITTI raw, RFC 3339)")
      ->type_name("FILE");
  command
      ->add_option("--topics", arguments->sequence.topics,
                   "topics of the left and the right pictures in a recording; with --split the one that holds both")
      ->expected(1, 2)
      ->delimiter(',')
      ->type_name("LEFT,RIGHT");
  add_reading_options(*command, arguments->reading);
  command->get_option("--split")->description(
      "one file, or one picture of a recording, holds both images: side (side by side, left first) or top (one above "
      "the other, left on top); a recording then needs --calib");
  add_cameras_option(
      *command, arguments->camera,
      "left and right camera of a KITTI calibration, e.g. 2,3; default for a drive: 0,1 if it has them, or else 2,3");
  add_calibration_options(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  add_correction_options(*command, arguments->corrections);
  add_method_options(*command, arguments->method);
  add_listed_options<flies::TrackerOptions>(*command, "", "Following", arguments->following);
  command->add_option("--json", arguments->json, "one JSON object per line, one line per pair; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--kitti", arguments->kitti,
                   "KITTI's tracking format, one line per track and pair; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--video", arguments->video,
                   "MP4 film: the left image with boxes, beside it the view from above with trails")
      ->type_name("FILE")
      ->group("Output");
  command->footer(
      "\nVelocities are over ground, in the axes of the vehicle at that time (x forward, y left). Each\n"
      "line is written as soon as its pair is done, so that a pipe or `tail -f` sees it. Without outputs a\n"
      "table is printed. docs/dynamic.md says how it works and how well. A pair that cannot be used gets a\n"
      "line in --json with its error; the others are still processed, and the run ends with status 2.\n"
      "\nExamples:\n"
      "  flies track data/kitti_raw/2011_09_26/2011_09_26_drive_0005_sync\n"
      "  flies track left right --calib calib.yaml --rate 15 --json - | tee tracks.jsonl\n"
      "  flies track recording.mcap --topics /cam/left/image_rect,/cam/right/image_rect\n"
      "  flies track drive --video drive.mp4                 a folder of `flies synth --sequence`\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_track(*arguments); });
}
