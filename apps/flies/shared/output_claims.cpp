#include "shared/output_claims.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "flies/classify/network_classifier.hpp"
#include "flies/core/error.hpp"
#include "flies/io/formats/second_file.hpp"
#include "flies/io/output_file.hpp"

namespace fs = std::filesystem;

namespace {

/// The same for all names of a file: of one that exists its number on its disk, for hard links have no common spelling;
/// else its path, links resolved as far as they exist.
std::string identity(const std::string& path) {
  if (path == "-") return path;
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode))
    return fmt::format("{}:{}", status.st_dev, status.st_ino);
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

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

constexpr const char* kIsInput = "this file is already an input";

}  // namespace

void OutputClaims::reads(const std::string& path) {
  if (path.empty()) return;
  const auto [known, is_new] = writer_of_file_.emplace(identity(path), Writer{});
  const Writer& writer = known->second;
  if (!is_new && !writer.option.empty()) throw flies::InputError(writer.path, writer.option, kIsInput);
}

void OutputClaims::reads(const std::vector<std::string>& paths) {
  for (const auto& path : paths) reads(path);
}

void OutputClaims::reads(const std::vector<flies::PairPaths>& pairs) {
  for (const auto& pair : pairs) {
    reads(pair.left);
    reads(pair.right);
  }
}

void OutputClaims::reads_calibration(const std::string& file, const std::string& right) {
  reads(file);
  reads(right);
  if (file.empty() || !right.empty()) return;
  const auto beside = flies::detail::right_file_beside(file);
  if (beside && is_file(*beside)) reads(beside->string());
}

void OutputClaims::reads_model(const std::string& name_or_file) {
  if (!is_file(name_or_file)) return;
  reads(name_or_file);
  if (!flies::is_network_file(name_or_file)) return;
  for (const char* extension : {".yaml", ".cfg", ".weights", ".prototxt", ".caffemodel"})
    if (const auto other = fs::path(name_or_file).replace_extension(extension); is_file(other)) reads(other.string());
}

void OutputClaims::reads_method(const MethodArguments& method) {
  reads(method.options_file);
  reads_model(people_model_of(method));
}

bool OutputClaims::claim(const std::string& path, const std::string& option) {
  if (path.empty() || is_device(path)) return false;
  const auto [known, is_new] = writer_of_file_.emplace(identity(path), Writer{path, option});
  if (is_new) return path != "-";
  const Writer& writer = known->second;
  if (writer.option.empty()) throw flies::InputError(path, option, kIsInput);
  if (path == "-") throw flies::InputError("standard output", option, "it is already the output of " + writer.option);
  throw flies::InputError(path, option, "this file is already the output of " + writer.option);
}

void OutputClaims::writes(const std::string& path, const std::string& option) {
  if (claim(path, option)) flies::OutputFile probe(path);  // creates its temporary file and removes it again
}

void OutputClaims::writes_in_place(const std::string& path, const std::string& option) {
  if (claim(path, option) && !is_writable_file(path)) flies::OutputFile probe(path);
}
