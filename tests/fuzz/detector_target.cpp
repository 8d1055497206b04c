#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"
#include "tests/fuzz/pictures.hpp"
#include "tests/fuzz/sound.hpp"
#include "tests/fuzz/target.hpp"

namespace {

using flies::testing::Picture;

/// Draws numbers from the input; zeros behind its end.
class Draws {
 public:
  Draws(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  unsigned byte() { return at_ < size_ ? data_[at_++] : 0U; }
  double share() { return (byte() * 256.0 + byte()) / 65535.0; }
  double between(double low, double high) { return low + share() * (high - low); }
  /// Of any order of magnitude.
  double scale(double low, double high) { return low * std::pow(high / low, share()); }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

flies::StereoCamera draw_camera(Draws& draws, int width_px, int height_px) {
  flies::StereoCamera camera;
  camera.fx_px = draws.scale(1e-2, 1e6);
  camera.fy_px = draws.byte() % 2 == 0 ? camera.fx_px : draws.scale(1e-2, 1e6);
  camera.cx_px = draws.between(-width_px, 2 * width_px);
  camera.cx_right_px = draws.byte() % 2 == 0 ? camera.cx_px : draws.between(-width_px, 2 * width_px);
  camera.cy_px = draws.between(-height_px, 2 * height_px);
  camera.baseline_m = draws.scale(1e-4, 1e3);
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.mount = {draws.scale(1e-2, 1e3), flies::radians(draws.between(-45, 45)),
                  flies::radians(draws.between(-45, 45))};
  return camera;
}

/// A quarter of the options anywhere in their ranges.
/// @param are_counts_wide counts as well, of any order of magnitude; else up to 64
void draw_options(Draws& draws, bool are_counts_wide, flies::DetectorOptions& options) {
  flies::detail::for_each_leaf(
      options, "", [&]<class T>(const std::string&, T& field, flies::Range range, std::string_view) {
        if (draws.byte() % 4 != 0) return;
        if constexpr (std::same_as<T, bool>)
          field = draws.byte() % 2 == 0;
        else if constexpr (std::same_as<T, double>)
          field = draws.between(std::max(range.min, -1e6), std::min(range.max, 1e6));
        else if constexpr (flies::NamedEnum<T>)
          field = static_cast<T>(draws.byte() % flies::EnumNames<T>::names.size());
        else if constexpr (std::same_as<T, int>)
          field = static_cast<int>(are_counts_wide ? draws.scale(1.0, range.max - range.min + 1.0) + range.min - 1.0
                                                   : draws.between(range.min, std::min(range.max, 64.0)));
      });
}

/// Those that only cost time in a part of their ranges, which is hardly less than what someone would ask for.
void limit_time(flies::DetectorOptions& options) {
  constexpr int kMostScored = 300'000, kMostProbes = 5000;
  options.threads = 1;
  options.evolve.flies = std::min(options.evolve.flies, kMostScored / 10);
  options.evolve.generations = std::min(options.evolve.generations, kMostScored / options.evolve.flies);
  options.road.probes = std::min(options.road.probes, kMostProbes);
  options.concentrate.view_angle_deg = std::max(0.5, options.concentrate.view_angle_deg);
  options.concentrate.bin_m = std::max(0.25, options.concentrate.bin_m);
  if (options.propose.step > 0.0) options.propose.step = std::max(0.05, options.propose.step);
}

/// Left and right: moved as a whole, each of its own, or moved as a road with a thing on it.
std::array<Picture, 2> draw_pair(unsigned kind, int disparity_px, int width_px, int height_px, std::mt19937& random) {
  const Picture left = flies::testing::picture(kind, width_px, height_px, random);
  if (kind / 4 % 3 == 0) return {left, flies::testing::moved(left, disparity_px)};
  if (kind / 4 % 3 == 1) return {left, flies::testing::moved_as_road(left, disparity_px)};
  return {left, flies::testing::picture(kind, width_px, height_px, random)};
}

/// As the program takes it for a preset.
std::shared_ptr<const flies::PeopleClassifier> classifier_of(flies::Preset preset) {
  static const auto standard = flies::default_people_classifier(),
                    paper = flies::preset_classifier(flies::Preset::paper);
  return preset == flies::Preset::paper ? paper : standard;
}

}  // namespace

// Any camera, and options within their ranges beside those of a preset, and two pairs of pictures. What was added later
// is read last, and by zeros is as it was before: `default`, noise, counts up to 64, one pair twice.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Draws draws(data, size);
  const int width_px = 1 + static_cast<int>(draws.byte()), height_px = 1 + static_cast<int>(draws.byte()) / 2;
  std::mt19937 random(draws.byte());
  const int disparity_px = static_cast<int>(draws.byte() % 32);
  const auto camera = draw_camera(draws, width_px, height_px);
  Draws of_options = draws;
  flies::DetectorOptions passed_over;
  draw_options(draws, false, passed_over);
  const auto preset = static_cast<flies::Preset>(draws.byte() % flies::EnumNames<flies::Preset>::names.size());
  const unsigned kind = draws.byte();
  const bool are_counts_wide = draws.byte() % 2 == 1, is_fitted = draws.byte() % 2 == 1;
  auto pair = draw_pair(kind, disparity_px, width_px, height_px, random);
  try {
    auto options = flies::preset_options(preset);
    if (is_fitted) options = flies::fitted_options(camera, options);
    draw_options(of_options, are_counts_wide, options);
    limit_time(options);
    flies::Detector detector(camera, options, classifier_of(preset));
    for (int i = 0; i < 2; ++i) {
      flies::testing::require_sound(detector.process({pair[0].view(), pair[1].view()}));
      if (kind & 128U) pair = draw_pair(kind, disparity_px, width_px, height_px, random);
    }
  } catch (const flies::InputError&) {
  }
  return 0;
}

namespace {

/// An input that draws the camera of a car, and one option in sixteen; of every second kind it draws thresholds that
/// take everything for a person.
std::string good_input(unsigned preset, unsigned kind, bool are_counts_wide, bool is_fitted, std::mt19937& random) {
  std::string input;
  const auto add = [&](unsigned byte) { input.push_back(static_cast<char>(byte)); };
  const auto chance = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
  const auto add_share = [&](double share) { add(static_cast<unsigned>(share * 255.0)), add(chance(256)); };
  // 256 x 128 px; focal length, principal points, baseline and mount as `draw_camera` reads them.
  for (const unsigned byte : {255U, 255U, chance(256), 4 + chance(16)}) add(byte);
  add_share(0.53), add(0), add_share(0.5), add(0), add_share(0.47), add_share(0.5), add_share(0.435), add_share(0.52),
      add_share(0.5);
  flies::DetectorOptions options;
  flies::detail::for_each_leaf(options, "", [&]<class T>(const std::string& path, T&, flies::Range, std::string_view) {
    const bool is_least = kind % 2 == 0 && path.starts_with("classify."), is_drawn = is_least || chance(16) == 0;
    add(is_drawn ? 0 : 1);
    if (!is_drawn || std::same_as<T, std::uint64_t>) return;
    const int bytes = std::same_as<T, double> || std::same_as<T, int> ? 2 : 1;
    for (int i = 0; i < bytes; ++i) add(is_least ? 0 : chance(256));
  });
  for (const unsigned byte : {preset, kind, unsigned{are_counts_wide}, unsigned{is_fitted}}) add(byte);
  return input;
}

}  // namespace

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds;
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    std::string& seed = seeds.emplace_back();
    for (int k = 0; k < 300; ++k) seed.push_back(static_cast<char>(random() & 255U));
  }
  for (unsigned preset = 0; preset < flies::EnumNames<flies::Preset>::names.size(); ++preset)
    for (unsigned kind = 0; kind < 12; ++kind)
      seeds.push_back(good_input(preset, kind + (kind % 2) * 128, kind % 4 == 3, kind % 3 == 2, random));
  return seeds;
}
