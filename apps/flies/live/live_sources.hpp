#pragma once

#include <string>
#include <vector>

/// The path of a `file://` URL; other sources as they are.
std::string without_file_scheme(const std::string& source);

/// Files that GStreamer elements of a pipeline name as their `location`.
std::vector<std::string> files_of_pipeline(const std::string& source);

/// @throws flies::InputError when both sources are the same film or device
void check_sources_differ(const std::vector<std::string>& sources);
