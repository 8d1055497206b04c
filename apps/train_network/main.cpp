// flies-train-network: trains the network of convolutions that has the last word in a people model. The only program
// that needs libtorch; `flies train --network` starts it.
#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"
#include "shared/command_line.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/exit_status.hpp"
#include "shared/notes.hpp"
#include "shared/output_claims.hpp"
#include "shared/standard_output.hpp"
#include "shared/training_inputs.hpp"
#include "training.hpp"

namespace {

using Overrides = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kCommand = "flies train --network";

int complain(std::string message, int status) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  fmt::print(stderr, "flies: {}\n", message);
  return status;
}

template <class Options>
void add_options(CLI::App& app, Overrides& overrides) {
  for (const auto& listing : flies::list_options(Options{})) {
    std::string hyphens = listing.path;
    std::replace(hyphens.begin(), hyphens.end(), '_', '-');
    app.add_option_function<std::string>(
           "--" + hyphens,
           [&overrides, path = listing.path](const std::string& text) { overrides.emplace_back(path, text); },
           fmt::format("{}; {}, default {}", listing.meaning, listing.allowed, listing.value))
        ->type_name("N")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group("Training");
  }
}

template <class Options>
Options options_of(const Overrides& overrides) {
  Options options;
  for (const auto& [path, text] : overrides) flies::set_option(options, path, text, "command line");
  return options;
}

void setup(CLI::App& app, flies::NetworkArguments& arguments, Overrides& learning, Overrides& judging) {
  app.name(kCommand);
  app.description(
      "Trains the network of convolutions that has the last word in a people model, behind a linear machine, or the "
      "smaller one that looks before the linear machine does.");
  app.add_option("--people", arguments.folders.people,
                 "folder with `train` (crops of people, pictures without) and `pictures` (labelled streets)")
      ->type_name("DIR");
  app.add_option("--stereo", arguments.folders.stereo,
                 "folders of pairs with truth, as `flies evaluate` reads them: their people in full view, and boxes "
                 "that the flies propose away from people as windows without people")
      ->type_name("DIR");
  app.add_option("--out", arguments.out, "model file to write")->required()->type_name("MODEL");
  app.add_option("--name", arguments.name, "name of the model; default: that of the file")->type_name("TEXT");
  app.add_option("--work", arguments.work,
                 "folder of intermediate results, from which a stopped training continues; default MODEL.work")
      ->type_name("DIR");
  app.add_option("--report", arguments.report, "HTML file with curves, mistakes and epochs")->type_name("FILE");
  app.add_flag("--first-look", arguments.is_first_look,
               "train the network in front of the linear machine of --first; the model has these two and nothing else");
  app.add_option("--first", arguments.first,
                 "model whose linear machine, with the network in front of it if there is one, looks first; default "
                 "flies-48x96-linear")
      ->type_name("MODEL");
  app.add_flag_callback(
      "--all", [&] { arguments.folders.keep_apart = false; },
      "learn from all pictures, keep none apart; needs --calibration-of or --first-look");
  app.add_option("--calibration-of", arguments.calibration_of, "model whose calibration and threshold are used")
      ->type_name("MODEL");
  app.add_option("--network-of", arguments.network_of,
                 "no training: this model's network behind the first look of --first, calibrated and judged on what is "
                 "kept apart of --people, or without --people with the calibration of --calibration-of")
      ->type_name("MODEL");
  add_options<flies::LearningOptions>(app, learning);
  add_options<flies::JudgingOptions>(app, judging);
  add_verbosity_options(app);
  wrap_help(app);
  check_values(app);
  app.footer(
      "\nA part of the pictures, of other scenes, is kept apart for calibration, threshold and the numbers that are\n"
      "printed. Same pictures, seed and options give the same file. docs/training.md tells how it works.\n"
      "\nExample:\n"
      "  flies train --network --people people --out net.json --report net.html\n"
      "\nExit status: 0 done, 2 an error in the input, reported in one line.");
}

/// @throws InputError when options do not go together
void check(const flies::NetworkArguments& arguments) {
  const auto refuse = [](const char* option, const std::string& complaint) {
    throw flies::InputError("command line", option, complaint);
  };
  const bool has_pictures = !arguments.folders.people.empty(), learns = arguments.network_of.empty();
  if (!has_pictures && learns) refuse("--people", "missing, expected a folder of pictures, or --network-of");
  if (!has_pictures && arguments.calibration_of.empty())
    refuse("--network-of", "expected --people or --calibration-of with it: something has to give the calibration");
  if (!has_pictures && !arguments.folders.stereo.empty()) refuse("--stereo", "expected --people with it");
  if (!arguments.folders.keep_apart && !learns) refuse("--all", "nothing is learnt with --network-of");
  if (arguments.is_first_look && !learns) refuse("--first-look", "nothing is learnt with --network-of");
  if (arguments.is_first_look && !arguments.calibration_of.empty())
    refuse("--first-look", "expected no --calibration-of with it: that network only rejects");
  if (!arguments.folders.keep_apart && arguments.calibration_of.empty() && !arguments.is_first_look)
    refuse("--all", "keeps nothing apart to calibrate by, expected --calibration-of with it");
  if (!arguments.report.empty() && (!has_pictures || !arguments.folders.keep_apart))
    refuse("--report", "needs pictures kept apart, expected --people and no --all");
  OutputClaims claims;
  for (const auto& model : {arguments.first, arguments.calibration_of, arguments.network_of}) claims.reads(model);
  claims.writes(arguments.out, "--out");
  claims.writes(arguments.report, "--report");
  reads_pictures(claims, {arguments.folders.people});
  reads_true_pairs(claims, arguments.folders.stereo);
}

std::string unexpected(const CLI::App& app) {
  const auto extras = app.remaining(true);
  if (extras.empty() || !extras.front().starts_with("--"))
    return fmt::format("unexpected argument '{}'", extras.empty() ? "" : extras.front());
  std::vector<std::string> known;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) known.push_back(name);
  const std::string nearest = flies::nearest_name(extras.front().substr(2), known);
  return fmt::format("unknown option {}{}", extras.front(), nearest.empty() ? "" : "; did you mean --" + nearest + "?");
}

int run(int argc, char** argv) {
  flies::NetworkArguments arguments;
  Overrides learning, judging;
  CLI::App app;
  setup(app, arguments, learning, judging);
  refuse_empty_assignments(argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help
    app.exit(request);
    flush_standard_output();
    return kExitSuccess;
  } catch (const CLI::ExtrasError&) {
    return complain(fmt::format("command line: {}; try '{} --help'", unexpected(app), kCommand), kExitInputFault);
  } catch (const CLI::ParseError& error) {
    return complain(fmt::format("command line: {}; try '{} --help'", error.what(), kCommand), kExitInputFault);
  }
  arguments.learning = options_of<flies::LearningOptions>(learning);
  arguments.judging = options_of<flies::JudgingOptions>(judging);
  if (arguments.work.empty()) arguments.work = arguments.out + ".work";
  arguments.command = kCommand;
  for (int i = 1; i < argc; ++i) arguments.command += fmt::format(" {}", argv[i]);
  check(arguments);
  torch::set_num_threads(1);
  flies::train_network(arguments);
  flush_standard_output();
  return kExitSuccess;
}

}  // namespace

int main(int argc, char** argv) {
  // Large buffers come and go by the thousand: to give them back each time takes as long as to learn.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then fails the write, which is reported
  end_cleanly_on_signals();
  try {
    return run(argc, argv);
  } catch (const flies::InputError& error) {
    return complain(error.what(), kExitInputFault);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kExitInternalFault);
  }
}
