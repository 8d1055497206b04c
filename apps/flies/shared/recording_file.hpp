#pragma once

#include <optional>
#include <string>

/// The recording that a source is: a file that is called so, or the one in a folder of rosbag2 (or its metadata.yaml).
/// @returns nothing where it is something else, such as a folder of images
/// @throws InputError that says what to give where it is a recording of a kind that is not read, or several
std::optional<std::string> recording_of(const std::string& source);
