#include "shared/sequence_source.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "channels/recording.hpp"
#include "flies/core/error.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/images.hpp"
#include "flies/io/time_stamps.hpp"

namespace fs = std::filesystem;

namespace {

constexpr double kUsualRate_hz = 10.0;  // of KITTI

fs::path camera_folder(const fs::path& drive, int camera) { return drive / fmt::format("image_{:02}", camera); }

std::array<int, 2> cameras_of(const fs::path& drive, const SequenceRequest& request) {
  if (request.cameras) return *request.cameras;
  return flies::detail::is_there(camera_folder(drive, 0)) && flies::detail::is_there(camera_folder(drive, 1))
             ? std::array{0, 1}
             : std::array{2, 3};
}

/// What `flies synth --sequence` makes.
bool is_drawn(const fs::path& folder) {
  return flies::detail::is_there_as_folder(folder / "left") && flies::detail::is_there_as_folder(folder / "right") &&
         flies::detail::is_there(folder / "times.txt") && flies::detail::is_there(folder / "calib.yaml");
}

std::vector<double> even_times(std::size_t count, double rate_hz) {
  std::vector<double> times_s(count);
  for (std::size_t i = 0; i < count; ++i) times_s[i] = static_cast<double>(i) / rate_hz;
  return times_s;
}

/// The first `count` times of a file: a part of a drive has the times of all of it.
std::vector<double> times_of(const std::string& file, std::size_t count) {
  auto times_s = flies::read_time_stamps(file);
  if (times_s.size() < count)
    throw flies::InputError(file, "", fmt::format("holds {} times, expected {}, one a pair", times_s.size(), count));
  times_s.resize(count);
  return times_s;
}

bool is_recording(const std::string& source) {
  return (source.ends_with(".mcap") || source.ends_with(".bag")) && !flies::detail::is_there_as_folder(source);
}

void open_recording(SequenceSource& source, const std::string& path,
                    const std::optional<std::array<std::string, 2>>& topics) {
  if (source.reading.split != flies::Split::none || source.reading.bayer)
    throw flies::InputError(path, "--split, --bayer",
                            "are for image files; a recording says itself what its pictures are");
  source.recording = std::make_shared<Recording>(path, topics);
  for (std::size_t i = 0; i < source.recording->size(); ++i) {
    source.pairs.push_back({source.recording->name(i, false), source.recording->name(i, true)});
    source.times_s.push_back(source.recording->time_s(i));
  }
  source.notes = source.recording->notes();
  if (source.calib.empty()) source.calib = path;
}

}  // namespace

flies::GrayPair SequenceSource::load(std::size_t pair) const {
  return recording ? recording->pair(pair) : flies::load_pair(pairs[pair], reading);
}

SequenceSource open_sequence(const SequenceRequest& request) {
  SequenceSource source;
  source.calib = request.calib;
  source.reading = request.reading;
  std::string own_times;
  if (request.sources.size() == 1 && is_recording(request.sources[0])) {
    open_recording(source, request.sources[0], request.topics);
  } else if (request.reading.split != flies::Split::none) {
    if (request.sources.size() > 1)
      throw flies::InputError("SOURCE", request.sources[1], "is not needed: with --split one file holds both images");
    if (source.calib.empty()) throw flies::InputError("command line", "--calib", "is missing, expected a file");
    source.pairs = flies::find_joined_pairs(request.sources[0]);
  } else if (request.sources.size() == 1 && is_drawn(request.sources[0])) {
    const fs::path folder = request.sources[0];
    source.pairs = flies::find_pairs((folder / "left").string(), (folder / "right").string());
    own_times = (folder / "times.txt").string();
    if (source.calib.empty()) source.calib = (folder / "calib.yaml").string();
  } else if (request.sources.size() == 1) {
    const fs::path drive = request.sources[0];
    const auto [left, right] = cameras_of(drive, request);
    if (!flies::detail::is_there_as_folder(camera_folder(drive, left) / "data") ||
        !flies::detail::is_there_as_folder(camera_folder(drive, right) / "data"))
      throw flies::InputError(request.sources[0], "",
                              "is no KITTI raw drive (image_00/data and image_01/data), no folder of flies synth "
                              "--sequence and no recording (.mcap, .bag), expected one, or two folders");
    source.pairs = flies::find_pairs((camera_folder(drive, left) / "data").string(),
                                     (camera_folder(drive, right) / "data").string());
    own_times = (camera_folder(drive, left) / "timestamps.txt").string();
    if (source.calib.empty())
      source.calib =
          (fs::absolute(drive).lexically_normal() / ".." / "calib_cam_to_cam.txt").lexically_normal().string();
  } else {
    if (source.calib.empty()) throw flies::InputError("command line", "--calib", "is missing, expected a file");
    source.pairs = flies::find_pairs(request.sources[0], request.sources[1]);
  }

  const std::size_t count = source.pairs.size();
  if (!request.times.empty()) {
    source.times_s = times_of(request.times, count);
  } else if (request.rate_hz) {
    source.times_s = even_times(count, *request.rate_hz);
  } else if (source.recording) {
    // has its own
  } else if (!own_times.empty() && flies::detail::is_there(own_times)) {
    source.times_s = times_of(own_times, count);
  } else {
    source.times_s = even_times(count, kUsualRate_hz);
    source.notes.push_back(fmt::format("no times given, {} pairs a second assumed (--rate, --times)", kUsualRate_hz));
  }
  return source;
}
