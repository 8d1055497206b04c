#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/bench_measure.hpp"
#include "flies/core/error.hpp"
#include "flies/fitness/fitness.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/output_file.hpp"
#include "flies/synth/render.hpp"
#include "flies/synth/scene_options.hpp"
#include "flies/version.hpp"
#include "shared/camera_arguments.hpp"
#include "shared/command_line.hpp"
#include "shared/commands.hpp"
#include "shared/cpu_name.hpp"
#include "shared/output_claims.hpp"
#include "shared/standard_output.hpp"

namespace {

struct BenchArguments {
  std::string left, right, calib, json;
  CameraArguments camera;
  std::vector<const CLI::Option*> of_the_pair;  ///< options that only images have
  bool only_flies = false;
  BenchPlan plan;
};

/// The pair to measure on, and who keeps its pixels.
struct BenchInput {
  std::string name;
  flies::GrayPair files;
  std::optional<flies::RenderedPair> rendered;
  flies::StereoCamera camera;

  flies::RectifiedPair pair() const { return rendered ? rendered->gray_pair() : files.view(); }
};

BenchInput synthetic_input() {
  const flies::SceneOptions scene;
  return {.name = "synthetic street",
          .files = {},
          .rendered = flies::render_pair(scene),
          .camera = flies::synthetic_camera(scene)};
}

BenchInput input_from_files(const BenchArguments& arguments) {
  BenchInput input{.name = arguments.left,
                   .files = flies::load_pair(arguments.left, arguments.right),
                   .rendered = std::nullopt,
                   .camera = {}};
  const auto request = calibration_request(arguments.camera, arguments.left, arguments.right, input.files.view());
  const auto calibration = flies::load_calibration(arguments.calib, request);
  if (calibration.rectifier) input.files = calibration.rectifier->rectify(input.files);
  input.camera = calibration.camera;
  flies::check_camera_fits(input.camera, input.files.left.width_px, input.files.left.height_px, arguments.calib);
  input.camera.width_px = input.files.left.width_px;
  input.camera.height_px = input.files.left.height_px;
  return input;
}

BenchInput bench_input(const BenchArguments& arguments) {
  const auto complain = [](const char* field, const char* complaint) {
    throw flies::InputError("command line", field, complaint);
  };
  if (arguments.left.empty()) {
    for (const auto* option : arguments.of_the_pair)
      if (option->count() > 0) complain(option->get_name().c_str(), "belongs to a LEFT and RIGHT image, found none");
    return synthetic_input();
  }
  if (arguments.right.empty()) complain("RIGHT", "missing, expected the right image");
  if (arguments.calib.empty()) complain("--calib", "missing, expected the calibration of the pair");
  return input_from_files(arguments);
}

nlohmann::ordered_json json_of(const Times& times) {
  return {{"median", times.median_ms}, {"quartiles", {times.first_quartile_ms, times.third_quartile_ms}}};
}

nlohmann::ordered_json json_of(const GrowthTimes& growth) {
  return {{"flies", growth.flies},
          {"width_px", growth.width_px},
          {"height_px", growth.height_px},
          {"evolve_and_concentrate_ms", json_of(growth.work)}};
}

std::string json_text(const BenchResult& result, const BenchInput& input, int runs) {
  const auto image = input.pair().left;
  nlohmann::ordered_json json = {{"version", FLIES_VERSION},
                                 {"cpu", cpu_name()},
                                 {"cpu_threads", std::thread::hardware_concurrency()},
                                 {"kernel", flies::kernel_target_name()},
                                 {"pair", input.name},
                                 {"width_px", image.width_px},
                                 {"height_px", image.height_px},
                                 {"runs", runs},
                                 {"frames", nlohmann::json::array()},
                                 {"others", nlohmann::json::array()},
                                 {"by_flies", nlohmann::json::array()},
                                 {"by_pixels", nlohmann::json::array()}};
  for (const auto& frame : result.frames) {
    nlohmann::ordered_json stages;
    for (std::size_t i = 0; i < flies::kStageCount; ++i)
      stages[std::string(flies::kStageNames[i])] = json_of(frame.stages[i]);
    json["frames"].push_back({{"preset", frame.preset},
                              {"threads", frame.threads},
                              {"evaluations", frame.evaluations},
                              {"frame_ms", json_of(frame.frame)},
                              {"evolve_and_concentrate_ms", json_of(frame.work)},
                              {"stage_ms", stages}});
  }
  for (const auto& other : result.others)
    json["others"].push_back({{"name", other.name}, {"frame_ms", json_of(other.frame)}});
  for (const auto& growth : result.by_flies) json["by_flies"].push_back(json_of(growth));
  for (const auto& growth : result.by_pixels) json["by_pixels"].push_back(json_of(growth));
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string row(const std::string& name, const Times& times) {
  return fmt::format("{:<34}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, times.median_ms, times.first_quartile_ms,
                     times.third_quartile_ms);
}

std::string table(const BenchResult& result, const BenchInput& input, int runs) {
  const auto image = input.pair().left;
  std::string text = fmt::format("{}, {} x {} px, {} runs in turns; {}, fitness kernel {}\n", input.name,
                                 image.width_px, image.height_px, runs, cpu_name(), flies::kernel_target_name());
  text += fmt::format("{:<34}{:>10}{:>10}{:>10}\n", "milliseconds", "median", "quartile", "quartile");
  for (const auto& frame : result.frames) {
    text += fmt::format("{}, {} thread{}, {} evaluations\n", frame.preset, frame.threads, frame.threads == 1 ? "" : "s",
                        frame.evaluations);
    for (std::size_t i = 0; i < flies::kStageCount; ++i)
      text += row(fmt::format("  {}", flies::kStageNames[i]), frame.stages[i]);
    text += row("  evolve and concentrate", frame.work) + row("  whole frame", frame.frame);
  }
  if (!result.others.empty()) text += "OpenCV, one thread, matching 128 disparities\n";
  for (const auto& other : result.others) text += row("  " + other.name, other.frame);
  if (!result.by_flies.empty()) text += "evolve and concentrate, default, one thread\n";
  for (const auto& growth : result.by_flies) text += row(fmt::format("  {} flies", growth.flies), growth.work);
  for (const auto& growth : result.by_pixels)
    text += row(fmt::format("  {} x {} px", growth.width_px, growth.height_px), growth.work);
  return text;
}

void check_output(const BenchArguments& arguments) {
  OutputClaims claims;
  claims.reads(arguments.left);
  claims.reads(arguments.right);
  claims.reads_calibration(arguments.calib, arguments.camera.right_calib);
  claims.writes(arguments.json, "--json");
}

void run_bench_command(BenchArguments arguments) {
  arguments.plan.has_others = arguments.plan.has_growth = !arguments.only_flies;
  check_output(arguments);
  const BenchInput input = bench_input(arguments);
  std::optional<flies::OutputFile> json;
  if (!arguments.json.empty()) json.emplace(arguments.json);
  const BenchResult result = run_bench(input.pair(), input.camera, arguments.plan);
  if (!json) return print(table(result, input, arguments.plan.runs));
  json->write(json_text(result, input, arguments.plan.runs));
  json->commit();
}

}  // namespace

void setup_bench(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bench", "measure how long everything takes, compared with OpenCV's dense matching");
  const auto arguments = std::make_shared<BenchArguments>();
  command->add_option("LEFT", arguments->left, "left image; without images a synthetic street is rendered");
  command->add_option("RIGHT", arguments->right, "right image");
  command->add_option("--calib", arguments->calib, "calibration of the pair; see `flies calib --help`")
      ->type_name("FILE");
  add_cameras_option(
      *command, arguments->camera,
      "left and right camera of a KITTI calibration, e.g. 0,1; default: those in the image paths, or else 2,3");
  add_calibration_options(*command, arguments->camera);
  add_mount_options(*command, arguments->camera);
  for (const CLI::Option* option : command->get_options([](const CLI::Option* one) { return one->nonpositional(); }))
    arguments->of_the_pair.push_back(option);
  command->add_option("--runs", arguments->plan.runs, "number of runs of everything, in turns; medians are printed")
      ->check(in_range(1, 1000))
      ->capture_default_str();
  command->add_flag("--only-flies", arguments->only_flies,
                    "measure neither OpenCV nor larger populations: takes seconds instead of a minute");
  command->add_option("--json", arguments->json, "write JSON instead of the table; - is standard output")
      ->type_name("FILE");
  command->footer(
      "\nMeasures the presets default and paper on one and two threads, stage by stage and as a whole; OpenCV's\n"
      "StereoBM, SGBM and SGBM 3-way at 128 disparities and its HOG people detector over the whole image, on\n"
      "one thread each; and evolving and concentrating with 3000, 30000 and 300000 flies, and on the same pair\n"
      "with four times the pixels. Images are in memory, and the detectors have processed some pairs before.\n"
      "All contestants run in turns, detectors five pairs in a row. Prints the median and the quartiles, in\n"
      "milliseconds.\n"
      "\nExamples:\n"
      "  flies bench\n"
      "  flies bench left.png right.png --calib calib.txt --runs 31 --json times.json\n"
      "\nExit status: 0 done; 2 an error in the input or the command line, reported in one line.");
  command->callback([arguments] { run_bench_command(*arguments); });
}
