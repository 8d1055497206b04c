#include "shared/sequence_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <utility>

#include "channels/recording.hpp"
#include "flies/core/error.hpp"
#include "flies/core/quantile.hpp"
#include "flies/io/folder.hpp"
#include "flies/io/image_folder.hpp"
#include "flies/io/image_names.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_matching.hpp"
#include "flies/io/time_stamps.hpp"
#include "shared/recording_file.hpp"

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

std::vector<std::string> left_images(const std::vector<flies::PairPaths>& pairs) {
  std::vector<std::string> images;
  for (const auto& pair : pairs) images.push_back(pair.left);
  return images;
}

/// What is told where the numbers in the names of pairs jump: the first jump.
std::string jump(const std::vector<flies::PairPaths>& pairs, std::size_t after) {
  const auto name = [&](std::size_t i) { return fs::path(pairs[i].left).filename().string(); };
  return fmt::format("the numbers in the names jump from {} to {}", name(after - 1), name(after));
}

/// What is told where pairs of a recording are missing: the first place.
std::string gap(const Recording& recording, std::size_t after) {
  return fmt::format("{}: pairs {} and {} are farther apart than others", recording.path(), after - 1, after);
}

/// How much the numbers in the names grow from pair to pair, or how far the pairs of a recording are apart; empty where
/// that is not known.
std::vector<std::int64_t> steps_of(const SequenceSource& source) {
  if (source.recording) return source.recording->steps();
  std::vector<std::int64_t> steps;
  const auto numbers = flies::numbers_in_names(left_images(source.pairs));
  if (!numbers) return steps;
  for (std::size_t i = 1; i < numbers->size(); ++i) steps.push_back((*numbers)[i] - (*numbers)[i - 1]);
  return steps;
}

/// Times at a rate. Where pairs are missing they jump.
std::vector<double> even_times(const SequenceSource& source, double rate_hz, std::vector<std::string>& notes) {
  const std::size_t count = source.pairs.size();
  std::vector<double> times_s(count);
  for (std::size_t i = 0; i < count; ++i) times_s[i] = static_cast<double>(i) / rate_hz;
  const auto steps = steps_of(source);
  if (steps.empty()) return times_s;
  const std::int64_t usual = *std::min_element(steps.begin(), steps.end());  // 2 where every second image is there
  const auto odd = std::find_if(steps.begin(), steps.end(), [&](std::int64_t step) { return step != usual; });
  if (odd == steps.end()) return times_s;
  const std::size_t after = static_cast<std::size_t>(odd - steps.begin()) + 1;
  const std::string where = source.recording ? gap(*source.recording, after) : jump(source.pairs, after);
  if (std::any_of(steps.begin(), steps.end(), [&](std::int64_t step) { return step % usual != 0; })) {
    notes.push_back(
        fmt::format("{}: {}, so evenly spaced times are assumed (--times gives others)", where,
                    source.recording ? "how many are missing is not clear" : "they do not count the pairs"));
    return times_s;
  }
  std::int64_t steps_before = 0;
  for (std::size_t i = 1; i < count; ++i) {
    steps_before += steps[i - 1];
    times_s[i] = static_cast<double>(steps_before) / static_cast<double>(usual) / rate_hz;
  }
  notes.push_back(where + ": pairs are missing, and the times jump too (--times gives others)");
  return times_s;
}

/// The times of a file. Where it holds more than there are pairs, as of a part of a drive, the numbers in the names say
/// which; else the first ones are taken.
std::vector<double> times_of(const std::string& file, const std::vector<flies::PairPaths>& pairs,
                             std::vector<std::string>& notes) {
  auto times_s = flies::read_time_stamps(file);
  const std::size_t count = pairs.size(), held = times_s.size();
  if (held < count)
    throw flies::InputError(file, "", fmt::format("holds {} times, expected {}, one per pair", held, count));
  if (held == count) return times_s;
  const auto numbers = flies::numbers_in_names(left_images(pairs));
  const auto last = static_cast<std::int64_t>(held);
  if (!numbers || numbers->front() < 0 || numbers->back() > last || (numbers->back() == last && numbers->front() < 1)) {
    notes.push_back(
        fmt::format("{}: holds {} times for {} pairs, and the names of the images do not say which time belongs to "
                    "which pair: the first {} are used",
                    file, held, count, count));
    times_s.resize(count);
    return times_s;
  }
  const std::int64_t first_number = numbers->back() == last ? 1 : 0;
  std::vector<double> chosen_s;
  for (const std::int64_t number : *numbers)
    chosen_s.push_back(times_s[static_cast<std::size_t>(number - first_number)]);
  for (double& time_s : chosen_s) time_s -= times_s[static_cast<std::size_t>(numbers->front() - first_number)];
  notes.push_back(
      fmt::format("{}: holds {} times for {} pairs: times are chosen by the numbers in the names of the images", file,
                  held, count));
  for (std::size_t i = 1; i < count; ++i)
    if ((*numbers)[i] != (*numbers)[i - 1] + 1) {
      notes.back() += ": " + jump(pairs, i);
      break;
    }
  return chosen_s;
}

