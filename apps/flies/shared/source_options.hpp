#pragma once

#include <string>
#include <vector>

#include "flies/io/images.hpp"

/// What `flies live` and `flies calibrate --live` are told of their sources.
/// @param has_size a picture size is to be asked of a camera
/// @throws flies::InputError naming a second source that is not needed, or an option that none of these sources has
void refuse_idle_source_options(const std::vector<std::string>& sources, flies::Split split, bool has_size);
