#pragma once

#include <CLI/CLI.hpp>

/// Has all helps break descriptions that would not fit a line of 100 characters.
void wrap_help(CLI::App& app);

/// Refuses the name of an option as the value of another one: its own value was forgotten.
void refuse_options_as_values(CLI::App& app);
