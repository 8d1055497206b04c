#include "shared/recording_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/folder.hpp"

namespace fs = std::filesystem;

namespace {

bool has_ending(const std::string& path, std::initializer_list<std::string_view> endings) {
  return std::ranges::any_of(endings, [&](std::string_view ending) { return path.ends_with(ending); });
}

/// `.active`: of a recorder that did not come to its end.
bool is_read(const std::string& path) { return has_ending(path, {".mcap", ".bag", ".mcap.active", ".bag.active"}); }

/// @throws InputError when it is a recording of a kind that is not read
void refuse_other_kinds(const std::string& path) {
  if (path.ends_with(".db3"))
    throw flies::InputError(path, "",
                            "is a recording in SQLite, which flies does not read: convert it to MCAP (ros2 bag "
                            "convert, with storage_id: mcap) and give the .mcap file");
  if (has_ending(path, {".mcap.zstd", ".mcap.zst", ".bag.zst", ".bag.gz", ".mcap.gz", ".bag.bz2"}))
    throw flies::InputError(path, "", "is compressed as a whole: unpack it first and give the unpacked file");
}

/// The recording in a folder; nothing where it holds none of any kind.
std::optional<std::string> recording_in(const fs::path& folder) {
  std::vector<std::string> read, others;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (is_read(path))
      read.push_back(path);
    else if (has_ending(path, {".db3", ".mcap.zstd"}))
      others.push_back(path);
  }
  if (read.size() == 1) return read.front();
  std::ranges::sort(read);
  if (read.size() > 1)
    throw flies::InputError(
        folder.string(), "",
        fmt::format("holds {} recordings, expected one: give one of {}", read.size(), fmt::join(read, ", ")));
  std::ranges::sort(others);
  if (!others.empty()) refuse_other_kinds(others.front());
  return std::nullopt;
}

}  // namespace

std::optional<std::string> recording_of(const std::string& source) {
  if (flies::detail::is_there_as_folder(source)) return recording_in(source);
  if (fs::path(source).filename() == "metadata.yaml")
    return recording_in(fs::absolute(source).lexically_normal().parent_path());
  if (flies::detail::is_there(source)) refuse_other_kinds(source);
  return is_read(source) ? std::optional(source) : std::nullopt;
}
