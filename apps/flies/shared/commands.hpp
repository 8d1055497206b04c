#pragma once

#include <CLI/CLI.hpp>

/// The subcommands of `flies`, a file each. Every `setup_x` adds its subcommand, with a callback that runs it.
/// Faults of the user leave the callback as `flies::InputError`; nothing else is expected to.
void setup_detect(CLI::App& app);
void setup_track(CLI::App& app);
void setup_live(CLI::App& app);
void setup_check(CLI::App& app);
void setup_calib(CLI::App& app);
void setup_calibrate(CLI::App& app);
void setup_synth(CLI::App& app);
void setup_evaluate(CLI::App& app);
void setup_evaluate_classifier(CLI::App& app);
void setup_train(CLI::App& app);
void setup_reproduce(CLI::App& app);
void setup_bench(CLI::App& app);
void setup_config(CLI::App& app);
void setup_info(CLI::App& app);
void setup_completion(CLI::App& app);

/// Whether the command line is that of `flies train --network`, which is a program of its own: it needs libtorch, and
/// nobody who only detects shall load that.
bool is_network_training(int argc, char** argv);

/// Becomes that program, flies-train-network, with all the other arguments; its exit status is then the process's.
/// @throws flies::InputError when it is not there, with what to do, or cannot be started
[[noreturn]] void become_network_trainer(int argc, char** argv);
