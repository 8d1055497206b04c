// What Intel's rs-enumerate-devices -c prints (librealsense, tools/enumerate-devices): stereo modules of the D400
// series, rectified by the camera, and fisheyes of the T265; metres.
#include "flies/io/formats/realsense.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/formats/camera_modes.hpp"
#include "flies/io/formats/cross_checks.hpp"
#include "flies/io/formats/raw_pair.hpp"
#include "flies/io/number_lines.hpp"

namespace flies::detail {
namespace {

// Blocks by their first lines as the tool writes them, with single blanks.
constexpr std::string_view kIntrinsic = "Intrinsic of \"", kExtrinsic = "Extrinsic from \"";

/// Without blanks at its ends, and with single ones within.
std::string squeezed(std::string_view line) {
  std::string words;
  for (const char c : line) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
      words += c;
    else if (!words.empty() && words.back() != ' ')
      words += ' ';
  }
  if (!words.empty() && words.back() == ' ') words.pop_back();
  return words;
}

/// What stands before the formats of pixels ("/ {Y8}") or the colon at the end.
std::string title_of(const std::string& line) {
  std::string title = line.substr(0, line.find(" / {"));
  while (!title.empty() && (title.back() == ':' || title.back() == ' ')) title.pop_back();
  return title;
}

using Block = std::map<std::string, NumberEntry, std::less<>>;

void add_block(const std::string& title, const Block& block, NumberTable& table) {
  for (const auto& [name, entry] : block) {
    const auto [at, is_new] = table.entries.emplace(title + "." + name, entry);
    if (!is_new && at->second.numbers != entry.numbers)
      throw InputError(table.source, title, "stands in the file twice: keep the part of one camera");
  }
}

struct StreamNames {
  const char *left, *right;
};
constexpr StreamNames kStreams[] = {{"Infrared 1", "Infrared 2"}, {"Fisheye 1", "Fisheye 2"}};

std::string intrinsic_of(const char* stream, ImageSize size) {
  return fmt::format("{}{}\" / {}x{}", kIntrinsic, stream, size.width_px, size.height_px);
}

std::string extrinsic_of(const char* from, const char* to) {
  return fmt::format("{}{}\" To \"{}\"", kExtrinsic, from, to);
}

/// Sizes for which the file has both cameras, the largest first.
std::vector<ImageSize> sizes_of(const NumberTable& table, const StreamNames& streams) {
  const std::string start = fmt::format("{}{}\" / ", kIntrinsic, streams.left), end = ".Fx";
  std::vector<ImageSize> sizes;
  for (auto at = table.entries.lower_bound(start); at != table.entries.end() && at->first.starts_with(start); ++at) {
    if (!at->first.ends_with(end)) continue;
    const std::string title = at->first.substr(0, at->first.size() - end.size());
    const ImageSize size{table.require_size(title + ".Width"), table.require_size(title + ".Height")};
    if (table.has(intrinsic_of(streams.right, size) + end)) sizes.push_back(size);
  }
  std::ranges::sort(sizes, std::greater<>(), [](ImageSize s) { return std::pair(s.width_px, s.height_px); });
  return sizes;
}

RawCamera camera_of(const NumberTable& table, const std::string& title) {
  const auto number = [&](const char* name) { return table.require_number(title + name); };
  RawCamera camera;
  camera.matrix = camera_matrix(number(".Fx"), number(".Fy"), number(".PPX"), number(".PPY"));
  constexpr std::size_t kCoefficients = 5, kOfFisheye = 4;
  camera.distortion = table.require(title + ".Coeffs", kCoefficients);
  const std::string key = title + ".Distortion", model = table.word(key);
  const bool is_bent = std::ranges::any_of(camera.distortion, [](double c) { return c != 0.0; });
  camera.lens = lens_of_model(model.empty() ? "none" : model, is_bent, key, table.source).value_or(Lens::brown);
  if (camera.lens == Lens::equidistant) camera.distortion.resize(kOfFisheye);
  return camera;
}

/// That of the left camera's points, or the inverse of that of the right one's where the file has only this.
Pose pose_between(const NumberTable& table, const StreamNames& streams, const CalibrationRequest& request,
                  CalibrationNotes& notes) {
  const auto read = [&](const std::string& title) {
    Pose pose{matrix_of(table, title + ".Rotation Matrix"), {}};
    std::ranges::copy(table.require(title + ".Translation Vector", 3), pose.translation.begin());
    return pose;
  };
  const std::string there = extrinsic_of(streams.left, streams.right), back = extrinsic_of(streams.right, streams.left);
  const auto has = [&](const std::string& title) { return table.has(title + ".Translation Vector"); };
  if (has(back) && !has(there)) return inverse(read(back));
  const Pose pose = read(there);
  constexpr std::size_t kCount = 3;
  if (has(back) && table.entries.at(back + ".Translation Vector").numbers.size() == kCount)
    note_other_baseline(length_of(there, pose), length_of(back, read(back)), request, notes);
  return pose;
}

Calibration read_realsense(const NumberTable& table, const CalibrationRequest& request) {
  const bool is_fisheye = sizes_of(table, kStreams[0]).empty() && !sizes_of(table, kStreams[1]).empty();
  const StreamNames& streams = kStreams[is_fisheye ? 1 : 0];
  const auto sizes = sizes_of(table, streams);
  if (sizes.empty())
    throw InputError(table.source, "Infrared 1, Infrared 2",
                     "no size has intrinsics of both: print them with rs-enumerate-devices -c, of a stereo camera");
  std::vector<CameraMode> modes(sizes.size());
  std::ranges::transform(sizes, modes.begin(), [&](ImageSize size) {
    return CameraMode{size.width_px, size.height_px, table.require_number(intrinsic_of(streams.left, size) + ".Fx")};
  });
  auto chosen = choose_mode(modes, request, table.source);
  const ImageSize size = sizes[chosen.index];
  const std::string left = intrinsic_of(streams.left, size), right = intrinsic_of(streams.right, size);
  RawPair pair{{size.width_px, size.height_px, camera_of(table, left), camera_of(table, right)},
               left,
               right,
               extrinsic_of(streams.left, streams.right),
               std::move(chosen.notes)};
  set_pose(pair.stereo, pose_between(table, streams, request, pair.notes));
  if (request.width_px == 0 && request.calibrated_width_px == 0 && sizes.size() > 1)
    pair.notes.push_back({fmt::format("of {} sizes in the file the largest was taken, {} x {} px", sizes.size(),
                                      size.width_px, size.height_px),
                          CalibrationNoteKind::told});
  return calibration_from_pair(std::move(pair), request, table.source);
}

}  // namespace

