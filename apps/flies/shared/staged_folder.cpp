#include "shared/staged_folder.hpp"

#include <unistd.h>

#include <system_error>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/io/stale_parts.hpp"
#include "flies/io/unfinished_outputs.hpp"

namespace {

namespace fs = std::filesystem;

void check(const std::error_code& error, const std::string& folder, const char* deed) {
  if (error) throw flies::InputError(folder, "", std::string("cannot ") + deed + ": " + error.message());
}

}  // namespace

StagedFolder::StagedFolder(const std::string& folder, std::vector<std::string> entries, bool force)
    : folder_(folder), entries_(std::move(entries)) {
  if (folder.empty()) throw flies::InputError("command line", "OUT", "found an empty name, expected a folder");
  std::error_code error;
  target_ = fs::absolute(fs::path(folder), error).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();  // "out/" means "out"
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status))
      throw flies::InputError(folder_, "", "found a file, expected a folder or a new name");
    const bool is_empty = fs::is_empty(target_, error);
    check(error, folder_, "read the folder");
    if (!is_empty && !force)
      throw flies::InputError(folder_, "", "the folder is not empty; choose another or overwrite with --force");
  }
  flies::remove_stale_parts(target_);
  part_ = target_.string() + ".part-" + std::to_string(::getpid());
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
  for (const auto& entry : entries_) {
    fs::remove_all(target_ / entry, error);
    check(error, folder_, "replace its old content");
    if (!fs::exists(part_ / entry, error)) continue;
    fs::rename(part_ / entry, target_ / entry, error);
    check(error, folder_, "write into it");
  }
}
