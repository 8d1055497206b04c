#include "flies/io/stale_parts.hpp"

#include <signal.h>

#include <cerrno>
#include <charconv>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace flies {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = ".part-";

/// A name's target and process; process 0 when it is no name of a part.
struct PartName {
  std::string target;
  pid_t process = 0;
};

PartName parse(std::string_view name) {
  const auto mark = name.rfind(kMark);
  if (mark == std::string_view::npos || mark == 0) return {};
  const std::string_view rest = name.substr(mark + kMark.size());
  pid_t process = 0;
  const char* const end = rest.data() + rest.size();
  auto [at, error] = std::from_chars(rest.data(), end, process);
  if (error != std::errc() || process <= 0) return {};
  if (at != end) {
    unsigned number = 0;
    if (*at != '-') return {};
    const auto counted = std::from_chars(at + 1, end, number);
    if (counted.ec != std::errc() || counted.ptr != end) return {};
  }
  return {std::string(name.substr(0, mark)), process};
}

bool is_gone(pid_t process) { return ::kill(process, 0) != 0 && errno == ESRCH; }

/// Left over in a folder: parts by the name of their target.
std::multimap<std::string, fs::path> stale_parts_in(const fs::path& folder) {
  std::multimap<std::string, fs::path> stale;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    auto part = parse(entry->path().filename().native());
    if (part.process > 0 && is_gone(part.process)) stale.emplace(std::move(part.target), entry->path());
  }
  return stale;
}

}  // namespace

void remove_stale_parts(const fs::path& target) noexcept {
  static std::mutex mutex;
  try {
    static auto* const stale_of_folder = new std::map<fs::path, std::multimap<std::string, fs::path>>;
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const std::scoped_lock lock(mutex);
    auto known = stale_of_folder->find(folder);
    if (known == stale_of_folder->end()) known = stale_of_folder->emplace(folder, stale_parts_in(folder)).first;
    const auto [first, last] = known->second.equal_range(target.filename().string());
    for (auto part = first; part != last; ++part) {
      std::error_code ignored;
      fs::remove_all(part->second, ignored);
    }
    known->second.erase(first, last);
  } catch (...) {  // out of memory, or of names: leftovers stay
  }
}

}  // namespace flies