bool parse_realsense(const std::string& text, NumberTable& table) {
  std::istringstream stream(text);
  std::string title, key;
  Block block;
  bool is_known = false;
  for (std::string raw; std::getline(stream, raw);) {
    const std::string line = squeezed(raw);
    if (line.empty()) continue;
    if (line.starts_with(kIntrinsic) || line.starts_with(kExtrinsic)) {
      add_block(title, block, table);
      block.clear();
      title = title_of(line);
      key.clear();
      is_known = true;
    } else if (const auto colon = line.find(':'); colon != std::string::npos) {
      key = line.substr(0, colon);
      NumberEntry entry;
      const std::string value = squeezed(line.substr(colon + 1));
      if (key == "Distortion")
        entry.not_a_number = value;
      else
        append_words(entry, value);
      if (!title.empty()) block[key] = std::move(entry);
    } else if (key == "Rotation Matrix" && !title.empty()) {
      append_words(block[key], line);
    }
  }
  add_block(title, block, table);
  return is_known;
}

const CalibrationFormat kRealSense{"RealSense, rs-enumerate-devices -c", false, false,
                                   [](const NumberTable& table) {
                                     const auto first = table.entries.lower_bound(kIntrinsic);
                                     return first != table.entries.end() && first->first.starts_with(kIntrinsic);
                                   },
                                   read_realsense};

}  // namespace flies::detail
