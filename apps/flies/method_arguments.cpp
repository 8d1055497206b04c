#include "method_arguments.hpp"

#include "flies/core/options.hpp"
#include "flies/io/options_yaml.hpp"

void add_method_options(CLI::App& app, MethodArguments& arguments) {
  constexpr const char* kGroup = "Method";
  app.add_option("--preset", arguments.preset, "named set of options: default (works best) or paper (as published)")
      ->type_name("NAME")
      ->group(kGroup);
  app.add_option("--options", arguments.options_file, "YAML file of options, as `flies config` prints them")
      ->type_name("FILE")
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

flies::DetectorOptions effective_options(const MethodArguments& arguments) {
  const auto preset = static_cast<flies::Preset>(
      flies::detail::parse_name(arguments.preset, flies::EnumNames<flies::Preset>::names, "--preset", "command line"));
  flies::DetectorOptions options = flies::preset_options(preset);
  if (!arguments.options_file.empty())
    for (const auto& setting : flies::load_options_yaml(arguments.options_file))
      flies::set_option(options, setting.path, setting.text, setting.source);
  for (const auto& [path, text] : arguments.overrides) flies::set_option(options, path, text, "command line");
  flies::check_detector_options(options, "options");
  return options;
}
