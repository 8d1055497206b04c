#include "shared/line_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "flies/core/error.hpp"

namespace {

[[noreturn]] void fail(const std::string& path, int error_number) {
  throw flies::InputError(path == "-" ? "standard output" : path, "",
                          std::string("cannot write: ") + std::strerror(error_number));
}

}  // namespace

LineFile::LineFile(const std::string& path) : path_(path) {
  if (path.empty()) throw flies::InputError("output", "file name", "is empty");
  descriptor_ = path == "-" ? STDOUT_FILENO : ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(path_, errno);
}

LineFile::~LineFile() {
  if (descriptor_ > STDERR_FILENO) ::close(descriptor_);
}

void LineFile::write(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const auto count = ::write(descriptor_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(path_, errno);
    done += static_cast<std::size_t>(count);
  }
}
