// 03: your own settings. Starts from a preset, changes options in code and by name, and compares three ways to look at
// the same pair: the paper's settings, the defaults, and yours.
//
//   03_own_options LEFT RIGHT CALIB [OPTION=VALUE ...]      e.g. evolve.flies=10000 fitness.function=covariance
#include <cstdio>
#include <numeric>
#include <span>
#include <string>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"
#include "input.hpp"

namespace {

/// The people model is no option but a part of the detector: each preset has one that belongs to it.
void compare(const char* name, const flies::DetectorOptions& options, flies::Preset preset,
             const flies::StereoCamera& camera, const flies::RectifiedPair& pair) {
  const flies::Detection detection = flies::Detector(camera, options, flies::preset_classifier(preset)).process(pair);
  const double total_ms = std::accumulate(detection.stage_ms.begin(), detection.stage_ms.end(), 0.0);
  std::printf("%-8s %6zu flies %4zu obstacles %4zu pedestrians %8.1f ms\n", name, detection.evolved.flies.size(),
              detection.obstacles.size(), detection.pedestrians.size(), total_ms);
}

flies::DetectorOptions own_options(std::span<char* const> assignments) {
  // Options are plain structs: take a preset and change members ...
  flies::DetectorOptions options = flies::preset_options(flies::Preset::standard);
  options.field.x_max_m = 30.0;
  options.evolve.generations = 10;

  // ... or set them by the names that the command line and YAML files use. A name that does not exist or a value out
  // of range throws an InputError that says what would be right.
  for (const std::string assignment : assignments) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos) {
      throw flies::InputError("command line", assignment, "found no '=', expected OPTION=VALUE");
    }
    flies::set_option(options, assignment.substr(0, equals), assignment.substr(equals + 1), "command line");
  }
  return options;
}

void print_changes(const flies::DetectorOptions& options) {
  const auto defaults = flies::list_options(flies::DetectorOptions{});
  const auto ours = flies::list_options(options);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i].value == defaults[i].value) continue;
    std::printf("%s = %s instead of %s: %s\n", ours[i].path.c_str(), ours[i].value.c_str(), defaults[i].value.c_str(),
                ours[i].meaning.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s LEFT RIGHT CALIB [OPTION=VALUE ...]\n", argv[0]);
    return 2;
  }
  try {
    const Input input = load_input(argv[1], argv[2], argv[3]);

    const flies::DetectorOptions own = own_options(std::span(argv, static_cast<std::size_t>(argc)).subspan(4));
    print_changes(own);
    const auto pair = input.images.view();
    using enum flies::Preset;
    compare("paper", flies::preset_options(paper), paper, input.camera, pair);
    compare("default", flies::preset_options(standard), standard, input.camera, pair);
    compare("own", own, standard, input.camera, pair);
    return 0;
  } catch (const flies::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
