#pragma once

#include <string>

/// Writes to standard output.
void print(const std::string& text);

/// @throws flies::InputError when standard output did not take everything, e.g. because the disk is full
void flush_standard_output();
