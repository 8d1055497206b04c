#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// An output folder that appears, or changes, only when everything in it is complete: files go to a folder
/// `<name>.part-<process>` beside it, or `.flies.part-<process>` in it where it exists, which `commit` puts in its
/// place; without `commit` it is removed. Links are followed.
class StagedFolder {
 public:
  /// @param entries what will be written; the only names `commit` replaces
  /// @param force   allows the folder to exist with other things in it, or an earlier result
  /// @throws flies::InputError naming the folder when it exists and is not empty without `force`, is a file, or cannot
  ///         be made
  StagedFolder(const std::string& folder, std::vector<std::string> entries, bool force);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Path of a file to write, relative to the folder; makes the folders on the way.
  /// @throws flies::InputError when a folder cannot be made
  std::string path(const std::string& file) const;

  /// Call it once, last.
  /// @throws flies::InputError when the result cannot be put in its place; the folder then is as it was
  void commit();

 private:
  std::string folder_;  ///< as the user wrote it
  std::vector<std::string> entries_;
  std::filesystem::path target_, part_;
};
