#include "shared/notes.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

Verbosity chosen = Verbosity::normal;  // one a process, as the command line is

}  // namespace

void add_verbosity_options(CLI::App& command) {
  auto* quiet = command.add_flag_callback(
      "-q,--quiet", [] { chosen = Verbosity::quiet; }, "print only results and errors");
  command
      .add_flag_callback(
          "-v,--verbose", [] { chosen = Verbosity::verbose; }, "also print version, camera and options of the run")
      ->excludes(quiet);
}

Verbosity verbosity() { return chosen; }

void say_notes(const std::vector<std::string>& notes) {
  if (chosen == Verbosity::quiet) return;
  for (const auto& note : notes) std::fprintf(stderr, "flies: note: %s\n", note.c_str());
}

void say_run(const flies::RunRecord& run) {
  if (chosen != Verbosity::verbose) return;
  const auto& camera = run.camera;
  fmt::print(stderr, "flies: version {}, preset {}, people by {}\n", run.version, run.preset, run.people_model);
  fmt::print(stderr, "flies: {}: {} x {} px, fx {:.1f}, fy {:.1f}, cx {:.1f}, cy {:.1f} px, baseline {:.4f} m\n",
             run.calibration, camera.width_px, camera.height_px, camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px,
             camera.baseline_m);
  fmt::print(stderr, "flies: camera {:.2f} m above the ground, pitch {:.2f}, roll {:.2f} degrees\n",
             camera.mount.height_m, flies::degrees(camera.mount.pitch_rad), flies::degrees(camera.mount.roll_rad));
  for (const auto& [name, value] : run.options) fmt::print(stderr, "flies: {} = {}\n", name, value);
}
