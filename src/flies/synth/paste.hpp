#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flies/core/gray_view.hpp"
#include "flies/core/options.hpp"
#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/io/gray_image.hpp"
#include "flies/synth/cut_out.hpp"
#include "flies/synth/truth.hpp"

namespace flies {

/// Whom to paste, and where. The result is a pure function of these values, the pair and the cut-outs.
struct PasteOptions {
  std::uint64_t seed = 1;
  int people = 3;
  double people_min_range_m = 8.0;
  double people_max_range_m = 24.0;
  double noise_gray = 1.5;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "seed of people, places and noise; same options give the same pixels");
    field("people", self.people, Range{0, 60}, "people wanted in a pair; fewer when no free visible ground is found");
    field("people_min_range_m", self.people_min_range_m, Range{1, 100}, "nearest person, along x");
    field("people_max_range_m", self.people_max_range_m, Range{1, 100}, "farthest person, along x");
    field("noise_gray", self.noise_gray, Range{0, 50}, "standard deviation of the noise on pasted people, grey levels");
  }
};

/// A real pair, and what is known of it.
struct RealPair {
  RectifiedPair images;
  StereoCamera camera;
  std::span<const float> true_disparity_px;     ///< of every left pixel; NaN where it is not known
  std::span<const float> matched_disparity_px;  ///< found by matching, for pixels whose true one is not known
  std::vector<ImageBox> keep_clear;             ///< boxes that nobody is pasted over, such as those of labelled people
};

/// The same pair with people in it.
struct PastedPair {
  GrayImage left, right;
  PixelTruth pixels;                ///< true disparity, with that of the pasted; `object` is the person, -1 elsewhere
  std::vector<TruthObject> people;  ///< upright boards, `scene_index` counts them from 0; nearest first
};

/// Pastes people into both images: upright boards, 1.55 to 1.9 m tall, whose feet stand on ground that is seen, each at
/// one disparity (to a fraction of a pixel) and behind what is nearer. Grey levels are moved and stretched so that the
/// cut-out's photograph would have the mean and deviation of the place around the person; both images have noise of
/// their own.
/// @param cut_outs at least one
/// @param frame    number of the pair: those of one seed differ
/// @throws InputError when an option is out of range, the farthest person is nearer than the nearest, there are no
///         cut-outs, or sizes differ: of the images, of the camera's, or of the disparities
PastedPair paste_people(const RealPair& pair, std::span<const CutOut> cut_outs, const PasteOptions& options,
                        std::uint32_t frame);

}  // namespace flies
