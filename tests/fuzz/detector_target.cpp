#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "flies/core/error.hpp"
#include "flies/pipeline/detector.hpp"
#include "tests/fuzz/target.hpp"

namespace {

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

/// A quarter of the options anywhere in their ranges, those that only cost time in a small part of them.
flies::DetectorOptions draw_options(Draws& draws) {
  flies::DetectorOptions options;
  flies::detail::for_each_leaf(options, "",
                               [&]<class T>(const std::string&, T& field, flies::Range range, std::string_view) {
                                 if (draws.byte() % 4 != 0) return;
                                 if constexpr (std::same_as<T, bool>)
                                   field = draws.byte() % 2 == 0;
                                 else if constexpr (std::same_as<T, double>)
                                   field = draws.between(std::max(range.min, -1e6), std::min(range.max, 1e6));
                                 else if constexpr (flies::NamedEnum<T>)
                                   field = static_cast<T>(draws.byte() % flies::EnumNames<T>::names.size());
                                 else if constexpr (std::same_as<T, int>)
                                   field = static_cast<int>(draws.between(range.min, std::min(range.max, 64.0)));
                               });
  options.threads = 1;
  options.concentrate.view_angle_deg = std::max(0.5, options.concentrate.view_angle_deg);
  options.concentrate.bin_m = std::max(0.25, options.concentrate.bin_m);
  options.propose.step = std::max(0.05, options.propose.step);
  return options;
}

void require(bool ok) {
  if (!ok) std::abort();
}

void require_sound(const flies::ImageBox& box) {
  for (const double value : {box.u_px, box.v_px, box.width_px, box.height_px}) require(std::isfinite(value));
  require(box.width_px >= 0.0 && box.height_px >= 0.0);
}

void require_sound(const flies::Detection& found) {
  for (const auto& o : found.obstacles) {
    for (const double value :
         {o.x_m, o.y_m, o.range_m, o.width_m, o.middle_offset_m, o.depth_m, o.height_m, o.ground_z_m, o.score})
      require(std::isfinite(value));
    require_sound(o.box);
  }
  for (const auto& p : found.pedestrians) require_sound(p.box);
  for (const double score : found.roi_scores) require(score >= 0.0 && score <= 1.0);
  const auto& flies = found.evolved.flies;
  for (std::size_t i = 0; i < flies.size(); ++i)
    require(std::isfinite(flies.x_m[i]) && std::isfinite(flies.y_m[i]) && std::isfinite(flies.z_m[i]) &&
            std::isfinite(flies.fitness[i]));
}

}  // namespace

// Any camera and options within their ranges, and two pairs of pictures: noise, the right one shifted, one of a pixel.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Draws draws(data, size);
  const int width_px = 1 + static_cast<int>(draws.byte()), height_px = 1 + static_cast<int>(draws.byte()) / 2;
  std::mt19937 random(draws.byte());
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width_px * height_px) + 32);
  for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random() & 255U);
  const flies::GrayView left{pixels.data(), width_px, height_px, width_px};
  const flies::GrayView right{pixels.data() + draws.byte() % 32, width_px, height_px, width_px};
  try {
    const auto camera = draw_camera(draws, width_px, height_px);
    flies::Detector detector(camera, draw_options(draws));
    for (int pair = 0; pair < 2; ++pair) require_sound(detector.process({left, right}));
  } catch (const flies::InputError&) {
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds;
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    std::string& seed = seeds.emplace_back();
    for (int k = 0; k < 300; ++k) seed.push_back(static_cast<char>(random() & 255U));
  }
  return seeds;
}
