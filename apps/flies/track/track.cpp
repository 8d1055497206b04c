#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "channels/recording.hpp"
#include "flies/core/error.hpp"
#include "flies/core/pair_check.hpp"
#include "flies/diagnose/pair_watch.hpp"
#include "flies/draw/track_view.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/pipeline/tracker.hpp"
#include "flies/video/film.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/commands.hpp"
#include "shared/latencies.hpp"
#include "shared/line_file.hpp"
#include "shared/listed_options.hpp"
#include "shared/method_arguments.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/pair_arguments.hpp"
#include "shared/run_diagnosis.hpp"
#include "shared/sequence_source.hpp"
#include "shared/standard_output.hpp"
#include "track/track_outputs.hpp"
#include "track/track_picture.hpp"

namespace {

struct TrackArguments {
  SequenceRequest sequence;
  CameraArguments camera;
  RunCorrections corrections;
  MethodArguments method;
  Overrides following;  ///< options of ego and track: dotted name and text
  std::vector<std::string> topics;
  ReadingArguments reading;
  std::string json, kitti, video;
};

/// Before the work; the files themselves are opened when the first pair is known to be good.
void check_outputs(const TrackArguments& arguments) {
  OutputClaims claims;
  for (const auto& source : arguments.sequence.sources) claims.reads(source);
  for (const auto& path : {arguments.sequence.calib, arguments.sequence.times, arguments.camera.right_calib,
                           arguments.method.options_file, arguments.method.model})
    claims.reads(path);
  claims.writes_in_place(arguments.json, "--json");
  claims.writes_in_place(arguments.kitti, "--kitti");
  claims.writes(arguments.video, "--video");
}

/// Rate and latency on a terminal, a line that is written over, and at the end one that stays.
class StatusLine {
 public:
  explicit StatusLine(bool is_wanted)
      : is_visible_(is_wanted && verbosity() != Verbosity::quiet && isatty(STDERR_FILENO) != 0) {}
  ~StatusLine() {
    if (is_visible_ && pairs_ > 0) std::fprintf(stderr, "\r\033[K%s\n", text().c_str());
  }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void show(double latency_ms) {
    ++pairs_;
    latencies_.add(latency_ms);
    if (is_visible_) std::fprintf(stderr, "\r\033[K%s", text().c_str());
  }

 private:
  std::string text() const {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return fmt::format("{} {}, {:.1f} a second; {}; 0 dropped", pairs_, pairs_ == 1 ? "pair" : "pairs",
                       static_cast<double>(pairs_) / elapsed.count(), latencies_.text());
  }

  bool is_visible_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::size_t pairs_ = 0;
  Latencies latencies_;
};

/// The film of a run, in the time of its pairs.
class TrackFilm {
 public:
  TrackFilm(const std::string& path, const std::vector<double>& times_s) : film_(path, rate_hz(times_s)) {}

  void add(const flies::RectifiedPair& pair, const TrackedFrame& frame) {
    film_.add(track_picture(view_, pair.left, frame));
  }
  void commit() { film_.commit(); }

 private:
  static double rate_hz(const std::vector<double>& times_s) {
    constexpr double kOfOnePair_hz = 10.0;
    if (times_s.size() < 2) return kOfOnePair_hz;
    return static_cast<double>(times_s.size() - 1) / (times_s.back() - times_s.front());
  }

  flies::Film film_;
  flies::TrackView view_;
};

void run_track(TrackArguments arguments) {
  check_outputs(arguments);
  const flies::DetectorOptions unfitted = effective_options(arguments.method);
  const flies::TrackerOptions following = with_overrides<flies::TrackerOptions>(arguments.following);
  const auto classifier = classifier_of(arguments.method);
  if (!arguments.camera.cameras.empty())
    arguments.sequence.cameras = std::array{arguments.camera.cameras[0], arguments.camera.cameras[1]};
  if (!arguments.topics.empty()) arguments.sequence.topics = std::array{arguments.topics[0], arguments.topics[1]};
  arguments.sequence.reading = reading_of(arguments.reading);
  const SequenceSource source = open_sequence(arguments.sequence);

  // The detector keeps to its own arena; this holds OpenCV, which runs on oneTBB too, to the same number.
  std::optional<tbb::global_control> thread_limit;
  if (unfitted.threads > 0) {
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(unfitted.threads));
    cv::setNumThreads(unfitted.threads);
  }

