#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace flies::detail {

/// The name of a file without its folder and extension.
std::string stem_of(const std::string& path);

/// Whether a file or folder of this name is there, links followed; a link to nothing is not.
/// @throws InputError naming it when that cannot be told: a loop of links, a folder that must not be looked into
bool is_there(const std::filesystem::path& path);

/// Whether it is there and a folder. @throws InputError as `is_there`
bool is_there_as_folder(const std::filesystem::path& path);

/// The files of a folder in order of their paths, without hidden ones. Folders, pipes and devices are passed over;
/// links that lead nowhere are not, so that who reads them tells of it. @throws InputError naming the folder when it
/// cannot be read
std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder);

/// Those that are accepted of the folder and of the ones below it, hidden ones passed over. Links to folders are
/// followed, but for those that lead back up. @throws InputError naming the folder when one cannot be read
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder,
                                               const std::function<bool(const std::filesystem::path&)>& accept);

/// The folders in a folder, as `files_of` its files.
std::vector<std::filesystem::path> folders_of(const std::filesystem::path& folder);

}  // namespace flies::detail
