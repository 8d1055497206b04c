#include "detect/detect_outputs.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "shared/named_output.hpp"

namespace fs = std::filesystem;

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

void check_outputs(const DetectOutputs& outputs, const std::vector<flies::PairPaths>& pairs, OutputClaims claims) {
  claims.reads(pairs);
  claims.writes(outputs.json, "--json");
  claims.writes(outputs.csv, "--csv");
  claims.writes(outputs.scan, "--scan");
  const std::array per_frame = {std::pair(outputs.ply, "--ply"),
                                std::pair(outputs.overlay, "--overlay"),
                                std::pair(outputs.top_view, "--top-view"),
                                std::pair(outputs.flies, "--flies"),
                                std::pair(outputs.histogram, "--histogram"),
                                std::pair(outputs.concentrating, "--concentrating")};
  for (const auto& [path, option] : per_frame) {
    if (path.empty()) continue;
    require_named_output(path, option, std::string_view(option) == "--ply" ? ".ply" : ".png");
    for (const auto& pair : pairs) claims.writes(path_of_frame(path, file_stem(pair.left), pairs.size() == 1), option);
  }
}
