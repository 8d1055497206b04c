#include "detect/detect_outputs.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

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

}  // namespace

bool DetectOutputs::any() const {
  for (const std::string* path : {&json, &csv, &scan, &ply, &overlay, &top_view, &flies, &histogram, &concentrating})
    if (!path->empty()) return true;
  return false;
}

std::string file_stem(const std::string& path) { return fs::path(path).stem().string(); }

std::string path_of_frame(const std::string& path, const std::string& frame, bool is_single_pair) {
  if (is_single_pair) return path;
  const fs::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + "_" + frame + whole.extension().string())).string();
}

void check_outputs(const DetectOutputs& outputs, const std::vector<flies::PairPaths>& pairs,
                   const std::vector<std::string>& inputs) {
  std::map<std::string, std::string> role_of_file;  // identity -> what the file is
  for (const auto& input : inputs) role_of_file.emplace(identity(input), "an input");
  for (const auto& pair : pairs) {
    role_of_file.emplace(identity(pair.left), "an input");
    role_of_file.emplace(identity(pair.right), "an input");
  }
  const auto claim = [&](const std::string& path, const std::string& option) {
    if (path != "-" && !is_device(path)) {
      const auto [other, is_new] = role_of_file.emplace(identity(path), "the output of " + option);
      if (!is_new) throw flies::InputError(path, option, "this file is already " + other->second);
      flies::OutputFile probe(path);  // creates its temporary file and removes it again
    } else if (path == "-") {
      const auto [other, is_new] = role_of_file.emplace(path, "the output of " + option);
      if (!is_new) throw flies::InputError("standard output", option, "it is already " + other->second);
    }
  };
  for (const auto& [path, option] :
       {std::pair(outputs.json, "--json"), std::pair(outputs.csv, "--csv"), std::pair(outputs.scan, "--scan")})
    if (!path.empty()) claim(path, option);
  const std::array per_frame = {std::pair(outputs.ply, "--ply"),
                                std::pair(outputs.overlay, "--overlay"),
                                std::pair(outputs.top_view, "--top-view"),
                                std::pair(outputs.flies, "--flies"),
                                std::pair(outputs.histogram, "--histogram"),
                                std::pair(outputs.concentrating, "--concentrating")};
  for (const auto& [path, option] : per_frame) {
    if (path.empty()) continue;
    if (path == "-") throw flies::InputError("command line", option, "cannot go to standard output");
    const std::string wanted = std::string_view(option) == "--ply" ? ".ply" : ".png";
    if (std::filesystem::path(path).extension() != wanted && !path.starts_with("/dev/"))
      throw flies::InputError(path, option, fmt::format("expected a name that ends in {}", wanted));
    for (const auto& pair : pairs) claim(path_of_frame(path, file_stem(pair.left), pairs.size() == 1), option);
  }
}
