#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "flies/train/training_picture.hpp"

namespace flies {

/// The labelled pictures of a folder, recognised as `find_pictures_of_people` says.
/// @returns nothing when the folder holds pictures alone
/// @throws InputError as that
std::optional<std::vector<TrainingPicture>> labelled_pictures(const std::filesystem::path& folder);

namespace detail {

/// Files of a folder and all below it in name order; hidden files and folders are passed over.
/// @throws InputError when it cannot be read
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                               const std::function<bool(const std::filesystem::path&)>& accept);

}  // namespace detail
}  // namespace flies
