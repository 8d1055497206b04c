#include "flies/io/folder.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/image_folder.hpp"

namespace flies::detail {
namespace {

namespace fs = std::filesystem;

void check(const std::error_code& error, const fs::path& path) {
  if (error) throw InputError(path.string(), "", "cannot be read: " + error.message());
}

fs::file_type type_of(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  if (type == fs::file_type::not_found || error == std::errc::filename_too_long) return fs::file_type::not_found;
  check(error, path);
  return type;
}

struct Listing {
  std::vector<fs::path> files, folders;
};

Listing list(const fs::path& folder) {
  Listing found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_hidden(entry->path())) continue;
    std::error_code unknown;  // of a loop of links, which is a file as far as can be told
    const fs::file_type type = entry->status(unknown).type();
    if (type == fs::file_type::directory)
      found.folders.push_back(entry->path());
    else if (unknown || type == fs::file_type::regular || type == fs::file_type::not_found)
      found.files.push_back(entry->path());
  }
  check(error, folder);
  std::sort(found.files.begin(), found.files.end());
  std::sort(found.folders.begin(), found.folders.end());
  return found;
}

/// Whether a folder is a link to one that holds it.
bool leads_up(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_symlink(folder, error)) return false;
  const fs::path target = fs::canonical(folder, error);
  const fs::path place = fs::canonical(folder.has_parent_path() ? folder.parent_path() : fs::path("."), error);
  return !error && std::mismatch(target.begin(), target.end(), place.begin(), place.end()).first == target.end();
}

void add_files_below(const fs::path& folder, std::vector<fs::path>& files) {
  const Listing found = list(folder);
  files.insert(files.end(), found.files.begin(), found.files.end());
  for (const auto& below : found.folders)
    if (!leads_up(below)) add_files_below(below, files);
}

}  // namespace

std::string stem_of(const std::string& path) { return fs::path(path).stem().string(); }

bool is_there(const fs::path& path) { return type_of(path) != fs::file_type::not_found; }

bool is_there_as_folder(const fs::path& path) { return type_of(path) == fs::file_type::directory; }

std::vector<fs::path> files_of(const fs::path& folder) { return list(folder).files; }

std::vector<fs::path> folders_of(const fs::path& folder) { return list(folder).folders; }

std::vector<fs::path> files_below(const fs::path& folder, const std::function<bool(const fs::path&)>& accept) {
  std::vector<fs::path> files;
  add_files_below(folder, files);
  std::erase_if(files, [&](const fs::path& file) { return !accept(file); });
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace flies::detail
