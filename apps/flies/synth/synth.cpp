#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/options_yaml.hpp"
#include "flies/io/output_file.hpp"
#include "flies/synth/render.hpp"
#include "flies/synth/sequence.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/progress_bar.hpp"
#include "shared/staged_folder.hpp"
#include "shared/standard_output.hpp"
#include "synth/pasted_pairs.hpp"
#include "synth/synth_output.hpp"

namespace {

struct SynthArguments {
  std::string folder;
  std::optional<int> frames;
  bool is_sequence = false;
  double rate_hz = 10.0;
  int threads = 0;
  bool force = false;
  std::string options_file;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< name and text, in the order of the command line
  std::string paste, onto;                                     ///< folders; empty: scenes are drawn
  int start = 0, step = 1;
};

template <class Options>
Options with_settings(Options options, const SynthArguments& arguments) {
  if (!arguments.options_file.empty())
    for (const auto& setting : flies::load_options_yaml(arguments.options_file))
      flies::set_option(options, setting.path, setting.text, setting.source);
  for (const auto& [name, text] : arguments.overrides) flies::set_option(options, name, text, "command line");
  return options;
}

/// What is not set is as the place usually has it.
flies::SceneOptions effective_options(const SynthArguments& arguments) {
  for (const auto& [name, text] : arguments.overrides)  // the kind of scene is called `--scene` there
    if (name == "kind")
      flies::detail::parse_name(text, flies::EnumNames<flies::SceneKind>::names, "--scene", "command line");
  return with_settings(flies::scene_defaults(with_settings(flies::SceneOptions{}, arguments).kind), arguments);
}

void write_color_png(const std::string& path, const flies::ColorImage& image) {
  // OpenCV has no view of constant pixels; it only reads them here.
  const cv::Mat rgb(image.height_px, image.width_px, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  flies::write_png(path, bgr);
}

void write_frame(const StagedFolder& folder, int frame, const flies::RenderedPair& pair,
                 const flies::StereoCamera& camera, std::uint64_t seed,
                 const std::optional<flies::TruthMoment>& moment) {
  const std::string name = fmt::format("{:06}", frame);
  write_color_png(folder.path("left/" + name + ".png"), pair.left);
  write_color_png(folder.path("right/" + name + ".png"), pair.right);
  write_disparity_png(folder.path("disparity/" + name + ".png"), pair.pixels);
  flies::write_file(folder.path("label_2/" + name + ".txt"), flies::kitti_labels(pair.objects, camera));
  flies::write_file(folder.path("truth/" + name + ".json"), flies::truth_json(pair.objects, camera, seed, moment));
}

std::string summary(const SynthArguments& arguments, int frames, std::size_t obstacles, std::size_t people) {
  const std::string& out = arguments.folder;
  const std::string next = arguments.is_sequence
                               ? fmt::format("flies track {}, flies evaluate {}", out, out)
                               : fmt::format("flies detect {}/left {}/right --calib {}/calib.yaml", out, out, out);
  return fmt::format("{}: {} {}, {} obstacles in view, {} of them people\nnext: {}\n", out, frames,
                     frames == 1 ? "pair" : "pairs", obstacles, people, next);
}

void check_place(const flies::SceneOptions& options, const SynthArguments& arguments) {
  if (arguments.is_sequence && options.kind != flies::SceneKind::street)
    throw flies::InputError("command line", "--sequence",
                            fmt::format("takes place in a street, found --scene {}", flies::enum_name(options.kind)));
}

/// Options that only drawn scenes have.
void refuse_options_of_scenes(const SynthArguments& arguments) {
  const auto known = flies::list_options(flies::PasteOptions{});
  for (const auto& [name, text] : arguments.overrides) {
    const std::string option = name == "kind" ? "--scene" : "--" + name;
    if (std::ranges::none_of(known, [&](const auto& listing) { return listing.path == name; }))
      throw flies::InputError("command line", option,
                              "is for scenes that are drawn: --paste puts people into the pairs of --onto as they are");
  }
}

constexpr int kUsualSequenceFrames = 60;

int frames_of(const SynthArguments& arguments) {
  if (!arguments.is_sequence) return arguments.frames.value_or(1);
  const int frames = arguments.frames.value_or(kUsualSequenceFrames);
  const double duration_s = (frames - 1) / arguments.rate_hz;
  if (duration_s > flies::StreetSequence::kLongest_s)
    throw flies::InputError("command line", "--frames",
                            fmt::format("{} pairs at {} Hz last {:.1f} s, expected {} s at most", frames,
                                        arguments.rate_hz, duration_s, flies::StreetSequence::kLongest_s));
  return frames;
}

/// The scenes of a run: each of its own seed, or one drive.
class Scenes {
 public:
  Scenes(const flies::SceneOptions& options, const SynthArguments& arguments)
      : options_(options), rate_hz_(arguments.rate_hz) {
    if (arguments.is_sequence) sequence_.emplace(options);
  }

  /// Of the noise of every frame, and of its scene where each has its own.
  std::uint64_t seed(int frame) const { return options_.seed + static_cast<std::uint64_t>(frame); }

  flies::RenderedPair render(int frame, const flies::StereoCamera& camera) const {
    flies::SceneOptions options = options_;
    options.seed = seed(frame);
    const auto scene = sequence_ ? sequence_->scene_at(time_s(frame)) : flies::build_scene(options);
    return flies::render_pair(scene, camera, options);
  }

  std::optional<flies::TruthMoment> moment(int frame) const {
    if (!sequence_) return std::nullopt;
    return flies::TruthMoment{time_s(frame), sequence_->pose_at(time_s(frame))};
  }

 private:
  double time_s(int frame) const { return frame / rate_hz_; }

  flies::SceneOptions options_;
  double rate_hz_;
  std::optional<flies::StreetSequence> sequence_;
};

void write_times(const StagedFolder& folder, const Scenes& scenes, int frames) {
  std::string text;
  for (int frame = 0; frame < frames; ++frame) text += fmt::format("{:.6f}\n", scenes.moment(frame)->time_s);
  flies::write_file(folder.path("times.txt"), text);
}

/// All that any kind of scene writes: what one leaves out must not stay of another that stood in the folder.
const std::vector<std::string> kEntries = {"left",  "right",      "disparity",  "label_2",  "truth",
                                           "calib", "calib.yaml", "scene.yaml", "times.txt"};

void run_synth(const SynthArguments& arguments) {
  const flies::SceneOptions options = effective_options(arguments);
  check_place(options, arguments);
  const flies::StereoCamera camera = flies::synthetic_camera(options);
  const int frames = frames_of(arguments);
  const Scenes scenes(options, arguments);
  StagedFolder folder(arguments.folder, kEntries, arguments.force);
  std::size_t obstacles = 0, people = 0;
  {
    ProgressBar progress(static_cast<std::size_t>(frames));
    tbb::task_arena arena(arguments.threads > 0 ? arguments.threads : tbb::task_arena::automatic);
    for (int frame = 0; frame < frames; ++frame) {
      const flies::RenderedPair pair = arena.execute([&] { return scenes.render(frame, camera); });
      write_frame(folder, frame, pair, camera, scenes.seed(frame), scenes.moment(frame));
      for (const auto& object : pair.objects) {
        if (object.visible_px == 0) continue;
        ++obstacles;
        if (object.kind == flies::ObjectClass::pedestrian) ++people;
      }
      progress.show(static_cast<std::size_t>(frame) + 1);
    }
  }
  flies::write_file(folder.path("calib.yaml"), flies::calibration_yaml(camera));
  flies::write_file(folder.path("scene.yaml"), flies::options_yaml(flies::list_options(options)));
  if (arguments.is_sequence) write_times(folder, scenes, frames);
  folder.commit();
  print(summary(arguments, frames, obstacles, people));
}

void run_paste(const SynthArguments& arguments) {
  refuse_options_of_scenes(arguments);
  const auto options = with_settings(flies::PasteOptions{}, arguments);
  PastedPairs pairs(arguments.paste, arguments.onto, options);
  pairs.check_apart(arguments.folder, kEntries);
  const auto frames = pairs.choose(arguments.start, arguments.step, arguments.frames);
  StagedFolder folder(arguments.folder, kEntries, arguments.force);
  pairs.cut_out_people();
  {
    ProgressBar progress(frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      pairs.write(folder, i, frames[i]);
      progress.show(i + 1);
    }
  }
  pairs.write_cameras(folder);
  flies::write_file(folder.path("scene.yaml"), flies::options_yaml(flies::list_options(options)));
  folder.commit();
  print(pairs.summary(arguments.folder));
}

}  // namespace

void setup_synth(CLI::App& app) {
  CLI::App* command = app.add_subcommand("synth", "render streets and other places with known truth");
  constexpr int kMostPairs = 1'000'000'000;
  const auto arguments = std::make_shared<SynthArguments>();
  command->add_option("OUT", arguments->folder, "folder to make")->required();
  command
      ->add_option("--frames", arguments->frames,
                   "pairs to render, default 1, or 60 of a sequence; their seeds count up from --seed")
      ->check(in_range(1, 100000))
      ->type_name("N");
  CLI::Option* sequence = command->add_flag("--sequence", arguments->is_sequence,
                                            "render a drive through one street, where cars, cyclists and people move");
  command->add_option("--rate", arguments->rate_hz, "pairs a second of a sequence, default 10")
      ->check(in_range(0.5, 1000.0))
      ->needs(sequence)
      ->type_name("HZ");
  CLI::Option* paste = command->add_option("--paste", arguments->paste,
                                           "folder of people to paste into real pairs instead: crops of one upright "
                                           "person each, with or without masks (NAME_mask.png)");
  paste->excludes(sequence)->type_name("DIR");
  CLI::Option* onto = command->add_option(
      "--onto", arguments->onto, "folder of the pairs to paste into, with truth, as `flies evaluate` reads it");
  onto->needs(paste)->type_name("DIR");
  paste->needs(onto);
  command->add_option("--start", arguments->start, "first of these pairs, counted from 0")
      ->check(in_range(0, kMostPairs).description(""))
      ->needs(onto)
      ->type_name("N");
  command->add_option("--step", arguments->step, "use only every Nth of them")
      ->check(in_range(1, kMostPairs).description(""))
      ->needs(onto)
      ->type_name("N");
  command->add_option("--threads", arguments->threads, "worker threads, 0 for one per core; pixels do not depend on it")
      ->check(in_range(0, 256))
      ->type_name("N");
  command->add_flag("--force", arguments->force, "overwrite an earlier result in a folder that is not empty");
  command->add_option("--options", arguments->options_file, "YAML file of options, such as the scene.yaml of a result")
      ->type_name("FILE");
  for (const auto& listing : flies::list_options(flies::SceneOptions{})) {
    const std::string flag = listing.path == "kind" ? "--scene,--kind" : "--" + listing.path;
    command
        ->add_option_function<std::string>(
            flag,
            [arguments, path = listing.path](const std::string& text) {
              arguments->overrides.emplace_back(path, text);
            },
            fmt::format("{}; {}, default {}", listing.meaning, listing.allowed, listing.value))
        ->type_name(listing.is_enum_or_bool ? "NAME" : "N")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group("Scene, camera and sensor");
  }
  command->footer(
      "\nWrites OUT/left/000000.png, OUT/right/..., OUT/calib.yaml, OUT/disparity/... (16 bits, disparity\n"
      "times 256, 0 for the sky), OUT/label_2/... (KITTI labels), OUT/truth/... (JSON) and OUT/scene.yaml.\n"
      "A sequence also has the times of its pairs in OUT/times.txt, and its truth holds the pose of the camera\n"
      "and the id and velocity of every object. Some scenes have other defaults: a room, an aisle, woods (seen\n"
      "from a drone) and a pavement (seen from a low rover) have 640 x 480 px, focal_px 450, baseline_m 0.12\n"
      "(woods 0.2), camera_height_m 1, 0.5, 7 and 0.3, pitch_deg 10, 5, 0 and 3, fewer people, and no sun indoors.\n"
      "\n--paste puts people into real pairs. It writes the same files, with grey images, and takes only --seed,\n"
      "--people, --people_min_range_m (8), --people_max_range_m (24) and --noise_gray of the options above. If\n"
      "--frames is larger than the number of pairs, they are used again with other people. Pairs of several\n"
      "cameras have OUT/calib/000000.yaml ... instead of OUT/calib.yaml.\n"
      "\nExamples:\n"
      "  flies synth street                                  one town street\n"
      "  flies synth crowd --frames 20 --seed 7 --people 15  twenty busier ones\n"
      "  flies synth one --scene pedestrian --people_min_range_m 15.5\n"
      "  flies synth room --scene room --frames 5            what a robot 1 m high sees; also aisle, woods, pavement\n"
      "  flies synth drive --sequence --seed 3               six seconds of driving, 10 pairs each\n"
      "  flies synth pasted --paste data/people/test/positives/inria --onto data/kitti_stereo2012 --start 1 --step 2\n"
      "\nExit status: 0 done, 2 an error in the options or a folder that cannot be written.");
  command->callback([arguments] { arguments->paste.empty() ? run_synth(*arguments) : run_paste(*arguments); });
}
