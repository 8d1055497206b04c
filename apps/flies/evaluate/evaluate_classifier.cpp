#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluate/classifier_report.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "flies/eval/window_data.hpp"
#include "flies/io/output_file.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/listed_options.hpp"
#include "shared/named_output.hpp"
#include "shared/output_claims.hpp"
#include "shared/progress_bar.hpp"
#include "shared/standard_output.hpp"

namespace {

constexpr std::array kFalsePositives = {1e-4, 1e-3, 1e-2};

struct ClassifierArguments {
  std::vector<std::string> models;
  std::string data;
  Overrides sampling, estimate;  ///< name and text
  int threads = 1;
  std::string json, html, plot;
};

/// Scores in log-odds, where the surest windows stay apart that as probabilities are all about 1. Adds the time it
/// takes to `ms`.
flies::WindowClassifier timed_classifier(std::shared_ptr<const flies::PeopleClassifier> classifier, double& ms) {
  return [classifier, &ms](const flies::GrayView& image, std::span<const flies::ImageBox> windows) {
    const auto start = std::chrono::steady_clock::now();
    auto scores = classifier->classify(image, windows);
    ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    for (double& score : scores) {
      if (!(score >= 0.0 && score <= 1.0))
        throw flies::InputError(classifier->name(), "probability", fmt::format("found {}, expected 0 to 1", score));
      score = std::log(score / (1.0 - score));
    }
    return scores;
  };
}

std::string command_line(const ClassifierArguments& arguments) {
  std::string text = "flies evaluate-classifier";
  for (const auto& model : arguments.models) text += " " + model;
  text += " --data " + arguments.data;
  for (const auto& [name, value] : arguments.sampling) text += fmt::format(" --{} {}", name, value);
  for (const auto& [name, value] : arguments.estimate) text += fmt::format(" --estimate.{} {}", name, value);
  return text;
}

std::optional<flies::OutputFile> output(const std::string& path) {
  std::optional<flies::OutputFile> file;
  if (!path.empty()) file.emplace(path);
  return file;
}

OutputClaims check_outputs(const ClassifierArguments& arguments) {
  OutputClaims claims;
  for (const auto& model : arguments.models) claims.reads_model(model);
  claims.writes(arguments.json, "--json");
  claims.writes(arguments.html, "--html");
  require_named_output(arguments.plot, "--plot", ".png");
  claims.writes(arguments.plot, "--plot");
  return claims;
}

void run_evaluate_classifier(const ClassifierArguments& arguments) {
  OutputClaims claims = check_outputs(arguments);
  ClassifierContext context{arguments.data, command_line(arguments),
                            with_overrides<flies::WindowSampling>(arguments.sampling),
                            with_overrides<flies::EstimateOptions>(arguments.estimate)};
  std::vector<ClassifierResult> results;
  std::vector<std::shared_ptr<const flies::PeopleClassifier>> models;
  for (const auto& name : arguments.models) {
    models.push_back(flies::people_classifier(name));
    results.push_back({name, {}, {}, {}, 0.0});
  }
  const flies::WindowData data = flies::open_window_data(arguments.data);
  for (const auto& set : data.positives) claims.reads(set.files);
  claims.reads(data.negatives);
  // Opened first, so that a place that cannot be written shows before the work.
  auto json = output(arguments.json), html = output(arguments.html);

  std::vector<double> times_ms(models.size(), 0.0);
  std::vector<flies::WindowClassifier> classifiers;
  for (std::size_t i = 0; i < models.size(); ++i) classifiers.push_back(timed_classifier(models[i], times_ms[i]));
  std::optional<ProgressBar> progress(std::in_place, flies::count_pictures(data), "pictures");
  tbb::task_arena arena(arguments.threads == 0 ? tbb::task_arena::automatic : arguments.threads);
  auto scores = arena.execute([&] {
    return flies::score_windows(data, classifiers, context.sampling, [&](std::size_t done) { progress->show(done); });
  });
  progress.reset();

  for (std::size_t i = 0; i < results.size(); ++i) {
    std::size_t windows = 0;
    for (const auto& set : scores[i].positives) windows += set.scores.size();
    for (const auto& picture : scores[i].negatives) windows += picture.size();
    results[i].us_per_window = 1000.0 * times_ms[i] / static_cast<double>(windows);
    results[i].rates = flies::detection_rates(scores[i], kFalsePositives, context.estimate);
    results[i].reliability = flies::reliability(scores[i]);
    results[i].scores = std::move(scores[i]);
  }
  if (json) json->write(classifier_json(results, context));
  if (html) html->write(classifier_html(results, context));
  if (!arguments.plot.empty()) flies::write_png(arguments.plot, classifier_curves(results));
  if (json) json->commit();
  if (html) html->commit();
  if (arguments.json != "-" && arguments.html != "-") print(classifier_table(results, context));
}

}  // namespace

void setup_evaluate_classifier(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate-classifier", "compare people models on image windows");
  const auto arguments = std::make_shared<ClassifierArguments>();
  command->add_option("MODEL", arguments->models, "people models: names that `flies info` lists, files or networks")
      ->required()
      ->type_name("NAME|FILE");
  command
      ->add_option("--data", arguments->data,
                   "folder with positives (pictures of one window each; sub-folders are sets) and negatives (pictures "
                   "without people)")
      ->required()
      ->type_name("DIR");
  command->add_option("--threads", arguments->threads, "worker threads, 0 for one per core; default 1")
      ->check(in_range(0, 256))
      ->type_name("N");
  add_listed_options<flies::WindowSampling>(*command, "", "Measuring", arguments->sampling);
  add_listed_options<flies::EstimateOptions>(*command, "estimate.", "Measuring", arguments->estimate);
  command->add_option("--json", arguments->json, "all numbers as JSON; - is standard output, without the table")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--html", arguments->html, "table, DET and reliability curves and score histograms as one page")
      ->type_name("FILE")
      ->group("Output");
  command->add_option("--plot", arguments->plot, "the DET curves as PNG")->type_name("FILE")->group("Output");
  command->footer(
      "\nA window with a person is twice as high as wide, and the person in its middle fills 3/4 of its height:\n"
      "96 px of 64 x 128. Windows without people are drawn at random from the pictures without people, the same\n"
      "for every model. All are scaled to the model's size. docs/evaluation.md describes the measures and the JSON.\n"
      "\nExample:\n"
      "  flies evaluate-classifier opencv-48x96 mine.json --data data/people/test --html models.html\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
  command->callback([arguments] { run_evaluate_classifier(*arguments); });
}
