#include "flies/diagnose/pair_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "flies/core/pair_check.hpp"

namespace flies {
namespace {

/// Of the parts of an image, those that must show something: as the diagnosis of a run has it.
constexpr double kNothingTextured = 0.1;
constexpr double kTexture_gray = 3.0;
constexpr const char* kNearPreset = "robot";

/// What is told of a kind of trouble, in the order of `PairTrouble`.
struct Words {
  const char* first;  ///< what is seen, and what to check
  const char* count;  ///< behind "4 of 12 pairs: "
};
constexpr Words kWords[kPairTroubles] = {
    {"there is nothing to match in the left image, so nothing seen does not mean that nothing is there: is that camera "
     "dark, blinded or covered?",
     "nothing to match in the left image"},
    {"there is nothing to match in the right image, so nothing seen does not mean that nothing is there: is that "
     "camera dark, blinded or covered?",
     "nothing to match in the right image"},
    {"left and right seem to be swapped", "left and right swapped"},
    {"hardly any place of the left image is found on the same row of the right one: were they taken at different "
     "moments, or of different scenes?",
     "images that do not seem to belong together"},
    {"the left image is identical to that of the previous pair, while the right one is not: does the left camera hang?",
     "the left image is that of the previous pair"},
    {"the right image is identical to that of the previous pair, while the left one is not: does the right camera "
     "hang?",
     "the right image is that of the previous pair"},
    {"both images are identical to those of the previous pair: do the cameras hang, or are pairs repeated?",
     "both images are those of the previous pair"},
    {"something stands nearer than where the search begins: it is missed, or reported farther away than it is, and the "
     "scan is unknown in its directions (--field.x_min_m and --scan.x_min_m set where the search begins",
     "something nearer than where the search begins"},
};

/// What is told of it the first time.
std::string first_words(PairTrouble trouble, const NearEnd& near) {
  std::string words = kWords[static_cast<std::size_t>(trouble)].first;
  if (trouble != PairTrouble::too_near) return words;
  return words + (near.preset == kNearPreset ? ")" : fmt::format("; --preset {} is for near things)", kNearPreset));
}

/// A sum over every 16th row that differs where the rows do.
std::uint64_t sum_of_rows(const GrayView& image) {
  constexpr int kEvery = 16;
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15U;
  std::uint64_t sum = 0;
  for (int v = kEvery / 2; v < image.height_px; v += kEvery) {
    const std::uint8_t* row = image.row(v);
    for (int u = 0; u + 8 <= image.width_px; u += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, row + u, sizeof eight);
      sum = (sum ^ eight) * kOdd;
      sum ^= sum >> 29;
    }
  }
  return sum;
}

/// Whether hardly a cell of a coarse grid shows anything, judged by a few pixels of each.
bool is_blank(const GrayView& image) {
  constexpr int kColumns = 20, kRows = 8, kSamples = 8;  // a side
  int textured = 0;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      int sum = 0, squares = 0;
      for (int j = 0; j < kSamples; ++j) {
        const std::uint8_t* pixels = image.row(image.height_px * (row * kSamples + j) / (kRows * kSamples));
        for (int i = 0; i < kSamples; ++i) {
          const int level = pixels[image.width_px * (column * kSamples + i) / (kColumns * kSamples)];
          sum += level;
          squares += level * level;
        }
      }
      constexpr double kPixels = kSamples * kSamples;
      const double mean = sum / kPixels;
      textured += squares / kPixels - mean * mean >= kTexture_gray * kTexture_gray;
    }
  return textured < kNothingTextured * kColumns * kRows;
}

bool shows_near_things(const RectifiedPair& pair, const StereoCamera& camera, double nearest_m) {
  constexpr double kTolerance = 1.05;  // the near end is none to the pixel
  if (!(nearest_m > 0.0)) return false;
  const double nearest_px = kTolerance * camera.fx_px * camera.baseline_m / nearest_m;
  const Projection projection(camera);
  const auto parts = parts_nearer_than(pair, [&](double v_px) {
    return std::max(nearest_px + projection.disparity_offset_px(),
                    nearer_than_road_px(projection, {}, pair.left.width_px, v_px));
  });
  return std::ranges::count(parts, true) > 0;
}

}  // namespace

std::optional<std::string> note_on_near_things(const RectifiedPair& pair, const StereoCamera& camera,
                                               const NearEnd& near) {
  if (!shows_near_things(pair, camera, near.range_m)) return std::nullopt;
  return first_words(PairTrouble::too_near, near);
}

bool PairWatch::meet(PairTrouble trouble, const std::string& name) {
  Met& met = met_[static_cast<std::size_t>(trouble)];
  if (met.pairs++ > 0) return false;
  met.first = name;
  return true;
}

std::vector<std::string> PairWatch::look(const RectifiedPair& pair, const StereoCamera& camera, const std::string& name,
                                         const NearEnd& near) {
  std::vector<std::string> found;
  const auto tell = [&](PairTrouble trouble) {
    if (meet(trouble, name)) found.push_back(fmt::format("{}: {}", name, first_words(trouble, near)));
  };
  ++pairs_;
  is_no_pair_ = false;
  const std::array sums{sum_of_rows(pair.left), sum_of_rows(pair.right)};
  const bool left_repeats = last_ && (*last_)[0] == sums[0], right_repeats = last_ && (*last_)[1] == sums[1];
  last_ = sums;
  const bool left_blank = is_blank(pair.left), right_blank = is_blank(pair.right);
  if (left_blank) tell(PairTrouble::left_blank);
  if (right_blank) tell(PairTrouble::right_blank);
  if (left_repeats && right_repeats)
    tell(PairTrouble::both_repeat);
  else if (left_repeats || right_repeats)
    tell(left_repeats ? PairTrouble::left_repeats : PairTrouble::right_repeats);
  if (left_blank || right_blank) return found;  // nothing to compare
  const PairOrder order = order_of_pair(pair, camera);
  is_no_pair_ = order != PairOrder::good;
  if (is_no_pair_)
    tell(order == PairOrder::swapped ? PairTrouble::swapped : PairTrouble::unrelated);
  else if (shows_near_things(pair, camera, near.range_m))
    tell(PairTrouble::too_near);
  return found;
}

std::vector<std::string> PairWatch::counts() const {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < kPairTroubles; ++i)
    if (met_[i].pairs > 0)
      sentences.push_back(
          fmt::format("{} of {} pairs: {}; the first: {}", met_[i].pairs, pairs_, kWords[i].count, met_[i].first));
  return sentences;
}

}  // namespace flies
