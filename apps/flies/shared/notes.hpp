#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "flies/io/writers.hpp"

/// How much a command says on standard error beside its errors.
enum class Verbosity { quiet, normal, verbose };

/// `--quiet` and `--verbose`, for a command that says something.
void add_verbosity_options(CLI::App& command);

Verbosity verbosity();

/// Tells the user, on standard error, what was assumed: one line `flies: note: ...` each. Nothing with `--quiet`.
void say_notes(const std::vector<std::string>& notes);

/// With `--verbose`: what the run is made of.
void say_run(const flies::RunRecord& run);
