#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

/// Where tests find real data; nothing of it is part of the project.
namespace flies::testing {

/// The folder `FLIES_TEST_DATA`, otherwise `../shared/data` beside the source.
inline std::filesystem::path data_folder() {
  if (const char* given = std::getenv("FLIES_TEST_DATA")) return given;
  if (const char* source = std::getenv("FLIES_SOURCE_DIR")) return std::filesystem::path(source) / "../shared/data";
  return "../shared/data";
}

/// A folder of the real data; nothing when it is not there.
inline std::optional<std::filesystem::path> find_data(const std::string& sub_folder) {
  const auto folder = data_folder() / sub_folder;
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return std::filesystem::canonical(folder);
}

/// The sentence to skip with.
inline std::string absence(const std::string& sub_folder) {
  return "The data folder " + (data_folder() / sub_folder).string() +
         " is absent; set FLIES_TEST_DATA to the folder that holds " + sub_folder + ".";
}

}  // namespace flies::testing
