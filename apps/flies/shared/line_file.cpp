#include "shared/line_file.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>

#include "flies/core/error.hpp"
#include "flies/io/exclusive_file.hpp"
#include "shared/end_on_signal.hpp"
#include "shared/notes.hpp"

namespace {

[[noreturn]] void fail(const std::string& path, int error_number) {
  const std::string why = error_number == EPIPE ? "whoever read it went away" : std::strerror(error_number);
  throw flies::InputError(path == "-" ? "standard output" : path, "", "cannot write: " + why);
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Whether something can be written. It waits for a reader who is slow, but not when the user asked for the end and
/// nothing was read for a while.
bool wait_for_reader(int descriptor) {
  constexpr int kLook_ms = 100, kPatience_ms = 1000;
  for (int waited_ms = 0; waited_ms < kPatience_ms;) {
    pollfd waiting{.fd = descriptor, .events = POLLOUT, .revents = 0};
    const int ready = ::poll(&waiting, 1, kLook_ms);
    if (ready != 0 && !(ready < 0 && errno == EINTR)) return true;  // faults are those of writing
    if (is_end_requested()) waited_ms += kLook_ms;
  }
  return false;
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
  const bool may_wait = !is_regular(descriptor_);
  const std::size_t most = may_wait ? std::size_t{PIPE_BUF} : line.size();  // what fits in a pipe that has room
  for (std::size_t done = 0; done < line.size() && !is_given_up_;) {
    if (may_wait && !wait_for_reader(descriptor_)) {
      is_given_up_ = true;
      say_notes({(path_ == "-" ? "standard output" : path_) + ": is not read any more, so its last lines are missing"});
      return;
    }
    const auto count = ::write(descriptor_, line.data() + done, std::min(most, line.size() - done));
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