/// Times from pair to pair.
std::vector<double> steps_s(const std::vector<double>& times_s) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  return steps_s;
}

/// Tells of times between which nothing can be followed, from the first pair to the last.
void doubt_slow_times(const std::string& file, const std::vector<double>& times_s, std::vector<std::string>& notes) {
  constexpr double kLeast_s = 5.0;
  if (times_s.size() < 2) return;
  const double shortest_s = std::ranges::min(steps_s(times_s));
  if (shortest_s < kLeast_s) return;
  const char* unit = shortest_s < 1e3 * kLeast_s   ? "milliseconds"
                     : shortest_s < 1e6 * kLeast_s ? "microseconds"
                                                   : "nanoseconds";
  notes.push_back(
      fmt::format("{}: pairs are {:.4g} s apart or more, too long to follow anything: are these {}? expected seconds",
                  file, shortest_s, unit));
}

/// Tells of times that are closer together than any stereo camera takes pairs.
/// @param where they stand
void doubt_fast_times(const std::string& where, const std::vector<double>& times_s, std::vector<std::string>& notes) {
  constexpr double kLeast_s = 0.99e-3;
  if (times_s.size() < 2) return;
  const double usual_s = flies::upper_median(steps_s(times_s));
  if (usual_s >= kLeast_s) return;
  notes.push_back(fmt::format(
      "{}: pairs are {:.3g} ms apart (median), closer than stereo cameras take them, so that speeds come "
      "out far too high: was a unit mistaken, such as microseconds for nanoseconds? --rate or --times gives "
      "other times",
      where, 1e3 * usual_s));
}

/// The times of a file for a recording: one a pair, or one a left picture, those without a partner too.
std::vector<double> times_of(const std::string& file, const Recording& recording, std::vector<std::string>& notes) {
  auto times_s = flies::read_time_stamps(file);
  const std::size_t count = recording.size(), held = times_s.size();
  if (held == count) return times_s;
  const std::size_t pictures = recording.left_count();
  if (held != pictures)
    throw flies::InputError(
        file, "",
        fmt::format("holds {} times, expected {}, one per pair{}", held, count,
                    pictures == count ? "" : fmt::format(", or {}, one per left picture", pictures)));
  std::vector<double> chosen_s;
  for (std::size_t i = 0; i < count; ++i)
    chosen_s.push_back(times_s[recording.left_number(i)] - times_s[recording.left_number(0)]);
  notes.push_back(fmt::format("{}: holds {} times for {} pairs: times are chosen by the numbers of the left pictures",
                              file, held, count));
  return chosen_s;
}

/// Times in the names of the pairs, seconds since the first; nothing when they have none, or do not ascend.
std::optional<std::vector<double>> named_times(const std::vector<flies::PairPaths>& pairs) {
  auto times_s = flies::times_in_names(left_images(pairs));
  if (!times_s || pairs.size() < 2) return std::nullopt;
  if (std::adjacent_find(times_s->begin(), times_s->end(), std::greater_equal()) != times_s->end()) return std::nullopt;
  const double first_s = times_s->front();
  for (double& time_s : *times_s) time_s -= first_s;
  return times_s;
}

bool is_drive(const fs::path& folder, const SequenceRequest& request) {
  return std::ranges::all_of(cameras_of(folder, request), [&](int camera) {
    return flies::detail::is_there_as_folder(camera_folder(folder, camera) / "data");
  });
}

bool holds_joined_images(const std::string& folder, flies::Split split) {
  return split != flies::Split::none &&
         std::ranges::any_of(flies::detail::files_of(folder), flies::detail::is_image_name);
}

/// The recording that is asked for; nothing when it is images. Folders of images may hold one beside them.
std::optional<std::string> recording_in(const SequenceRequest& request) {
  if (request.sources.size() != 1) return std::nullopt;
  const std::string& source = request.sources[0];
  if (flies::detail::is_there_as_folder(source) &&
      (holds_joined_images(source, request.reading.split) || is_drawn(source) || is_drive(source, request)))
    return std::nullopt;
  return recording_of(source);
}

void open_recording(SequenceSource& source, const std::string& path, const std::vector<std::string>& topics) {
  source.recording = std::make_shared<Recording>(path, topics, source.reading);
  if (source.reading.split != flies::Split::none && source.calib.empty())
    throw flies::InputError(
        "command line", "--calib",
        "is missing, expected a file: a recording has no calibration of both images in one picture");
  for (std::size_t i = 0; i < source.recording->size(); ++i) {
    source.pairs.push_back({source.recording->name(i, false), source.recording->name(i, true)});
    source.times_s.push_back(source.recording->time_s(i));
  }
  source.notes = source.recording->notes();
  source.files.push_back(path);
  if (source.calib.empty()) source.calib = path;
}

