#include "flies/io/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/exclusive_file.hpp"
#include "flies/io/stale_parts.hpp"
#include "flies/io/unfinished_outputs.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;

/// Unique among processes by the process id, within one by counting.
std::string part_name(const std::string& target) {
  static std::atomic<unsigned> count{0};
  return fmt::format("{}.part-{}-{}", target, ::getpid(), count++);
}

}  // namespace

OutputFile::OutputFile(const std::string& path, Kind kind) : path_(path), kind_(kind) {
  if (path.empty()) throw InputError("output", "file name", "is empty");
  if (path == "-") {
    file_ = stdout;
    return;
  }
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path, "", "is a folder, expected a file to write");
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    target_path_ = path;
    file_ = std::fopen(path.c_str(), "wb");
    if (file_ == nullptr) fail(errno);
    return;
  }
  // Renaming onto a link would replace the link, so follow it first.
  const fs::path resolved = fs::weakly_canonical(path, error);
  target_path_ = error ? path : resolved.string();
  // A file that may not be written must not be replaced either, although the folder would allow it.
  if (fs::exists(target_path_, error) && ::access(target_path_.c_str(), W_OK) != 0) fail(errno);
  kept_ = keep_from_writers(target_path_, path_);
  remove_stale_parts(target_path_);
  part_path_ = part_name(target_path_);
  if (kind_ == Kind::lines)
    note_unfinished_lines(part_path_, target_path_);
  else
    note_unfinished_output(part_path_);
  const int descriptor = ::open(part_path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const int open_error = errno;
  if (descriptor >= 0) file_ = ::fdopen(descriptor, "wb");
  if (file_ == nullptr) {
    if (descriptor < 0) forget_part();
    discard();
    fail(open_error);
  }
}

OutputFile::~OutputFile() { discard(); }

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_path_(std::move(other.target_path_)),
      part_path_(std::exchange(other.part_path_, {})),
      kind_(other.kind_),
      kept_(std::exchange(other.kept_, -1)),
      file_(std::exchange(other.file_, nullptr)) {}

void OutputFile::write(std::string_view text) {
  assert(file_ != nullptr);
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail(errno);
  if ((file_ == stdout || kind_ == Kind::lines) && std::fflush(file_) != 0) fail(errno);
}

void OutputFile::commit() {
  assert(file_ != nullptr);
  if (std::ferror(file_) != 0) fail(EIO);
  if (file_ == stdout) {
    file_ = nullptr;
    if (std::fflush(stdout) != 0) fail(errno);
    return;
  }
  // The last bytes reach the disk here, and so does the news that it is full.
  std::FILE* file = std::exchange(file_, nullptr);
  int error_number = std::fflush(file) != 0 ? errno : 0;
  if (std::fclose(file) != 0 && error_number == 0) error_number = errno;
  if (error_number == 0 && !part_path_.empty()) {
    const int kept = keep_from_writers(target_path_, path_);  // it may have come only now
    let_go();
    kept_ = kept;
    if (::rename(part_path_.c_str(), target_path_.c_str()) != 0) error_number = errno;
  }
  if (error_number != 0) {
    discard();
    fail(error_number);
  }
  forget_part();
  let_go();
}

void OutputFile::fail(int error_number) const {
  throw InputError(path_ == "-" ? "standard output" : path_, "",
                   fmt::format("cannot be written: {}", std::strerror(error_number)));
}

void OutputFile::discard() noexcept {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  file_ = nullptr;
  if (!part_path_.empty()) ::unlink(part_path_.c_str());
  forget_part();
  let_go();
}

void OutputFile::let_go() noexcept {
  if (const int kept = std::exchange(kept_, -1); kept >= 0) ::close(kept);
}

void OutputFile::forget_part() noexcept {
  if (!part_path_.empty()) forget_unfinished_output(part_path_);
  part_path_.clear();
}

void write_file(const std::string& path, std::string_view bytes) {
  OutputFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace flies
