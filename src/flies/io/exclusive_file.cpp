#include "flies/io/exclusive_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "flies/core/error.hpp"

namespace flies {
namespace {

[[noreturn]] void fail(const std::string& name, int error_number) {
  throw InputError(name, "", std::string("cannot write: ") + std::strerror(error_number));
}

/// Whether the file still has this name: the run that had it before may just have given it another.
bool is_still_called(const std::string& path, const struct stat& file) {
  struct stat now = {};
  return ::stat(path.c_str(), &now) == 0 && now.st_dev == file.st_dev && now.st_ino == file.st_ino;
}

}  // namespace

int open_exclusively(const std::string& path, const std::string& name) {
  while (true) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(name, errno);
    struct stat file = {};
    if (::fstat(descriptor, &file) != 0 || !S_ISREG(file.st_mode)) return descriptor;
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor);
      throw InputError(name, "", "another run is writing it, expected a file of its own for each run");
    }
    if (!is_still_called(path, file)) {
      ::close(descriptor);
      continue;
    }
    if (::ftruncate(descriptor, 0) == 0) return descriptor;
    const int error_number = errno;
    ::close(descriptor);
    fail(name, error_number);
  }
}

}  // namespace flies