  std::optional<flies::Calibration> calibration;
  std::optional<flies::Tracker> tracker;
  RunDiagnosis run;
  flies::PairWatch watch;
  std::shared_ptr<const flies::RunRecord> run_of;
  std::optional<LineFile> json, kitti;
  std::optional<TrackFilm> film;
  if (!arguments.video.empty()) film.emplace(arguments.video, source.times_s);
  const bool has_lines = !arguments.json.empty() || !arguments.kitti.empty();
  StatusLine status((!arguments.json.empty() && arguments.json != "-") || (film && !has_lines));
  for (std::size_t i = 0; i < source.pairs.size(); ++i) {
    const auto& [left_path, right_path] = source.pairs[i];
    flies::GrayPair images = source.load(i);
    if (i == 0 && !source.recording)
      if (const auto note = orientation_note(source.pairs[i])) say_notes({*note});
    if (i == 0)
      calibration = source.recording && arguments.sequence.calib.empty()
                        ? source.recording->calibration(arguments.camera)
                        : flies::load_calibration(source.calib, calibration_request(arguments.camera, left_path,
                                                                                    right_path, images.view()));
    if (calibration->rectifier) images = calibration->rectifier->rectify(images);
    if (i == 0)
      run = diagnose(
          source.pairs.size(), [&](std::size_t k) { return source.load(k); }, *calibration, arguments.corrections);
    run.correct(images);
    const flies::RectifiedPair pair = images.view();
    flies::check_camera_fits(calibration->camera, pair.left.width_px, pair.left.height_px,
                             i == 0 ? source.calib : left_path);
    if (i == 0) {
      calibration->camera.width_px = pair.left.width_px;
      calibration->camera.height_px = pair.left.height_px;
      const auto options = effective_options(arguments.method, calibration->camera);
      tracker.emplace(calibration->camera, options, following, classifier);
      run_of = run_record(arguments.method, options, calibration->camera, source.calib);
      auto notes = source.notes;
      for (const auto& note : calibration->notes) notes.push_back(source.calib + ": " + note);
      for (const auto& note : run.notes) notes.push_back(left_path + ": " + note);
      say_notes(notes);
      say_run(*run_of);
      flies::check_true_pair(pair, calibration->camera, left_path, right_path);
      if (!arguments.json.empty()) json.emplace(arguments.json);
      if (!arguments.kitti.empty()) kitti.emplace(arguments.kitti);
    }
    say_notes(watch.look(pair, calibration->camera, left_path));

    const auto start = std::chrono::steady_clock::now();
    const TrackedFrame frame{.frame = static_cast<int>(i),
                             .left = left_path,
                             .right = right_path,
                             .seed = unfitted.seed,
                             .preset = preset_name(unfitted),
                             .camera = calibration->camera,
                             .tracking = tracker->process(pair, source.times_s[i]),
                             .run = run_of};
    const std::chrono::duration<double, std::milli> latency = std::chrono::steady_clock::now() - start;
    if (json) json->write(track_json_line(frame));
    if (kitti) kitti->write(kitti_tracking_lines(frame));
    if (film) film->add(pair, frame);
    if (!json && !kitti && !film) print(track_table(frame));
    status.show(latency.count());
  }
  if (film) film->commit();
  say_notes(watch.counts());
}

}  // namespace

void setup_track(CLI::App& app) {
  CLI::App* command = app.add_subcommand("track", "follow things through a sequence: identity, velocity, ego-motion");
  const auto arguments = std::make_shared<TrackArguments>();
  command
      ->add_option("SOURCE", arguments->sequence.sources,
                   "a recording (.mcap, .bag), a KITTI raw drive, a drawn sequence, or the folders of left and right "
                   "images; "
                   "with --split one folder")
      ->required()
      ->expected(1, 2);
  command->add_option("--calib", arguments->sequence.calib, "calibration; of a drive the one beside it, if not given")
      ->type_name("FILE");
  command->add_option("--rate", arguments->sequence.rate_hz, "pairs a second, where there are no times")
      ->check(CLI::Range(0.01, 10000.0).description(""))
      ->type_name("HZ");
  command->add_option("--times", arguments->sequence.times, "times of the pairs, one a line: seconds, or as KITTI raw")
      ->type_name("FILE");
  command->add_option("--topics", arguments->topics, "of a recording: topics of the left and the right pictures")
      ->expected(2)
      ->delimiter(',')
      ->type_name("LEFT,RIGHT");
  add_reading_options(*command, arguments->reading);
  add_cameras_option(*command, arguments->camera, "KITTI cameras, e.g. 2,3; of a drive else 0,1 when there, else 2,3");
  add_calibration_options(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  add_correction_options(*command, arguments->corrections);
  add_method_options(*command, arguments->method);
  add_listed_options<flies::TrackerOptions>(*command, "", "Following", arguments->following);
  command->add_option("--json", arguments->json, "one JSON object a line, a line a pair; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--kitti", arguments->kitti, "KITTI's tracking format, a line a track; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--video", arguments->video,
                   "MP4 film: the left image with boxes, beside it the view from above with trails")
      ->type_name("FILE")
      ->group("Output");
  command->footer(
      "\nVelocities are over ground, in the axes of the vehicle at that time (x forward, y left). Lines are\n"
      "written whole and at once, so that a pipe or `tail -f` sees each pair when it is done. Without outputs\n"
      "a table is printed. docs/dynamic.md says how it works and how well.\n"
      "\nExamples:\n"
      "  flies track 2011_09_26/2011_09_26_drive_0005_sync\n"
      "  flies track left right --calib calib.yaml --rate 15 --json - | tee tracks.jsonl\n"
      "  flies track recording.mcap --topics /cam/left/image_rect,/cam/right/image_rect\n"
      "  flies track drive --video drive.mp4                 of a folder of `flies synth --sequence`\n"
      "\nExit status: 0 done, 2 a fault in the input, told in one line.");
  command->callback([arguments] { run_track(*arguments); });
}
