#pragma once

#include <string>

/// Refuses an output that cannot go to standard output or whose name does not say what it will be. None, an empty name,
/// is allowed, and so is any device.
/// @param ending of the name, such as ".png"; empty: any
/// @throws flies::InputError naming the file and the option
void require_named_output(const std::string& path, const std::string& option, const std::string& ending = "");
