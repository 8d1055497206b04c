#pragma once

#include <map>
#include <string>
#include <vector>

#include "flies/io/pair_source.hpp"

/// The files of a run, each with one purpose. Asked before the work, so that minutes are not lost to a place that
/// cannot be written, and no output overwrites an input.
class OutputClaims {
 public:
  /// A file or folder that is read. An empty path is none.
  void reads(const std::string& path);
  void reads(const std::vector<flies::PairPaths>& pairs);

  /// A file that is written; nothing of it is left behind. An empty path is none, "-" standard output; devices and
  /// pipes may be written more than once.
  /// @param option that names it, for errors
  /// @throws flies::InputError naming the file and the option when it has another purpose or cannot be created
  void writes(const std::string& path, const std::string& option);

  /// The same for files that grow under their own name, `LineFile` and recordings: one that exists may be written
  /// whoever may write its folder.
  void writes_in_place(const std::string& path, const std::string& option);

 private:
  /// @returns whether it is a file whose writing is to be tried
  bool claim(const std::string& path, const std::string& option);

  std::map<std::string, std::string> purpose_of_file_;  ///< by the file's one spelling
};
