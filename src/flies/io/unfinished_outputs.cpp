#include "flies/io/unfinished_outputs.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <system_error>

#include "flies/io/exclusive_file.hpp"

namespace flies {
namespace {

struct Unfinished {
  std::mutex mutex;
  std::map<std::filesystem::path, std::filesystem::path> target_of_path;  ///< empty: not worth keeping
};

/// Gives whole lines their name, unless another run has it by now. @returns whether it has been given
bool keep_lines(const std::filesystem::path& path, const std::filesystem::path& target) {
  if (is_being_written(target.string())) return false;
  constexpr std::uintmax_t kPiece = 4096;
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  for (std::uintmax_t end = std::filesystem::file_size(path, error); !error && file && end > 0;) {
    const std::uintmax_t begin = end - std::min(end, kPiece);
    std::string piece(end - begin, '\0');
    file.seekg(static_cast<std::streamoff>(begin));
    if (!file.read(piece.data(), static_cast<std::streamsize>(piece.size()))) return false;
    if (const auto last = piece.rfind('\n'); last != std::string::npos) {
      std::filesystem::resize_file(path, begin + last + 1, error);
      if (!error) std::filesystem::rename(path, target, error);
      return !error;
    }
    end = begin;
  }
  return false;
}

/// Never destroyed: the process may be made to end while its statics are.
Unfinished& unfinished() {
  static auto* const kept = new Unfinished;
  return *kept;
}

}  // namespace

void note_unfinished_output(const std::filesystem::path& path) {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().target_of_path[path].clear();
}

void note_unfinished_lines(const std::filesystem::path& path, const std::filesystem::path& target) {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().target_of_path[path] = target;
}

void forget_unfinished_output(const std::filesystem::path& path) noexcept {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().target_of_path.erase(path);
}

void remove_unfinished_outputs() noexcept {
  unfinished().mutex.lock();  // for good
  for (const auto& [path, target] : unfinished().target_of_path) {
    if (!target.empty() && keep_lines(path, target)) continue;
    std::error_code ignored;  // nothing more can be done about leftovers here
    std::filesystem::remove_all(path, ignored);
  }
}

}  // namespace flies
