#pragma once

#include <span>
#include <string_view>

#include "flies/classify/people_model.hpp"

namespace flies {

/// The people detector of 48 x 96 px that comes with OpenCV, trained on the Daimler data.
PeopleModel opencv_48x96();
/// OpenCV's other people detector, 64 x 128 px, trained on INRIA data; needs taller people.
PeopleModel opencv_64x128();

/// Names of the models that need no file, the default first: `flies-48x96-network` (with a network of convolutions as
/// its second stage), `flies-48x96` (with a machine of kernels there), `flies-48x96-linear` (a linear machine alone, as
/// the paper has it), `opencv-48x96`, `opencv-64x128`.
std::span<const std::string_view> people_model_names();

/// Finds a model by its name, or reads the file at this path.
/// @throws InputError as `read_people_model`; for a name that is no file the message lists the names
PeopleModel people_model(std::string_view name_or_path);

}  // namespace flies
