#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/folder.hpp"
#include "flies/video/capture.hpp"
#include "live/live_run.hpp"
#include "live/live_sources.hpp"
#include "live/run_outputs.hpp"
#include "live/view.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/listed_options.hpp"
#include "shared/method_arguments.hpp"
#include "shared/named_output.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/pair_arguments.hpp"
#include "shared/recording_file.hpp"
#include "shared/sequence_source.hpp"
#include "shared/source_options.hpp"

namespace {

struct LiveArguments {
  std::vector<std::string> sources;
  std::string calib;
  CameraArguments camera;
  RunCorrections corrections;
  MethodArguments method;
  Overrides following;
  flies::PairStreamRequest stream;
  std::string times;
  std::vector<int> size_px;
  std::optional<double> max_skew_ms;
  std::uint64_t max_pairs = 0;
  OutputRequest outputs;

  LiveArguments() { method.threads = 2; }  // so that ego-motion is measured while flies evolve
};

constexpr int kViewPort = 8090;
constexpr int kFoxglovePort = 8765;  // where Foxglove looks first

int port_number(const std::string& text, const std::string& option) {
  constexpr int kMost = 65535;
  if (text.find_first_not_of("0123456789-+") != text.npos)
    throw flies::InputError("command line", option,
                            fmt::format("found '{}', expected a port or nothing: if '{}' is a source, put it before {}",
                                        text, text, option));
  const auto port = flies::detail::parse_int(text, {0, kMost}, option, "command line");
  return static_cast<int>(port);
}

[[noreturn]] void refuse_recording(const std::string& path) {
  throw flies::InputError(path, "",
                          "is a recording, expected a camera, a film or folders of images; `flies track` reads it");
}

/// @throws flies::InputError naming an option that can do nothing with these sources
void refuse_idle_options(const LiveArguments& arguments) {
  const auto& sources = arguments.sources;
  const auto& stream = arguments.stream;
  refuse_idle_source_options(sources, stream.reading.split, !arguments.size_px.empty());
  const auto refuse = [](const char* option, const std::string& why) {
    throw flies::InputError("command line", option, why);
  };
  const auto is_any = [&](flies::SourceKind kind) {
    return std::ranges::find(sources, kind, flies::source_kind) != sources.end();
  };
  const bool has_file = is_any(flies::SourceKind::file), has_device = is_any(flies::SourceKind::device);
  if (arguments.max_skew_ms && (sources.size() == 1 || flies::detail::is_there_as_folder(sources.front())))
    refuse("--max-skew", "is for two cameras, films or pipelines, whose pictures are paired by their times");
  if (stream.is_looped && !has_file)
    refuse("--loop", fmt::format("is for films and folders, and {} is neither", sources.front()));
  if (stream.rate_hz > 0.0 && !has_file && !has_device)
    refuse("--rate", fmt::format("is for cameras, films and folders, and {} is none of them", sources.front()));
}

/// Folders become lists of pairs with their times.
void open_folders(LiveArguments& arguments, OutputClaims& claims) {
  const std::string& first = arguments.sources.front();
  if (flies::detail::is_there(first) && !flies::detail::is_there_as_folder(first) && recording_of(first))
    refuse_recording(first);
  if (!flies::detail::is_there_as_folder(first)) {
    if (arguments.sources.size() > 1 && flies::detail::is_there_as_folder(arguments.sources[1]))
      throw flies::InputError(arguments.sources[1], "",
                              "is a folder, but " + first + " is none: expected two sources of one kind");
    if (!arguments.times.empty())
      throw flies::InputError("command line", "--times",
                              "is for folders of images; other sources have their own times");
    return;
  }
  SequenceRequest request;
  request.sources = arguments.sources;
  request.reading = arguments.stream.reading;
  request.calib = arguments.calib;
  request.times = arguments.times;
  if (arguments.stream.rate_hz > 0.0) request.rate_hz = arguments.stream.rate_hz;
  if (!arguments.camera.cameras.empty())
    request.cameras = std::array{arguments.camera.cameras[0], arguments.camera.cameras[1]};
  SequenceSource sequence = open_sequence(request);
  if (sequence.recording) refuse_recording(first);
  claims.reads(sequence.pairs);
  claims.reads(sequence.files);
  say_notes(sequence.notes);
  arguments.calib = sequence.calib;
  const auto& times_s = arguments.stream.times_s = std::move(sequence.times_s);
  if (arguments.stream.rate_hz <= 0.0 && times_s.size() > 1)
    arguments.stream.rate_hz = static_cast<double>(times_s.size() - 1) / (times_s.back() - times_s.front());
  arguments.stream.folder = std::move(sequence.pairs);
}

/// @param claims get to know the files of folders
LiveRequest live_request(LiveArguments& arguments, OutputClaims& claims) {
  LiveRequest request;
  open_folders(arguments, claims);
  if (arguments.calib.empty()) throw flies::InputError("command line", "--calib", "is missing, expected a file");
  // Before a camera is opened, which takes a while.
  if (!flies::detail::is_there(arguments.calib)) throw flies::InputError(arguments.calib, "", "does not exist");
  request.stream = arguments.stream;
  if (request.stream.folder.empty()) request.stream.sources = arguments.sources;
  if (arguments.size_px.size() == 2) {
    request.stream.width_px = arguments.size_px[0];
    request.stream.height_px = arguments.size_px[1];
  }
  if (arguments.max_skew_ms) request.stream.max_skew_s = 1e-3 * *arguments.max_skew_ms;
  request.calib = arguments.calib;
  request.camera = arguments.camera;
  request.corrections = corrections_for(arguments.corrections, arguments.method);
  request.method = arguments.method;
  request.following = following_options(arguments.method, arguments.following);
  request.classifier = classifier_of(arguments.method);
  request.max_pairs = arguments.max_pairs;
  return request;
}

OutputClaims check_outputs(const LiveArguments& arguments) {
  OutputClaims claims;
  claims.reads(arguments.sources);
  for (const auto& source : arguments.sources) claims.reads(files_of_pipeline(source));
  claims.reads(arguments.times);
  claims.reads_method(arguments.method);
  claims.reads_calibration(arguments.calib, arguments.camera.right_calib);
  claims.writes_in_place(arguments.outputs.json, "--json");
  require_named_output(arguments.outputs.record, "--record");
  claims.writes_in_place(arguments.outputs.record, "--record");
  claims.writes(arguments.outputs.video, "--video");
  return claims;
}

/// The page steers the run as long as there is one.
class Steered {
 public:
  Steered(View* view, LiveRun& run) : view_(view) {
    if (view_ != nullptr) view_->control(run);
  }
  ~Steered() {
    if (view_ != nullptr) view_->release();
  }
  Steered(const Steered&) = delete;
  Steered& operator=(const Steered&) = delete;

