#include "flies/train/train.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/classify/model_file.hpp"
#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/io/output_file.hpp"
#include "flies/train/training_report.hpp"
#include "flies/version.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/progress_bar.hpp"
#include "shared/standard_output.hpp"
#include "shared/training_inputs.hpp"

namespace {

struct TrainArguments {
  std::vector<std::string> positives, negatives, stereo_negatives;
  double crop_person_share = 0.75;
  std::string out, name, work, report;
  std::vector<std::string> about;  ///< KEY=TEXT
  std::vector<std::pair<std::string, std::string>> overrides;
};

/// What the training is doing, on standard error when that is a terminal.
class ProgressLine {
 public:
  ~ProgressLine() { clear(); }

  void show(std::string_view chapter, std::size_t done, std::size_t total) {
    if (chapter != chapter_) {
      clear();
      chapter_ = chapter;
      what_ = "pictures, " + chapter_;
      if (total > 1)
        bar_.emplace(total, what_.c_str());
      else if (is_line_wanted())
        std::fprintf(stderr, "\r%s ...", chapter_.c_str());
    }
    if (bar_) bar_->show(done);
  }

 private:
  static bool is_line_wanted() { return verbosity() != Verbosity::quiet && isatty(STDERR_FILENO) != 0; }
  void clear() {
    bar_.reset();
    if (!chapter_.empty() && is_line_wanted()) std::fputs("\r\033[K", stderr);
  }

  std::string chapter_, what_;
  std::optional<ProgressBar> bar_;
};

flies::TrainOptions options_of(const TrainArguments& arguments) {
  flies::TrainOptions options;
  for (const auto& [path, text] : arguments.overrides) flies::set_option(options, path, text, "command line");
  return options;
}

/// Flies look for people with the margin that the model will have been trained with.
flies::DetectorOptions proposing(const flies::TrainOptions& options) {
  flies::DetectorOptions detector;
  detector.seed = options.seed;
  detector.threads = options.threads;
  detector.propose.person_share = options.positives.person_share;
  detector.propose.min_person_px = options.negatives.min_proposed_px;
  return detector;
}

flies::TrainingData find_data(const TrainArguments& arguments, const flies::TrainOptions& options) {
  const auto note = [](const std::string& text) { say_notes({text}); };
  flies::TrainingData data{flies::find_pictures_of_people(arguments.positives, arguments.crop_person_share, note),
                           flies::find_background(arguments.negatives, note)};
  for (auto& picture : flies::find_proposals(arguments.stereo_negatives, proposing(options)))
    data.background.push_back(std::move(picture));
  return data;
}

std::string changed_options(const flies::TrainOptions& options) {
  std::string text;
  const auto defaults = flies::list_options(flies::TrainOptions{});
  const auto listings = flies::list_options(options);
  for (std::size_t i = 0; i < listings.size(); ++i)
    if (listings[i].value != defaults[i].value && listings[i].path != "threads")
      text += fmt::format("{}{}={}", text.empty() ? "" : " ", listings[i].path, listings[i].value);
  return text.empty() ? "defaults" : text;
}

/// One line that fits a value of the model file.
std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::string line;
  for (const char c : text) {
    if (c == '\n')
      line += "; ";
    else if (c != ' ' || (!line.empty() && line.back() != ' '))
      line += c;
  }
  return line;
}

using Texts = std::vector<std::pair<std::string, std::string>>;

Texts parse_about(const std::vector<std::string>& entries) {
  Texts texts;
  for (const auto& entry : entries) {
    const auto equals = entry.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw flies::InputError("command line", "--about", fmt::format("found '{}', expected KEY=TEXT", entry));
    flies::check_model_text(entry, "command line", "--about");
    texts.emplace_back(entry.substr(0, equals), entry.substr(equals + 1));
  }
  return texts;
}

/// The name that the model gets; what its file cannot hold is told before the work.
std::string model_name(const TrainArguments& arguments) {
  const bool is_given = !arguments.name.empty();
  std::string name = is_given ? arguments.name : std::filesystem::path(arguments.out).stem().string();
  flies::check_model_text(name, "command line", is_given ? "--name" : "--out");
  return name;
}

void describe(const std::string& name, const flies::TrainOptions& options, const flies::TrainingData& data,
              const Texts& about, flies::TrainingResult& result) {
  flies::PeopleModel& model = result.model;
  model.name = name;
  model.about = {{"program", "flies train " FLIES_VERSION},
                 {"pictures", fmt::format("{} with people, {} without", data.people.size(), data.background.size())},
                 {"person_share", fmt::format("{:g}", options.positives.person_share)},
                 {"options", changed_options(options)},
                 {"validation", one_line(flies::training_summary(options, result))}};
  model.about.insert(model.about.end(), about.begin(), about.end());
}

std::string command_line(const TrainArguments& arguments) {
  std::string text = "flies train";
  const auto add = [&](const char* name, const std::vector<std::string>& values) {
    for (const auto& value : values) text += fmt::format(" {} {}", name, value);
  };
  add("--positives", arguments.positives);
  add("--negatives", arguments.negatives);
  add("--stereo-negatives", arguments.stereo_negatives);
  text += " --out " + arguments.out;
  for (const auto& [path, value] : arguments.overrides) text += fmt::format(" --{} {}", path, value);
  return text;
}

