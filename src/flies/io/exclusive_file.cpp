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

[[noreturn]] void fail_as_another_writes(const std::string& name) {
  throw InputError(name, "", "another run is writing it, expected another place for each run");
}

/// What a run that replaces a file holds of it.
struct Shared {
  int descriptor = -1;
  bool is_refused = false;  ///< another run is writing it
};

Shared lock_shared(const std::string& path) noexcept {
  // Not blocking: what has become a pipe since would wait for its writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return {};
  if (::flock(descriptor, LOCK_SH | LOCK_NB) == 0) return {.descriptor = descriptor};
  const bool is_refused = errno == EWOULDBLOCK;
  ::close(descriptor);
  return {.is_refused = is_refused};
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
      fail_as_another_writes(name);
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

int keep_from_writers(const std::string& path, const std::string& name) {
  const Shared shared = lock_shared(path);
  if (shared.is_refused) fail_as_another_writes(name);
  return shared.descriptor;
}

bool is_being_written(const std::string& path) noexcept {
  const Shared shared = lock_shared(path);
  if (shared.descriptor >= 0) ::close(shared.descriptor);
  return shared.is_refused;
}

void check_not_being_written(const std::string& path) {
  if (is_being_written(path)) fail_as_another_writes(path);
}

}  // namespace flies