 private:
  View* view_;
};

void run_live(LiveArguments arguments) {
  read_options_file(arguments.method);
  std::ranges::transform(arguments.sources, arguments.sources.begin(), without_file_scheme);
  refuse_idle_options(arguments);
  check_sources_differ(arguments.sources);
  OutputClaims claims = check_outputs(arguments);
  LiveRequest request = live_request(arguments, claims);
  std::optional<tbb::global_control> thread_limit;
  if (const int threads = effective_options(request.method).threads; threads > 0) {
    thread_limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    cv::setNumThreads(threads);
  }
  if (!arguments.outputs.record.empty() || !arguments.outputs.video.empty()) outlive_readers();
  arguments.outputs.is_patient = arguments.stream.is_patient;
  RunOutputs outputs(arguments.outputs);
  LiveRun run(std::move(request), outputs.sinks());
  ask_before_ending_on_signals();
  const Steered steered(outputs.view(), run);
  try {
    run.run();
  } catch (...) {
    outputs.close_files();
    throw;
  }
  outputs.finish(run.source_counts());
}

void add_source_options(CLI::App& command, LiveArguments& arguments) {
  command
      .add_option("SOURCE", arguments.sources,
                  "one source that gives both pictures, or one for the left and one for the right pictures: a camera "
                  "(0, /dev/video0), a film, a GStreamer pipeline, a URL, a KITTI raw drive, or two folders of images")
      ->required()
      ->expected(1, 2);
  command
      .add_option("--calib", arguments.calib,
                  "calibration file; default for a KITTI drive or a drawn sequence: the one that belongs to it")
      ->type_name("FILE");
  command
      .add_option_function<std::string>(
          "--split,--layout",
          [&arguments](const std::string& word) {
            const auto split = flies::split_of(word);
            if (!split)
              throw flies::InputError("command line", "--split",
                                      fmt::format("found '{}', expected none, side or top", word));
            arguments.stream.reading.split = *split;
            arguments.stream.layout =
                *split == flies::Split::top_bottom ? flies::PairLayout::top_bottom : flies::PairLayout::side_by_side;
          },
          "how one source, or each image of one folder, holds both pictures: side (side by side, left first; default "
          "for films and cameras) or top (one above the other, left on top)")
      ->type_name("HOW");
  command
      .add_option_function<std::string>(
          "--bayer",
          [&arguments](const std::string& word) {
            arguments.stream.reading.bayer = reading_of({.split = "none", .bayer = word}).bayer;
          },
          "the pictures are raw Bayer mosaics of colour cameras (rggb, bggr, grbg or gbrg) and are converted to grey")
      ->type_name("PATTERN");
  command.add_option("--size", arguments.size_px, "picture size to ask the camera for, both pictures together")
      ->delimiter(',')
      ->expected(2)
      ->check(in_range(16, 100000).description(""))
      ->type_name("W,H");
  command
      .add_option(
          "--rate", arguments.stream.rate_hz,
          "pairs per second: for films and folders used instead of their own rate, for a camera the rate to ask it for")
      ->check(in_range(0.01, 10000.0).description(""))
      ->type_name("HZ");
  command
      .add_option(
          "--times", arguments.times,
          "times of a folder's pairs, one per line: seconds, or date and time (KITTI raw, RFC 3339); default: "
          "by --rate, or else a drive's own times, or else those in the image names, or else 10 pairs per second")
      ->type_name("FILE");
  command.add_flag("--loop", arguments.stream.is_looped, "start films and folders again when they end");
  command.add_flag("--every-pair", arguments.stream.is_patient,
                   "films and folders: process every pair, as fast as possible, and drop none");
  command
      .add_option("--max-skew", arguments.max_skew_ms,
                  "largest difference in time, milliseconds, of pictures of two sources that make a pair; default 20")
      ->check(in_range(0.1, 10000.0).description(""))
      ->type_name("MS");
  command.add_option("--pairs", arguments.max_pairs, "end after this many pairs")
      ->check(in_range(1, 2147483647).description(""))
      ->type_name("N");
}

}  // namespace