/// Before the work.
void check_outputs(const TrainArguments& arguments) {
  OutputClaims claims;
  claims.writes(arguments.out, "--out");
  claims.writes(arguments.report, "--report");
  reads_pictures(claims, arguments.positives);
  reads_pictures(claims, arguments.negatives);
  reads_true_pairs(claims, arguments.stereo_negatives);
}

void run_train(const TrainArguments& arguments) {
  const flies::TrainOptions options = options_of(arguments);
  const Texts about = parse_about(arguments.about);
  const std::string name = model_name(arguments);
  check_outputs(arguments);
  // Opened first, so that a place that cannot be written shows before the work.
  flies::OutputFile out(arguments.out);
  std::optional<flies::OutputFile> report;
  if (!arguments.report.empty()) report.emplace(arguments.report);

  // OpenCV's own threads would sum in another order on another machine.
  cv::setNumThreads(1);
  const flies::TrainingData data = find_data(arguments, options);
  flies::Checkpoint checkpoint(arguments.work.empty() ? arguments.out + ".work" : arguments.work,
                               flies::fingerprint_of(data.people, data.background, options));
  std::optional<ProgressLine> progress(std::in_place);
  flies::TrainingResult result = flies::train_people(
      data, options, checkpoint, [&](auto chapter, auto done, auto total) { progress->show(chapter, done, total); });
  progress.reset();

  describe(name, options, data, about, result);
  out.write(flies::people_model_text(result.model));
  if (report)
    report->write(flies::training_report_html(
        data, options, result,
        {command_line(arguments), "flies " FLIES_VERSION ", " FLIES_BUILD_TYPE ", " FLIES_COMPILER}));
  out.commit();
  if (report) report->commit();
  checkpoint.remove();
  if (arguments.out != "-") print(flies::training_summary(options, result) + "model          " + arguments.out + "\n");
}

/// Options of the first level also answer to their name with hyphens, as the program's other options do.
std::string flag_of(const std::string& path) {
  if (path.find('_') == std::string::npos || path.find('.') != std::string::npos) return "--" + path;
  std::string hyphens = path;
  std::replace(hyphens.begin(), hyphens.end(), '_', '-');
  return "--" + hyphens + ",--" + path;
}

void add_training_options(CLI::App& command, TrainArguments& arguments) {
  for (const auto& listing : flies::list_options(flies::TrainOptions{}))
    command
        .add_option_function<std::string>(
            flag_of(listing.path),
            [&arguments, path = listing.path](const std::string& text) {
              arguments.overrides.emplace_back(path, text);
            },
            fmt::format("{}; {}, default {}", listing.meaning, listing.allowed, listing.value))
        ->type_name("N")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group("Training");
}

}  // namespace

void setup_train(CLI::App& app) {
  CLI::App* command = app.add_subcommand("train", "train a people model on your own pictures");
  const auto arguments = std::make_shared<TrainArguments>();
  // For help and completion: `main` has given the command line away where this is in it.
  command->add_flag_callback(
      "--network", [] {}, "train a convolutional network instead, with flies-train-network, which has other options");
  command
      ->add_option("--positives", arguments->positives,
                   "folders of people: crops of one person each, or pictures with Pascal VOC, KITTI, YOLO, COCO or "
                   "INRIA labels")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--negatives", arguments->negatives,
                   "folders of pictures without people, or with all people labelled")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--stereo-negatives", arguments->stereo_negatives,
                   "folders of pairs, as `flies evaluate` reads them: boxes that the flies propose away from people "
                   "become windows without people")
      ->type_name("DIR");
  command->add_option("--out", arguments->out, "model file to write")->required()->type_name("MODEL");
  command
      ->add_option("--crop-person-share", arguments->crop_person_share,
                   "share of a crop's height that the person in its middle fills; default 0.75")
      ->check(in_range(0.1, 1.0))
      ->type_name("X");
  command->add_option("--name", arguments->name, "name of the model; default: that of the file")->type_name("TEXT");
  command
      ->add_option("--about", arguments->about, "texts to write into the model, such as licence and source of the data")
      ->type_name("KEY=TEXT");
  command
      ->add_option("--work", arguments->work,
                   "folder of intermediate results, from which a stopped training continues; default MODEL.work")
      ->type_name("DIR");
  command->add_option("--report", arguments->report, "HTML file with curves, mistakes and weights")->type_name("FILE");
  add_training_options(*command, *arguments);
  command->footer(
      "\nA part of the pictures is kept apart for calibration, threshold and the numbers that are printed.\n"
      "Same pictures, seed and options give the same file. docs/training.md says how it works.\n"
      "\nExample:\n"
      "  flies train --positives data/people/train/positives --negatives data/people/train/negatives --kernel rbf "
      "--out mine.json\n"
      "  flies detect left.png right.png --calib calib.txt --model mine.json\n"
      "  flies train --network --help           the options of a network's training\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_train(*arguments); });
}
