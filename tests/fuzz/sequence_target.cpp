#include <algorithm>
#include <cmath>
#include <random>

#include "flies/core/error.hpp"
#include "flies/pipeline/tracker.hpp"
#include "tests/fuzz/pictures.hpp"
#include "tests/fuzz/sound.hpp"
#include "tests/fuzz/target.hpp"

namespace {

using flies::testing::require;

constexpr int kWidth_px = 160, kHeight_px = 96;

void require_sound(const flies::Track& track) {
  for (const double value : {track.state.x_m, track.state.y_m, track.state.vx_mps, track.state.vy_mps, track.width_m,
                             track.height_m, track.age_s, track.unseen_s, track.person_log_odds})
    require(std::isfinite(value));
  require(track.probability >= 0.0 && track.probability <= 1.0 && track.id > 0);
  flies::testing::require_sound(track.box);
}

}  // namespace

// A sequence of pairs, two bytes each: what the picture shows, and how long after the one before it came. The first
// byte says which preset follows it.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const flies::StereoCamera camera{120, 120, 80, 80, 40, 0.5, kWidth_px, kHeight_px, {}};
  auto options =
      flies::preset_options(static_cast<flies::Preset>(data[0] % flies::EnumNames<flies::Preset>::names.size()));
  options.threads = 1;
  flies::Tracker tracker(camera, options);
  std::mt19937 random(data[0]);
  double time_s = 0.0;
  for (std::size_t at = 1; at + 1 < std::min<std::size_t>(size, 33); at += 2) {
    const unsigned what = data[at];
    const auto left = flies::testing::picture(what, kWidth_px, kHeight_px, random);
    const auto right = what & 128U ? flies::testing::picture(what, kWidth_px, kHeight_px, random)
                                   : flies::testing::moved(left, static_cast<int>(what / 4 % 32));
    time_s += (int{data[at + 1]} - 8) * 0.02;
    try {
      const auto found = tracker.process({left.view(), right.view()}, time_s);
      flies::testing::require_sound(found.detection);
      for (const auto& track : found.tracks) require_sound(track);
      require(std::isfinite(found.ego.dt_s));
    } catch (const flies::InputError&) {
    }
  }
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  return {std::string("\0\x05\x0d\x05\x0d\x05\x0d\x05\x0d\x05\x0d", 11),
          std::string("\1\x05\x0d\x45\x0d\x82\x0d\x03\xff\x04\x01\x05\x0d", 13),
          std::string("\2\x06\x0d\x07\x0d\x08\x0d\x09\x00\x0a\x08\x0b\x0d", 13)};
}