void setup_live(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("live", "follow things live in the pictures of a camera, a film or a pipeline");
  const auto arguments = std::make_shared<LiveArguments>();
  add_source_options(*command, *arguments);
  add_cameras_option(
      *command, arguments->camera,
      "left and right camera of a KITTI calibration, e.g. 2,3; default for a drive: 0,1 if it has them, or else 2,3");
  add_calibration_options(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  add_correction_options(*command, arguments->corrections);
  add_method_options(*command, arguments->method);
  add_listed_options<flies::TrackerOptions>(*command, "", "", arguments->following);
  command
      ->add_option("--json", arguments->outputs.json,
                   "one JSON object per line, one line per pair; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option_function<std::string>(
          "--view",
          [arguments](const std::string& text) {
            arguments->outputs.view_port = text.empty() ? kViewPort : port_number(text, "--view");
          },
          fmt::format("show what is seen on a page for a web browser; default port {}", kViewPort))
      ->expected(0, 1)
      ->type_name("[PORT]")
      ->group("Output");
  command
      ->add_option("--view-address", arguments->outputs.view_address,
                   "address of the page; if other machines can reach it, it asks for a token; default 127.0.0.1")
      ->needs("--view")
      ->type_name("ADDRESS")
      ->group("Output");
  command
      ->add_option_function<std::string>(
          "--foxglove",
          [arguments](const std::string& text) {
            arguments->outputs.foxglove_port = text.empty() ? kFoxglovePort : port_number(text, "--foxglove");
          },
          fmt::format(
              "send pictures and results to Foxglove or Lichtblick by their WebSocket protocol; default port {}",
              kFoxglovePort))
      ->expected(0, 1)
      ->type_name("[PORT]")
      ->group("Output");
  command
      ->add_option("--foxglove-address", arguments->outputs.foxglove_address,
                   "IP address to listen on for Foxglove; anyone who can reach it sees everything; default 127.0.0.1")
      ->needs("--foxglove")
      ->type_name("ADDRESS")
      ->group("Output");
  command
      ->add_option("--record", arguments->outputs.record,
                   "record pictures and results as MCAP, for Foxglove, Lichtblick and flies track")
      ->type_name("FILE")
      ->group("Output");
  command
      ->add_option("--video", arguments->outputs.video,
                   "MP4 film: the left image with boxes, beside it the view from above with trails")
      ->type_name("FILE")
      ->group("Output");
  command->footer(
      "\nWhen pairs come faster than they can be processed, older ones are dropped and counted. If a camera goes\n"
      "away, gives broken pictures or hangs, that is reported once, and it is opened again until it is back.\n"
      "Ctrl-C ends the run after the current pair. Two threads process a pair, unless --threads says otherwise.\n"
      "The options for following things are those of `flies track`. See docs/live.md for more.\n"
      "\nExamples:\n"
      "  flies live 0 --size 2560,720 --calib calib.yaml               a camera that gives both pictures side by side\n"
      "  flies live /dev/video0 /dev/video2 --calib calib.yaml         two cameras\n"
      "  flies live both.mp4 --calib calib.yaml --loop --json -        a film\n"
      "  flies live 0 --calib calib.yaml --view                        and a page at http://127.0.0.1:8090/\n"
      "  flies live left right --calib calib.yaml --rate 10 --loop     folders of images, as if they came from a "
      "camera\n"
      "  flies live 'v4l2src ! image/jpeg ! jpegdec' --calib calib.yaml\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_live(*arguments); });
}
