#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "flies/train/training_picture.hpp"

namespace flies {

/// The labelled pictures of a folder, recognised as `find_pictures_of_people` says.
/// @param note is told of pictures that are not used, for they have no labels
/// @returns nothing when the folder holds pictures alone
/// @throws InputError as that, and naming the file when there are labels of a kind that is not read, or the folder of
///         labels when it holds none
std::optional<std::vector<TrainingPicture>> labelled_pictures(const std::filesystem::path& folder, const SayNote& note);

}  // namespace flies
