#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace flies::testing {

struct RunResult {
  int status = -1;  ///< exit status; 128 + signal when it was killed
  std::string out, err;
};

/// Runs the command `flies` in `folder` and waits for it.
/// @param prefix shell words before the command, e.g. "ulimit -f 1;"
/// @param suffix shell words after it, e.g. "> /dev/full"
RunResult run_flies(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const std::string& prefix = "", const std::string& suffix = "");

/// Starts the command `flies` in `folder`, sends it `signal` once `is_time` says so, and waits for it. After a minute
/// in which that was never said, which fails the test, it is sent all the same.
RunResult interrupt_flies(const std::filesystem::path& folder, const std::vector<std::string>& arguments, int signal,
                          const std::function<bool()>& is_time);

/// Whether `count` whole lines or more of the output `name` are written, in its place or in the file that will take it.
bool are_written(const std::filesystem::path& folder, const std::string& name, std::size_t count);

std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);
std::vector<std::string> lines(const std::string& text);

/// A folder of its own for one test, removed at the end.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Relative names of everything below, sorted.
  std::vector<std::string> listing() const;

 private:
  std::filesystem::path path_;
};

}  // namespace flies::testing
