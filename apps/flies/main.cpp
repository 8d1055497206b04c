#include <fmt/format.h>

#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/name_hint.hpp"
#include "flies/core/options.hpp"
#include "flies/version.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/exit_status.hpp"
#include "shared/notes.hpp"
#include "shared/standard_output.hpp"

namespace {

/// Keeps an error on one line, whatever a file name or a library's message holds.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

int complain(const std::string& message, int status) {
  std::fprintf(stderr, "flies: %s\n", one_line(message).c_str());
  return status;
}

/// The subcommand that was being read, for the hint where help is found.
std::string help_command(const CLI::App& app) {
  const auto subcommands = app.get_subcommands();
  return subcommands.empty() ? "flies --help" : "flies " + subcommands.front()->get_name() + " --help";
}

/// What was not understood, with the nearest name when it looks like a misspelt option.
std::string unexpected_argument(const CLI::App& app) {
  const auto extras = app.remaining(true);
  const auto subcommands = app.get_subcommands();
  for (const auto& extra : extras) {
    if (!extra.starts_with("--")) continue;
    std::vector<std::string> known;
    for (const auto* option : (subcommands.empty() ? app : *subcommands.front()).get_options())
      for (const auto& name : option->get_lnames()) known.push_back(name);
    const std::string nearest = flies::nearest_name(extra.substr(2), known);
    return fmt::format("unknown option {}{}", extra, nearest.empty() ? "" : "; did you mean --" + nearest + "?");
  }
  if (extras.empty() || !subcommands.empty())
    return fmt::format("unexpected argument '{}'", extras.empty() ? "" : extras.front());
  std::vector<std::string> commands;
  for (const auto* command : app.get_subcommands({})) commands.push_back(command->get_name());
  return fmt::format("unknown command '{}'{}", extras.front(), flies::did_you_mean(extras.front(), commands, ""));
}

/// Of an option that has too few values, or too many.
/// @param complaint of CLI11, which starts with the option's name and a colon
std::string wrong_count(const CLI::App& app, const std::string& complaint, int argc, const char* const* argv) {
  const std::string name = complaint.substr(0, complaint.find(':'));
  const auto subcommands = app.get_subcommands();
  const auto* option = (subcommands.empty() ? app : *subcommands.front()).get_option_no_throw(name);
  if (option != nullptr && times_given(*option, argc, argv) > 1)
    return fmt::format("{}: is given twice, expected once at most", name);
  return fmt::format("{}: expects a value {}", name, option == nullptr ? "" : option->get_type_name());
}

void setup(CLI::App& app) {
  app.name("flies");
  app.description(
      "Finds obstacles and pedestrians in a rectified stereo pair by the flies method\n"
      "(Li, Toulminet, Nashashibi 2010). Positions are metres in the vehicle frame:\n"
      "x forward, y left, z up, origin on the ground below the left camera.");
  app.footer(
      "\nExamples:\n"
      "  flies synth street                     render a street with known truth\n"
      "  flies detect left.png right.png --calib calib.txt --overlay found.png\n"
      "  flies live 0 --calib calib.txt --view  what a camera sees, on a page to watch\n"
      "  flies calib calib.txt                  what a calibration file says\n"
      "  flies evaluate street                  measure what is found against that truth\n"
      "  flies config --list                    every option of the method\n"
      "\nExit status: 0 done, also when nothing was found, and for this help; 2 an error in the\n"
      "input or the command line, reported in one line; 1 an error of the program itself.");
  app.set_version_flag("-V,--version", "flies " FLIES_VERSION);
  app.require_subcommand(0, 1);
  setup_detect(app);
  setup_track(app);
  setup_live(app);
  setup_check(app);
  setup_calib(app);
  setup_calibrate(app);
#ifdef FLIES_HAS_SYNTH
  setup_synth(app);
#endif
  setup_evaluate(app);
  setup_evaluate_classifier(app);
#ifdef FLIES_HAS_TRAINER
  setup_train(app);
#endif
#ifdef FLIES_HAS_SYNTH
  setup_reproduce(app);
  setup_bench(app);
#endif
  setup_config(app);
  setup_info(app);
  setup_completion(app);
  constexpr std::array<std::string_view, 10> kTalking = {"detect",    "track",    "live",     "check",
                                                         "calibrate", "synth",    "evaluate", "evaluate-classifier",
                                                         "train",     "reproduce"};
  for (CLI::App* command : app.get_subcommands({}))
    if (std::ranges::find(kTalking, command->get_name()) != kTalking.end()) add_verbosity_options(*command);
  wrap_help(app);
  check_values(app);
}

int run(int argc, char** argv) {
  CLI::App app;
  setup(app);
  refuse_empty_assignments(argc, argv);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) print(app.help());
    flush_standard_output();
    return kExitSuccess;
  } catch (const CLI::Success& request) {  // --help or --version
    app.exit(request);
    flush_standard_output();
    return kExitSuccess;
  } catch (const CLI::ExtrasError&) {
    return complain("command line: " + unexpected_argument(app) + "; try '" + help_command(app) + "'", kExitInputFault);
  } catch (const CLI::ArgumentMismatch& error) {
    return complain("command line: " + wrong_count(app, error.what(), argc, argv) + "; try '" + help_command(app) + "'",
                    kExitInputFault);
  } catch (const CLI::ParseError& error) {
    return complain("command line: " + std::string(error.what()) + "; try '" + help_command(app) + "'",
                    kExitInputFault);
  }
}

/// Pictures are large and come again and again. By default the memory of each goes back to the system, and every page
/// of the next one is fetched and cleared anew, which takes longer than to read the picture.
void keep_memory_of_pictures() {
#ifdef __GLIBC__
  constexpr int kBytes = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kBytes / 8);  // 32 MB is the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, kBytes);
#endif
}

}  // namespace

int main(int argc, char** argv) {
#ifdef SIGXFSZ
  // A file size limit then fails the write, which is reported, instead of killing the process.
  std::signal(SIGXFSZ, SIG_IGN);
#endif
  keep_memory_of_pictures();
  try {
#ifdef FLIES_HAS_TRAINER
    if (is_network_training(argc, argv)) become_network_trainer(argc, argv);
#endif
    end_cleanly_on_signals();
    return run(argc, argv);
  } catch (const flies::InputError& error) {
    return complain(error.what(), kExitInputFault);
  } catch (const std::exception& error) {
    return complain(std::string("internal error: ") + error.what(), kExitInternalFault);
  }
}
