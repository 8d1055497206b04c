#include "shared/staged_folder.hpp"

#include <unistd.h>

#include <ranges>
#include <system_error>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/exclusive_file.hpp"
#include "flies/io/stale_parts.hpp"
#include "flies/io/unfinished_outputs.hpp"

namespace {

namespace fs = std::filesystem;

void check(const std::error_code& error, const std::string& folder, const char* deed) {
  if (error) throw flies::InputError(folder, "", std::string("cannot ") + deed + ": " + error.message());
}

/// Where the part folder keeps what the new content replaces.
constexpr const char* kReplaced = ".replaced";

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

struct Move {
  fs::path from, to;
};

/// Those of things that are there, all or none.
std::error_code rename_all(const std::vector<Move>& moves) {
  std::vector<Move> done;
  for (const auto& move : moves) {
    if (!is_there(move.from)) continue;
    std::error_code error, ignored;
    fs::rename(move.from, move.to, error);
    if (!error) {
      done.push_back(move);
      continue;
    }
    for (const auto& [from, to] : std::views::reverse(done)) fs::rename(to, from, ignored);
    return error;
  }
  return {};
}

}  // namespace

StagedFolder::StagedFolder(const std::string& folder, std::vector<std::string> entries, bool force)
    : folder_(folder), entries_(std::move(entries)) {
  if (folder.empty()) throw flies::InputError("command line", "OUT", "found an empty name, expected a folder");
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(folder, error), error);
  check(error, folder_, "find its place");
  if (!target_.has_filename()) target_ = target_.parent_path();  // "out/" means "out"
  if (fs::is_symlink(target_, error))
    throw flies::InputError(folder_, "", "found a link to nothing, expected a folder or a new name");
  flies::remove_stale_parts(target_);
  const fs::file_status status = fs::status(target_, error);
  fs::path part = target_;
  if (fs::exists(status)) {
    if (!fs::is_directory(status))
      throw flies::InputError(folder_, "", "found a file, expected a folder or a new name");
    part /= ".flies";  // inside, as the folder may be the root of a disk
    flies::remove_stale_parts(part);
    const bool is_empty = fs::is_empty(target_, error);
    check(error, folder_, "read the folder");
    if (!is_empty && !force)
      throw flies::InputError(folder_, "", "the folder is not empty; choose another or overwrite with --force");
  }
  part_ = part.string() + ".part-" + std::to_string(::getpid());
  flies::note_unfinished_output(part_);
  fs::create_directories(part_, error);
  if (error) flies::forget_unfinished_output(part_);
  check(error, folder_, "create the folder");
}

StagedFolder::~StagedFolder() {
  std::error_code error;  // nothing more can be done about leftovers here
  fs::remove_all(part_, error);
  flies::forget_unfinished_output(part_);
}

std::string StagedFolder::path(const std::string& file) const {
  const fs::path path = part_ / file;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  check(error, folder_, "create a folder in it");
  return path.string();
}

void StagedFolder::commit() {
  std::error_code error;
  if (!fs::exists(target_, error)) {
    fs::rename(part_, target_, error);
    check(error, folder_, "create the folder");
    return;
  }
  fs::create_directory(part_ / kReplaced, error);
  check(error, folder_, "create a folder in it");
  std::vector<Move> moves;
  for (const auto& entry : entries_) {
    flies::check_not_being_written((target_ / entry).string());
    moves.push_back({target_ / entry, part_ / kReplaced / entry});
    moves.push_back({part_ / entry, target_ / entry});
  }
  flies::forget_unfinished_output(part_);  // while it holds what may have to be put back
  check(rename_all(moves), folder_, "replace its content");
  flies::note_unfinished_output(part_);
}
