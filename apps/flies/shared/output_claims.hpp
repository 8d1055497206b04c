#pragma once

#include <map>
#include <string>
#include <vector>

#include "flies/io/pair_source.hpp"
#include "shared/method_arguments.hpp"

/// The files of a run, each with one purpose. Asked before the work, so that minutes are not lost to a place that
/// cannot be written, and no output overwrites an input. Inputs may also be named after the outputs, when they are
/// found; nothing is written before both are known.
class OutputClaims {
 public:
  /// A file or folder that is read. An empty path is none.
  /// @throws flies::InputError naming the output, when it is one
  void reads(const std::string& path);
  void reads(const std::vector<std::string>& paths);
  void reads(const std::vector<flies::PairPaths>& pairs);

  /// A calibration, its second file and, where that is not given, the one that lies beside it by its name.
  void reads_calibration(const std::string& file, const std::string& right);

  /// A people model by its name, which is no file, or its file with those that belong to it by their names.
  void reads_model(const std::string& name_or_file);

  /// The options file and the people model.
  /// @throws flies::InputError as `people_model_of`, too
  void reads_method(const MethodArguments& method);

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

  /// Who writes a file, for errors; both empty of what is read.
  struct Writer {
    std::string path, option;
  };

  std::map<std::string, Writer> writer_of_file_;  ///< by what all names of a file share
};
