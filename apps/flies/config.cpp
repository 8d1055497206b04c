#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "flies/classify/named_models.hpp"
#include "flies/classify/people_classifier.hpp"
#include "flies/core/options.hpp"
#include "shared/commands.hpp"
#include "shared/method_arguments.hpp"
#include "shared/standard_output.hpp"

namespace {

struct ConfigArguments {
  MethodArguments method;
  Overrides following;
  bool list = false;
};

/// Name, value, what is allowed and meaning of every option, a line each.
std::string option_table(const std::vector<flies::OptionListing>& listings) {
  std::size_t path_width = 6, value_width = 5, allowed_width = 7;
  for (const auto& listing : listings) {
    path_width = std::max(path_width, listing.path.size());
    value_width = std::max(value_width, listing.value.size());
    allowed_width = std::max(allowed_width, listing.allowed.size());
  }
  std::string table;
  const auto add_line = [&](const auto& path, const auto& value, const auto& allowed, const auto& meaning) {
    table += fmt::format("{:<{}}  {:<{}}  {:<{}}  {}\n", path, path_width, value, value_width, allowed, allowed_width,
                         meaning);
  };
  add_line("option", "value", "allowed", "meaning");
  for (const auto& listing : listings) add_line(listing.path, listing.value, listing.allowed, listing.meaning);
  return table;
}

/// @throws flies::InputError when it is neither the name of a model nor a file that holds one
void check_model(const std::string& name_or_file) {
  const auto names = flies::people_model_names();
  if (std::ranges::find(names, name_or_file) == names.end()) flies::people_classifier(name_or_file);
}

void run_config(const ConfigArguments& arguments) {
  const flies::DetectorOptions options = effective_options(arguments.method);
  const flies::TrackerOptions following = following_options(arguments.method, arguments.following);
  const std::string people_model = people_model_of(arguments.method);
  check_model(people_model);
  if (!arguments.list) return print(options_file_text(options, following, people_model));
  auto listings = flies::list_options(options);
  for (auto& listing : flies::list_options(following)) listings.push_back(std::move(listing));
  print(option_table(listings));
}

}  // namespace

void setup_config(CLI::App& app) {
  CLI::App* command = app.add_subcommand("config", "print the effective options of the method");
  const auto arguments = std::make_shared<ConfigArguments>();
  command->add_flag("--list", arguments->list, "a table of every option: value, what is allowed, meaning");
  add_method_options(*command, arguments->method);
  add_listed_options<flies::TrackerOptions>(*command, "", "", arguments->following);
  command->footer(
      "\nThe options are those of the preset; --options FILE overrides them, and options on the command line,\n"
      "such as --evolve.flies 3000, override both. The YAML that is printed can be given to --options. Commands\n"
      "that do not follow things from pair to pair ignore its options ego.* and track.*.\n"
      "\nExample:\n"
      "  flies config --preset paper --evolve.generations 2 > mine.yaml\n"
      "  flies detect left.png right.png --calib calib.txt --options mine.yaml\n"
      "\nExit status: 0 done, 2 an unknown option, a value that is not allowed or no such model.");
  command->callback([arguments] { run_config(*arguments); });
}
