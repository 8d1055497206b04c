#include "flies/io/unfinished_outputs.hpp"

#include <mutex>
#include <set>
#include <system_error>

namespace flies {
namespace {

struct Unfinished {
  std::mutex mutex;
  std::set<std::filesystem::path> paths;
};

/// Never destroyed: the process may be made to end while its statics are.
Unfinished& unfinished() {
  static auto* const kept = new Unfinished;
  return *kept;
}

}  // namespace

void note_unfinished_output(const std::filesystem::path& path) {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().paths.insert(path);
}

void forget_unfinished_output(const std::filesystem::path& path) noexcept {
  const std::scoped_lock lock(unfinished().mutex);
  unfinished().paths.erase(path);
}

void remove_unfinished_outputs() noexcept {
  unfinished().mutex.lock();  // for good
  for (const auto& path : unfinished().paths) {
    std::error_code ignored;  // nothing more can be done about leftovers here
    std::filesystem::remove_all(path, ignored);
  }
}

}  // namespace flies
