#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/io/gray_image.hpp"

namespace flies {

/// What the network sees of a window.
inline constexpr int kWindowWidth_px = 48, kWindowHeight_px = 96;
inline constexpr std::size_t kWindowPixels = std::size_t{kWindowWidth_px} * kWindowHeight_px;
inline constexpr double kPersonShare = 0.75;  ///< of the window's height, as `propose.person_share`

/// A picture in memory and what is known of it.
struct Picture {
  std::string name;
  GrayImage image;
  std::vector<ImageBox> people;     ///< head to feet, to be learnt from
  std::vector<ImageBox> unclear;    ///< neither people to learn from nor background
  bool has_background = true;       ///< everybody in it is labelled: the rest is background
  bool has_proposals = false;       ///< background comes from `proposals` alone
  std::vector<ImageBox> proposals;  ///< windows that the flies proposed
};

/// Pictures that are learnt from and pictures that are kept apart: of other scenes.
struct NetworkData {
  std::vector<Picture> learnt, kept_apart;
};

struct DataFolders {
  std::string people;               ///< holds `train` and `pictures`
  std::vector<std::string> stereo;  ///< pairs with truth, whose proposals are learnt from
  bool keep_apart = true;           ///< every second run of street pictures, a fifth of those without people
};

/// @throws InputError as the readers of the folders
NetworkData load_network_data(const DataFolders& folders);

using Random = std::mt19937_64;

/// Where a window lies.
struct Place {
  std::uint32_t picture = 0;
  ImageBox window = {};
};

/// The window around each person.
std::vector<Place> places_of_people(std::span<const Picture> pictures);
/// Draws windows without people.
class BackgroundPlaces {
 public:
  explicit BackgroundPlaces(std::span<const Picture> pictures);
  Place draw(Random& random) const;

 private:
  std::span<const Picture> pictures_;
  std::vector<std::uint32_t> random_, proposed_;
};

/// A window as far off as proposed ones are.
ImageBox jittered(const ImageBox& window, Random& random);

/// Grey levels of a window.
void read_window(const Picture& picture, const ImageBox& window, float* pixels);
/// Mirrored, blurred, of other contrast, noisy, hidden in part behind what `before` shows.
void disguise(float* pixels, const float* before, double hidden_share, Random& random);

}  // namespace flies
