// What scripts/soak runs: PAIRS pairs of a sequence through two trackers in turn, one of the pictures' size and one of
// half of it. Prints memory and open files on the way.
//   soak_tracks FOLDER PAIRS
// Exit status: 0 flat, 1 memory or files grew, 2 a fault in the input.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/mat_view.hpp"
#include "flies/eval/dataset.hpp"
#include "flies/pipeline/tracker.hpp"

namespace {

constexpr int kReports = 10;
constexpr double kMayGrow_mb = 8.0;

struct Use {
  double memory_mb = 0.0;
  int files = 0;
};

Use use_now() {
  Use use;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) use.memory_mb = std::stod(line.substr(6)) / 1024.0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++use.files;
  return use;
}

flies::GrayImage half(const flies::GrayImage& image) {
  flies::GrayImage small;
  small.width_px = image.width_px / 2;
  small.height_px = image.height_px / 2;
  small.pixels.resize(static_cast<std::size_t>(small.width_px) * static_cast<std::size_t>(small.height_px));
  cv::Mat target(small.height_px, small.width_px, CV_8UC1, small.pixels.data());
  cv::resize(flies::mat_of(image.view()), target, target.size(), 0, 0, cv::INTER_AREA);
  return small;
}

flies::StereoCamera half(flies::StereoCamera camera, const flies::GrayImage& image) {
  for (double* length : {&camera.fx_px, &camera.fy_px, &camera.cx_px, &camera.cx_right_px, &camera.cy_px}) *length /= 2;
  camera.width_px = image.width_px;
  camera.height_px = image.height_px;
  return camera;
}

/// Forth and back again, so that the sequence has no cut.
std::size_t there_and_back(std::size_t step, std::size_t count) {
  const std::size_t turn = 2 * (count - 1), at = step % turn;
  return at < count ? at : turn - at;
}

int soak(const std::string& folder, int pairs) {
  constexpr std::size_t kMostPairs = 60;
  const flies::Dataset dataset = flies::open_dataset(folder);
  if (dataset.pairs.size() < 2) throw flies::InputError(folder, "", "holds one pair, expected a sequence");
  std::array<std::vector<flies::GrayPair>, 2> images;
  flies::StereoCamera camera;
  for (std::size_t i = 0; i < std::min(kMostPairs, dataset.pairs.size()); ++i) {
    flies::TruthFrame frame = dataset.load(i);
    camera = frame.camera;
    images[1].push_back({half(frame.images.left), half(frame.images.right)});
    images[0].push_back(std::move(frame.images));
  }
  std::array<flies::Tracker, 2> trackers = {flies::Tracker(camera), flies::Tracker(half(camera, images[1][0].left))};

  fmt::print("{:>8} {:>10} {:>6} {:>7}\n", "pairs", "memory MB", "files", "tracks");
  Use settled;
  bool is_flat = true;
  std::size_t tracks = 0;
  for (int done = 0; done < pairs;) {
    const auto size = static_cast<std::size_t>(done % 2), step = static_cast<std::size_t>(done / 2);
    const auto& pair = images[size][there_and_back(step, images[size].size())];
    tracks = trackers[size].process(pair.view(), 0.1 * static_cast<double>(step)).tracks.size();
    ++done;
    if (done % std::max(1, pairs / kReports) != 0) continue;
    const Use use = use_now();
    fmt::print("{:>8} {:>10.1f} {:>6} {:>7}\n", done, use.memory_mb, use.files, tracks);
    std::fflush(stdout);
    if (settled.files == 0) settled = use;
    is_flat = is_flat && use.memory_mb <= settled.memory_mb + kMayGrow_mb && use.files <= settled.files;
  }
  if (!is_flat) fmt::print(stderr, "memory or open files grew by more than {} MB or 0 files\n", kMayGrow_mb);
  return is_flat ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 || std::atoi(argv[2]) < kReports) {
    fmt::print(stderr, "usage: soak_tracks FOLDER PAIRS, at least {} pairs\n", kReports);
    return 2;
  }
  try {
    return soak(argv[1], std::atoi(argv[2]));
  } catch (const flies::InputError& error) {
    fmt::print(stderr, "soak_tracks: {}\n", error.what());
    return 2;
  }
}
