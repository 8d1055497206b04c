#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/options.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/io/output_file.hpp"
#include "flies/reproduce/report.hpp"
#include "flies/version.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/cpu_name.hpp"
#include "shared/output_claims.hpp"
#include "shared/progress_bar.hpp"
#include "shared/standard_output.hpp"

namespace {

struct ReproduceArguments {
  std::string out = "report.html";
  std::string json;
  std::string kitti, kitti_object;
  int seeds = 15;
  int scenes = 4;
  std::string seed = "1";
};

std::string command_line(const ReproduceArguments& a) {
  std::string text = fmt::format("flies reproduce --seeds {} --seed {} --scenes {}", a.seeds, a.seed, a.scenes);
  if (!a.kitti.empty()) text += " --kitti " + a.kitti;
  if (!a.kitti_object.empty()) text += " --kitti-object " + a.kitti_object;
  return text;
}

std::vector<flies::FrameSet> load_sets(const ReproduceArguments& arguments, const flies::MatchOptions& match) {
  // Real data first: a fault in a folder shows before the long work.
  std::vector<flies::FrameSet> real;
  if (!arguments.kitti.empty())
    real.push_back({"KITTI drive",
                    "Frames of a KITTI raw drive that show a labelled pedestrian or cyclist 5 to 40 m away.",
                    flies::read_frames_with_people(arguments.kitti, flies::TruthKind::kitti_drive, match)});
  if (!arguments.kitti_object.empty())
    real.push_back({"KITTI object",
                    "Pairs of a KITTI object folder that show a labelled pedestrian or cyclist 5 to 40 m away.",
                    flies::read_frames_with_people(arguments.kitti_object, flies::TruthKind::kitti_object, match)});
  ProgressBar progress(2 * static_cast<std::size_t>(arguments.scenes));
  auto sets = flies::embedded_sets(arguments.scenes, [&](std::size_t done) { progress.show(done); });
  for (auto& set : real) sets.push_back(std::move(set));
  return sets;
}

std::vector<flies::ReportSet> measure(const std::vector<flies::FrameSet>& sets, const flies::PersonOptions& options) {
  std::size_t total = 0, before = 0;
  for (const auto& set : sets) total += flies::count_people(set, options.match);
  ProgressBar progress(total);
  std::vector<flies::ReportSet> measured;
  for (const auto& set : sets) {
    flies::ReportSet part;
    part.title = set.title;
    part.description = set.description;
    for (const auto& frame : set.frames) part.frames.push_back(frame.name);
    part.result = flies::reproduce(set, options, [&](std::size_t done) { progress.show(before + done); });
    part.figures = flies::paper_figures(set, part.result, options);
    before += part.result.people.size();
    measured.push_back(std::move(part));
  }
  return measured;
}

void check_outputs(const ReproduceArguments& arguments) {
  OutputClaims claims;
  claims.writes(arguments.out, "--out");
  claims.writes(arguments.json, "--json");
  for (const auto& folder : {arguments.kitti, arguments.kitti_object}) {
    if (folder.empty()) continue;
    const flies::Dataset dataset = flies::open_dataset(folder);
    claims.reads(dataset.pairs);
    claims.reads(dataset.files);
  }
}

void run_reproduce(const ReproduceArguments& arguments) {
  check_outputs(arguments);
  flies::PersonOptions options;
  flies::set_option(options.method, "seed", arguments.seed, "command line");
  options.first_seed = options.method.seed;
  options.seeds = arguments.seeds;
  // Opened first, so that a place that cannot be written shows before the work.
  flies::OutputFile html(arguments.out);
  std::optional<flies::OutputFile> json;
  if (!arguments.json.empty()) json.emplace(arguments.json);

  const auto measured = measure(load_sets(arguments, options.match), options);
  const flies::ReportContext context{command_line(arguments),
                                     "flies " FLIES_VERSION ", " FLIES_BUILD_TYPE ", " FLIES_COMPILER, cpu_name()};
  html.write(flies::html_report(measured, options, context));
  if (json) json->write(flies::json_report(measured, options, context));
  html.commit();
  if (json) json->commit();
  if (arguments.out != "-" && arguments.json != "-")
    print(flies::text_table(measured) + fmt::format("\nreport: {}\n", arguments.out));
}

}  // namespace

void setup_reproduce(CLI::App& app) {
  CLI::App* command = app.add_subcommand("reproduce", "repeat the paper's experiments and write a report");
  const auto arguments = std::make_shared<ReproduceArguments>();
  command->add_option("--out", arguments->out, "HTML file to write, - for standard output")
      ->type_name("FILE")
      ->capture_default_str();
  command->add_option("--json", arguments->json, "also write the numbers as JSON, - for standard output")
      ->type_name("FILE");
  command->add_option("--kitti", arguments->kitti, "a KITTI raw drive (synced, rectified) with tracklet_labels.xml")
      ->type_name("DIR");
  command->add_option("--kitti-object", arguments->kitti_object, "a KITTI object folder, the one that holds label_2")
      ->type_name("DIR");
  command->add_option("--seeds", arguments->seeds, "runs of each experiment, with seeds that count up")
      ->check(in_range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "seed of the first run")->type_name("N")->capture_default_str();
  command->add_option("--scenes", arguments->scenes, "synthetic pairs of each kind")
      ->check(in_range(1, 100))
      ->type_name("N")
      ->capture_default_str();
  command->footer(
      "\nMakes figures 2 to 5 of Li, Toulminet, Nashashibi 2010 and their numbers beside ours, with the\n"
      "preset paper, from scenes that need no data and from KITTI folders if given. One HTML file holds\n"
      "everything.\n"
      "\nExamples:\n"
      "  flies reproduce\n"
      "  flies reproduce --kitti data/kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --json numbers.json\n"
      "\nExit status: 0 done, 2 an error in the options or a folder, or a file that cannot be written.");
  command->callback([arguments] { run_reproduce(*arguments); });
}
