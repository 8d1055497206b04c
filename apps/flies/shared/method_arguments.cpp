#include "shared/method_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "flies/core/options.hpp"
#include "flies/io/options_yaml.hpp"
#include "flies/version.hpp"

namespace {
constexpr const char* kPeopleModel = "people_model";  // in files of options; the method's own are numbers and words
}

void add_method_options(CLI::App& app, MethodArguments& arguments) {
  constexpr const char* kGroup = "Method";
  app.add_option("--preset", arguments.preset,
                 "named set of options: default (roads), robot, handheld or paper (as published)")
      ->type_name("NAME")
      ->group(kGroup);
  app.add_option("--options", arguments.options_file, "YAML file of options, as `flies config` prints them")
      ->type_name("FILE")
      ->group(kGroup);
  app.add_option("--model", arguments.model, "people model: a name that `flies info` lists, a model file or a network")
      ->type_name("NAME|FILE")
      ->group(kGroup);
  for (const auto& listing : flies::list_options(flies::DetectorOptions{})) {
    const bool is_shown = listing.path == "seed" || listing.path == "threads";
    app.add_option_function<std::string>(
           "--" + listing.path,
           [&arguments, path = listing.path](const std::string& text) { arguments.overrides.emplace_back(path, text); },
           listing.meaning)
        ->type_name("N")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->group(is_shown ? kGroup : "");
  }
}

std::string people_model_of(const MethodArguments& arguments) {
  if (!arguments.model.empty()) return arguments.model;
  if (!arguments.options_file.empty())
    for (const auto& setting : flies::load_options_yaml(arguments.options_file))
      if (setting.path == kPeopleModel) return setting.text;
  return std::string(flies::preset_people_model(flies::preset_named(arguments.preset, "command line")));
}

std::shared_ptr<const flies::PeopleClassifier> classifier_of(const MethodArguments& arguments) {
  return flies::people_classifier(people_model_of(arguments));
}

std::string options_file_text(const flies::DetectorOptions& options, const std::string& people_model) {
  return fmt::format("{}: {}  # a name that `flies info` lists or a file (--model)\n", kPeopleModel,
                     nlohmann::json(people_model).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) +
         flies::options_yaml(flies::list_options(options));
}

std::string preset_name(const flies::DetectorOptions& options) {
  for (const auto name : flies::EnumNames<flies::Preset>::names) {
    auto preset = flies::preset_options(flies::preset_named(name, "preset"));
    preset.seed = options.seed;
    preset.threads = options.threads;
    const auto same = [](const auto& a, const auto& b) { return a.value == b.value; };
    if (std::ranges::equal(flies::list_options(preset), flies::list_options(options), same)) return std::string(name);
  }
  return "custom";
}

std::shared_ptr<const flies::RunRecord> run_record(const MethodArguments& arguments,
                                                   const flies::DetectorOptions& options,
                                                   const flies::StereoCamera& camera, const std::string& calibration) {
  const flies::Preset preset = flies::preset_named(arguments.preset, "command line");
  auto run = std::make_shared<flies::RunRecord>();
  run->version = FLIES_VERSION;
  run->calibration = calibration;
  run->camera = camera;
  run->people_model = people_model_of(arguments);
  run->preset = arguments.preset;
  const auto unchanged = flies::list_options(flies::preset_options(preset)), used = flies::list_options(options);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i].value != unchanged[i].value && used[i].path != "seed" &&
        used[i].path != "threads")  // told beside; no effect
      run->options.emplace_back(used[i].path, used[i].value);
  return run;
}

namespace {

/// A preset with what the user sets.
flies::DetectorOptions with_settings(flies::DetectorOptions options, const MethodArguments& arguments) {
  if (!arguments.options_file.empty())
    for (const auto& setting : flies::load_options_yaml(arguments.options_file))
      if (setting.path != kPeopleModel) flies::set_option(options, setting.path, setting.text, setting.source);
  for (const auto& [path, text] : arguments.overrides) flies::set_option(options, path, text, "command line");
  flies::check_detector_options(options, "options");
  return options;
}

flies::DetectorOptions preset_of(const MethodArguments& arguments) {
  flies::DetectorOptions options = flies::preset_options(flies::preset_named(arguments.preset, "command line"));
  options.threads = arguments.threads;
  return options;
}

}  // namespace

flies::DetectorOptions effective_options(const MethodArguments& arguments) {
  return with_settings(preset_of(arguments), arguments);
}

flies::DetectorOptions effective_options(const MethodArguments& arguments, const flies::StereoCamera& camera) {
  const bool is_as_published = arguments.preset == enum_name(flies::Preset::paper);
  const flies::DetectorOptions preset = preset_of(arguments);
  return with_settings(is_as_published ? preset : flies::fitted_options(camera, preset), arguments);
}
