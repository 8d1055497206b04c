#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "flies/train/training_picture.hpp"

namespace flies {

/// The labelled pictures of a folder, recognised as `find_pictures_of_people` says.
/// @returns nothing when the folder holds pictures alone
/// @throws InputError as that
std::optional<std::vector<TrainingPicture>> labelled_pictures(const std::filesystem::path& folder);

}  // namespace flies
