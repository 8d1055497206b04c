#include "flies/io/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "flies/core/error.hpp"

namespace flies {

std::string read_file(const std::string& path, std::size_t max_bytes) {
  std::error_code ignored;
  if (path.empty()) throw InputError("input", "file name", "is empty");
  if (std::filesystem::is_directory(path, ignored)) throw InputError(path, "", "is a folder, expected a file");

  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw InputError(path, "", fmt::format("cannot be read: {}", std::strerror(errno)));

  // Read piece by piece rather than by size, so that pipes work too.
  std::string bytes;
  constexpr std::size_t kPiece = 1U << 16;
  for (std::size_t got = kPiece; got == kPiece;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kPiece);
    got = std::fread(bytes.data() + before, 1, kPiece, file.get());
    bytes.resize(before + got);
    if (std::ferror(file.get()) != 0)
      throw InputError(path, "", fmt::format("cannot be read: {}", std::strerror(errno)));
    if (bytes.size() > max_bytes)
      throw InputError(path, "", fmt::format("is larger than {} bytes, too large for what it should be", max_bytes));
  }
  if (bytes.empty()) throw InputError(path, "", "is empty");
  return bytes;
}

}  // namespace flies
