#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace cv {
class Mat;
}

namespace flies {

/// A file that appears under its name only when it is complete: text goes to `<name>.part-<number>` beside it, which
/// `commit` renames; without `commit` it is removed. "-" is standard output; existing files that are not regular
/// (/dev/null, a pipe) are written directly.
class OutputFile {
 public:
  enum class Kind {
    whole,  ///< worth nothing before it is complete
    lines,  ///< each `write` is some whole lines; those written appear under the file's name even when the process is
            ///< made to end before the others are
  };

  /// What an earlier process left half written beside the file, because it was killed, is removed.
  /// @throws InputError naming the file when it cannot be created, or another run is writing it (`open_exclusively`)
  explicit OutputFile(const std::string& path, Kind kind = Kind::whole);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) = delete;

  /// Appends text or bytes; on standard output they are visible at once.
  /// @throws InputError naming the file when the disk is full or the like
  void write(std::string_view text);

  /// Closes the file and gives it its name. Call it once, last.
  /// @throws InputError naming the file when the disk is full or the like, or another run has begun to write it;
  /// nothing
  ///         is left behind then
  void commit();

  const std::string& path() const { return path_; }

 private:
  [[noreturn]] void fail(int error_number) const;
  void discard() noexcept;
  void forget_part() noexcept;
  void let_go() noexcept;

  std::string path_;         ///< as the user wrote it
  std::string target_path_;  ///< with links resolved
  std::string part_path_;    ///< empty when written directly
  Kind kind_ = Kind::whole;
  int kept_ = -1;  ///< of the file that is to be replaced: no other run may begin to write it
  std::FILE* file_ = nullptr;
};

/// Writes a whole file at once. @throws InputError naming the file when it cannot be written
void write_file(const std::string& path, std::string_view bytes);

/// Writes an 8- or 16-bit image as PNG. @throws InputError naming the file when it cannot be written
void write_png(const std::string& path, const cv::Mat& image);

}  // namespace flies
