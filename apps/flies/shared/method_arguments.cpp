#include "shared/method_arguments.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

namespace {

std::vector<flies::OptionSetting> settings_of_file(const MethodArguments& arguments) {
  if (arguments.file_settings) return *arguments.file_settings;
  return arguments.options_file.empty() ? std::vector<flies::OptionSetting>{}
                                        : flies::load_options_yaml(arguments.options_file);
}

}  // namespace

void read_options_file(MethodArguments& arguments) { arguments.file_settings = settings_of_file(arguments); }

std::string people_model_of(const MethodArguments& arguments) {
  if (!arguments.model.empty()) return arguments.model;
  for (const auto& setting : settings_of_file(arguments))
    if (setting.path == kPeopleModel) return setting.text;
  return std::string(flies::preset_people_model(flies::preset_named(arguments.preset, "command line")));
}

std::shared_ptr<const flies::PeopleClassifier> classifier_of(const MethodArguments& arguments) {
  return flies::people_classifier(people_model_of(arguments));
}

std::string options_file_text(const flies::DetectorOptions& options, const flies::TrackerOptions& following,
                              const std::string& people_model) {
  return fmt::format("{}: {}  # a name that `flies info` lists or a file (--model)\n", kPeopleModel,
                     nlohmann::json(people_model).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) +
         flies::options_yaml(flies::list_options(options)) + flies::options_yaml(flies::list_options(following));
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

namespace {

/// A preset with what the user sets.
flies::DetectorOptions with_settings(flies::DetectorOptions options, const MethodArguments& arguments) {
  flies::TrackerOptions following;  // those of following are checked, whether or not this run follows
  for (const auto& setting : settings_of_file(arguments)) {
    if (setting.path == kPeopleModel) continue;
    if (flies::is_tracker_option(setting.path))
      flies::set_option(following, setting.path, setting.text, setting.source);
    else
      flies::set_option(options, setting.path, setting.text, setting.source);
  }
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

double nearest_range_m(const flies::DetectorOptions& options) {
  return options.scan.enable ? std::min(options.field.x_min_m, options.scan.x_min_m) : options.field.x_min_m;
}

flies::TrackerOptions following_options(const MethodArguments& arguments, const Overrides& overrides) {
  flies::TrackerOptions options;
  for (const auto& setting : settings_of_file(arguments))
    if (flies::is_tracker_option(setting.path)) flies::set_option(options, setting.path, setting.text, setting.source);
  for (const auto& [path, text] : overrides) flies::set_option(options, path, text, "command line");
  return options;
}

flies::DetectorOptions effective_options(const MethodArguments& arguments) {
  return with_settings(preset_of(arguments), arguments);
}

flies::DetectorOptions effective_options(const MethodArguments& arguments, const flies::StereoCamera& camera) {
  const bool is_as_published = arguments.preset == enum_name(flies::Preset::paper);
  const flies::DetectorOptions preset = preset_of(arguments);
  return with_settings(is_as_published ? preset : flies::fitted_options(camera, preset), arguments);
}

RunCorrections corrections_for(RunCorrections corrections, const MethodArguments& arguments) {
  corrections.options = [arguments](const flies::StereoCamera& camera) { return effective_options(arguments, camera); };
  return corrections;
}

namespace {

using Texts = std::vector<std::pair<std::string, std::string>>;

/// The options of a command line that are not as they are without it. The mount is told as it is used.
Texts input_of(const RunWords& words) {
  Texts input;
  const auto add_numbers = [&](const char* option, const std::vector<int>& numbers) {
    if (!numbers.empty()) input.emplace_back(option, fmt::format("{}", fmt::join(numbers, ",")));
  };
  if (words.pair_by != "auto") input.emplace_back("pair-by", words.pair_by);
  for (const char* split : {"side", "top"})
    if (flies::split_of(split) == words.reading.split) input.emplace_back("split", split);
  for (const char* pattern : {"rggb", "bggr", "grbg", "gbrg"})
    if (words.reading.bayer && flies::bayer_pattern_of(pattern) == words.reading.bayer)
      input.emplace_back("bayer", pattern);
  add_numbers("cameras", words.camera.cameras);
  if (!words.camera.right_calib.empty()) input.emplace_back("right-calib", words.camera.right_calib);
  if (words.camera.is_raw) input.emplace_back("raw", "true");
  if (words.camera.is_resized) input.emplace_back("resized", "true");
  if (words.camera.baseline_m) input.emplace_back("baseline", fmt::format("{}", *words.camera.baseline_m));
  if (words.camera.disparity_shift_px != 0.0)
    input.emplace_back("disparity-shift", fmt::format("{}", words.camera.disparity_shift_px));
  add_numbers("calib-size", words.camera.calibrated_size_px);
  if (const auto mode = words.corrections.self_rectify; mode != SelfRectify::automatic)
    input.emplace_back("self-rectify", mode == SelfRectify::on ? "on" : "off");
  return input;
}

/// Those that the user must say again to have them: neither seed, which is told beside, nor threads, without effect.
Texts options_to_say(const MethodArguments& arguments, const flies::DetectorOptions& used,
                     const flies::StereoCamera& camera) {
  MethodArguments preset_alone;
  preset_alone.preset = arguments.preset;
  const auto of_preset = flies::list_options(effective_options(preset_alone));
  const auto fitted = flies::list_options(effective_options(preset_alone, camera));
  const auto all = flies::list_options(used);
  Texts options;
  for (std::size_t i = 0; i < all.size(); ++i)
    if ((all[i].value != of_preset[i].value || all[i].value != fitted[i].value) && all[i].path != "seed" &&
        all[i].path != "threads")
      options.emplace_back(all[i].path, all[i].value);
  return options;
}

}  // namespace

std::shared_ptr<const flies::RunRecord> run_record(const RunWords& words, const flies::DetectorOptions& options,
                                                   const flies::TrackerOptions& following,
                                                   const flies::StereoCamera& camera, const std::string& calibration,
                                                   const RunDiagnosis& diagnosis) {
  auto run = std::make_shared<flies::RunRecord>();
  run->version = FLIES_VERSION;
  run->calibration = calibration;
  run->camera = camera;
  if (const auto& rows = diagnosis.correction)
    run->row_correction = {.offset_px = rows->offset_px, .roll_rad = rows->slope, .middle_u_px = rows->middle_u_px};
  run->input = input_of(words);
  run->people_model = people_model_of(words.method);
  run->preset = words.method.preset;
  run->options = options_to_say(words.method, options, camera);
  const auto usual = flies::list_options(flies::TrackerOptions{}), used = flies::list_options(following);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i].value != usual[i].value) run->options.emplace_back(used[i].path, used[i].value);
  return run;
}
