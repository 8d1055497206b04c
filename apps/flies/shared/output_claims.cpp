#include "shared/output_claims.hpp"

#include <unistd.h>

#include <filesystem>

#include "flies/core/error.hpp"
#include "flies/io/output_file.hpp"

namespace fs = std::filesystem;

namespace {

/// One spelling for all names of a file, links resolved as far as they exist.
std::string identity(const std::string& path) {
  if (path == "-") return path;
  std::error_code ignored;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  return canonical.empty() ? path : canonical.string();
}

bool is_device(const std::string& path) {
  std::error_code ignored;
  return fs::is_character_file(path, ignored) || fs::is_fifo(path, ignored);
}

bool is_writable_file(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && ::access(path.c_str(), W_OK) == 0;
}

}  // namespace

void OutputClaims::reads(const std::string& path) {
  if (!path.empty()) purpose_of_file_.emplace(identity(path), "an input");
}

void OutputClaims::reads(const std::vector<flies::PairPaths>& pairs) {
  for (const auto& pair : pairs) {
    reads(pair.left);
    reads(pair.right);
  }
}

bool OutputClaims::claim(const std::string& path, const std::string& option) {
  if (path.empty() || is_device(path)) return false;
  const auto [other, is_new] = purpose_of_file_.emplace(identity(path), "the output of " + option);
  if (is_new) return path != "-";
  if (path == "-") throw flies::InputError("standard output", option, "it is already " + other->second);
  throw flies::InputError(path, option, "this file is already " + other->second);
}

void OutputClaims::writes(const std::string& path, const std::string& option) {
  if (claim(path, option)) flies::OutputFile probe(path);  // creates its temporary file and removes it again
}

void OutputClaims::writes_in_place(const std::string& path, const std::string& option) {
  if (claim(path, option) && !is_writable_file(path)) flies::OutputFile probe(path);
}
