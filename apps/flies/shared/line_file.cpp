#include "shared/line_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "flies/core/error.hpp"

namespace {

[[noreturn]] void fail(const std::string& path, int error_number) {
  throw flies::InputError(path == "-" ? "standard output" : path, "",
                          std::string("cannot write: ") + std::strerror(error_number));
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Locks the file until it is closed, and empties it. File systems without locks do without.
void take(int descriptor, const std::string& path) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw flies::InputError(path, "", "another run is writing it, expected a file of its own for each run");
  if (::ftruncate(descriptor, 0) != 0) fail(path, errno);
}

}  // namespace

LineFile::LineFile(const std::string& path) : path_(path) {
  if (path.empty()) throw flies::InputError("output", "file name", "is empty");
  // Emptied only once it is ours: another run may be writing it.
  descriptor_ = path == "-" ? STDOUT_FILENO : ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(path_, errno);
  if (path == "-" || !is_regular(descriptor_)) return;
  try {
    take(descriptor_, path_);
    is_ours_ = true;
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
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