/// Says where a source's own times stand; nothing when it has none.
std::optional<std::string> place_of_times(const SequenceSource& source, const std::string& own_times) {
  if (source.recording) return "those of the recording";
  if (!own_times.empty()) return "those in " + own_times;
  return named_times(source.pairs) ? std::optional<std::string>("those in the names of the images") : std::nullopt;
}

void refuse_topics(const SequenceRequest& request) {
  if (!request.topics.empty())
    throw flies::InputError(
        "command line", "--topics",
        fmt::format("are those of a recording (.mcap, .bag), and {} is not one", request.sources[0]));
}

void open_folders(SequenceSource& source, const std::string& left, const std::string& right) {
  auto found = flies::match_all(left, right);
  source.pairs = std::move(found.pairs);
  source.notes = std::move(found.notes);
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
  const auto recording = recording_in(request);
  if (!recording) refuse_topics(request);
  if (recording) {
    open_recording(source, *recording, request.topics);
  } else if (request.reading.split != flies::Split::none) {
    if (request.sources.size() > 1)
      throw flies::InputError("SOURCE", request.sources[1], "is not needed: with --split one file holds both images");
    if (source.calib.empty()) throw flies::InputError("command line", "--calib", "is missing, expected a file");
    source.pairs = flies::find_joined_pairs(request.sources[0]);
  } else if (request.sources.size() == 1 && is_drawn(request.sources[0])) {
    const fs::path folder = request.sources[0];
    open_folders(source, (folder / "left").string(), (folder / "right").string());
    own_times = (folder / "times.txt").string();
    if (source.calib.empty()) source.calib = (folder / "calib.yaml").string();
  } else if (request.sources.size() == 1) {
    const fs::path drive = request.sources[0];
    const auto [left, right] = cameras_of(drive, request);
    if (!flies::detail::is_there(drive)) throw flies::InputError(request.sources[0], "", "does not exist");
    if (!flies::detail::is_there_as_folder(drive))
      throw flies::InputError(request.sources[0], "",
                              "is a file, expected a recording (.mcap, .bag) or a folder; films are for flies live");
    if (!is_drive(drive, request))
      throw flies::InputError(
          request.sources[0], "",
          "is neither a KITTI raw drive (image_00/data and image_01/data) nor a folder of flies synth --sequence nor a "
          "recording (.mcap, .bag), expected one of these, or two folders of images");
    open_folders(source, (camera_folder(drive, left) / "data").string(),
                 (camera_folder(drive, right) / "data").string());
    own_times = (camera_folder(drive, left) / "timestamps.txt").string();
    if (source.calib.empty())
      source.calib =
          (fs::absolute(drive).lexically_normal() / ".." / "calib_cam_to_cam.txt").lexically_normal().string();
  } else {
    if (source.calib.empty()) throw flies::InputError("command line", "--calib", "is missing, expected a file");
    open_folders(source, request.sources[0], request.sources[1]);
  }
  if (!flies::detail::is_there(own_times)) own_times.clear();
  source.files.insert(source.files.end(), {own_times, source.calib});

  if (!request.times.empty()) {
    source.times_s = source.recording ? times_of(request.times, *source.recording, source.notes)
                                      : times_of(request.times, source.pairs, source.notes);
    doubt_slow_times(request.times, source.times_s, source.notes);
    doubt_fast_times(request.times, source.times_s, source.notes);
    if (request.rate_hz)
      source.notes.push_back(fmt::format("times are those in {} (--times), instead of {:.4g} pairs per second (--rate)",
                                         request.times, *request.rate_hz));
  } else if (request.rate_hz) {
    source.times_s = even_times(source, *request.rate_hz, source.notes);
    doubt_fast_times("--rate", source.times_s, source.notes);
    if (const auto place = place_of_times(source, own_times))
      source.notes.push_back(fmt::format("times are evenly spaced, {:.4g} pairs per second (--rate), instead of {}",
                                         *request.rate_hz, *place));
  } else if (source.recording) {
    doubt_slow_times(*recording, source.times_s, source.notes);  // its own
    doubt_fast_times(*recording, source.times_s, source.notes);
  } else if (!own_times.empty()) {
    source.times_s = times_of(own_times, source.pairs, source.notes);
    doubt_slow_times(own_times, source.times_s, source.notes);
    doubt_fast_times(own_times, source.times_s, source.notes);
  } else if (auto times_s = named_times(source.pairs)) {
    source.times_s = std::move(*times_s);
    doubt_fast_times("the names of the images", source.times_s, source.notes);
    source.notes.push_back(fmt::format(
        "times are those in the names of the images: {:.4g} pairs per second (--rate or --times gives others)",
        static_cast<double>(source.pairs.size() - 1) / source.times_s.back()));
  } else {
    source.notes.push_back(fmt::format(
        "the pairs have no times: {} pairs per second are assumed (--rate or --times gives others)", kUsualRate_hz));
    source.times_s = even_times(source, kUsualRate_hz, source.notes);
  }
  return source;
}
