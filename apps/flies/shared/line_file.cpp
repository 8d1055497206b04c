#include "shared/line_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "flies/core/error.hpp"
#include "flies/io/exclusive_file.hpp"

namespace {

[[noreturn]] void fail(const std::string& path, int error_number) {
  const std::string why = error_number == EPIPE ? "whoever read it went away" : std::strerror(error_number);
  throw flies::InputError(path == "-" ? "standard output" : path, "", "cannot write: " + why);
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

LineFile::LineFile(const std::string& path) : path_(path) {
  if (path.empty()) throw flies::InputError("output", "file name", "is empty");
  descriptor_ = path == "-" ? STDOUT_FILENO : flies::open_exclusively(path, path);
  is_ours_ = path != "-" && is_regular(descriptor_);
}

LineFile::~LineFile() {
  if (descriptor_ > STDERR_FILENO) ::close(descriptor_);
}

void LineFile::write(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const auto count = ::write(descriptor_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error_number = errno;
      // Takes no space, so it works on a full disk too; where it does not, the fault is told below all the same.
      [[maybe_unused]] const int truncated = is_ours_ ? ::ftruncate(descriptor_, whole_) : 0;
      fail(path_, error_number);
    }
    done += static_cast<std::size_t>(count);
  }
  whole_ += static_cast<off_t>(line.size());
}
