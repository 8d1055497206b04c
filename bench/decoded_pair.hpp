#pragma once

#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/stereo_camera.hpp"

/// A pair as a camera hands it over, decoded, with its calibration: what a program has before it looks for obstacles.
/// The file is for one build on one machine.
struct DecodedPair {
  flies::StereoCamera camera;
  std::vector<std::uint8_t> left, right;

  flies::RectifiedPair view() const {
    const auto image = [&](const auto& pixels) {
      return flies::GrayView{pixels.data(), camera.width_px, camera.height_px, camera.width_px};
    };
    return {image(left), image(right)};
  }
};
static_assert(std::is_trivially_copyable_v<flies::StereoCamera>);

inline void write_pair(const std::string& path, const DecodedPair& pair) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&pair.camera), sizeof(pair.camera));
  for (const auto* pixels : {&pair.left, &pair.right})
    file.write(reinterpret_cast<const char*>(pixels->data()), static_cast<std::streamsize>(pixels->size()));
}

inline DecodedPair read_pair(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  DecodedPair pair;
  file.read(reinterpret_cast<char*>(&pair.camera), sizeof(pair.camera));
  for (auto* pixels : {&pair.left, &pair.right}) {
    pixels->resize(static_cast<std::size_t>(pair.camera.width_px) * static_cast<std::size_t>(pair.camera.height_px));
    file.read(reinterpret_cast<char*>(pixels->data()), static_cast<std::streamsize>(pixels->size()));
  }
  return pair;
}
