#pragma once

#include <sys/types.h>

#include <string>

/// A file that grows line by line under its own name, for readers that follow it: every line is handed over whole, so
/// that whatever ends the program, a full disk too, leaves whole lines. Only one run at a time may write it. "-" is
/// standard output.
class LineFile {
 public:
  /// @throws flies::InputError naming the file when it cannot be created, or another run is writing it
  explicit LineFile(const std::string& path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// Waits for the reader of a pipe; when the user has asked for the end and nobody reads, this and all further lines
  /// are left out.
  /// @param line with its line feed
  /// @throws flies::InputError naming the file when the disk is full or the like
  void write(const std::string& line);

 private:
  std::string path_;
  int descriptor_ = -1;
  bool is_ours_ = false;      ///< a regular file, which nobody else writes
  bool is_given_up_ = false;  ///< nobody reads, and the user asked for the end
  off_t whole_ = 0;           ///< bytes of whole lines
};
