#include "flies/scan/kernels/match_cells.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <string>
#include <vector>

#include "flies/core/random.hpp"
#include "flies/scan/reference.hpp"

namespace flies::kernels {
namespace {

/// Two images of noise; the right one is the left one shifted, but for its lower half.
struct Noise {
  int width_px, height_px, shift_px;
  std::vector<std::uint8_t> left, right;

  Noise(int width, int height, int shift, bool saturated = false)
      : width_px(width), height_px(height), shift_px(shift) {
    const auto pixel = [&](std::uint32_t image, int u, int v) {
      FlyRandom random(5, image, static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(u + 1000));
      return static_cast<std::uint8_t>(saturated ? 255 * random.below(2) : 90 + random.below(40));
    };
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        left.push_back(pixel(0, u, v));
        right.push_back(v < height / 2 ? pixel(0, u + shift, v) : pixel(1, u, v));
      }
  }
  RectifiedPair pair() const {
    return {{left.data(), width_px, height_px, width_px}, {right.data(), width_px, height_px, width_px}};
  }
};

/// Bands of a road that recedes by two disparities each.
struct Setting {
  std::vector<int> reach, recede;
  CellMatching matching;

  Setting(const Noise& noise, int nearest_px, int disparities, int bands) {
    for (int band = 0; band < bands; ++band) {
      reach.push_back(std::min(disparities, disparities / 3 + 2 * band + 1));
      recede.push_back(2);
    }
    matching.pair = noise.pair();
    matching.columns = noise.width_px / kCellColumns;
    matching.bands = bands;
    matching.bottom_row = noise.height_px - 2;
    matching.row_step = 2;
    matching.nearest_px = nearest_px;
    matching.disparities = disparities;
    matching.reach = reach;
    matching.recede = recede;
  }
};

class MatchCells : public testing::TestWithParam<std::int64_t> {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(MatchCells, GivesWhatTheReferenceGives) {
  hwy::SetSupportedTargetsForTest(GetParam());
  // Widths and numbers of disparities with every kind of tail; nearest places within and beyond the image.
  for (const bool saturated : {false, true})
    for (const auto& [width, nearest, disparities] :
         {std::tuple(64, 20, 17), std::tuple(203, 60, 64), std::tuple(131, 40, 65), std::tuple(90, 85, 130),
          std::tuple(80, 2, 9), std::tuple(72, 5, 1)}) {
      const Noise noise(width, 70, 7, saturated);
      Setting setting(noise, nearest, disparities, 8);
      for (const auto& weights : {CellWeights{}, CellWeights{7, 190, 63, 63, 63}, CellWeights{1, 20, 0, 0, 0},
                                  CellWeights{5, 100, 9, 3, 30}}) {
        setting.matching.weights = weights;
        CellMemory memory;
        std::vector<CellMatch> found;
        match_cells(setting.matching, memory, found);
        const auto expected = match_cells_reference(setting.matching);
        ASSERT_FALSE(expected.empty());
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          SCOPED_TRACE(testing::Message() << "width " << width << ", " << disparities << " disparities, cell " << i);
          ASSERT_EQ(found[i].disparity, expected[i].disparity);
          ASSERT_EQ(found[i].before, expected[i].before);
          ASSERT_EQ(found[i].cost, expected[i].cost);
          ASSERT_EQ(found[i].after, expected[i].after);
          ASSERT_EQ(found[i].second, expected[i].second);
        }
      }
    }
}

TEST_P(MatchCells, FindsTheShiftOfAShiftedImage) {
  hwy::SetSupportedTargetsForTest(GetParam());
  const Noise noise(200, 140, 12);
  Setting setting(noise, 30, 31, 8);
  setting.matching.bottom_row = noise.height_px / 2 - 3;
  setting.reach.assign(8, 31);
  setting.recede.assign(8, 0);
  CellMemory memory;
  std::vector<CellMatch> found;
  match_cells(setting.matching, memory, found);
  // The partner of the first two columns lies outside of the right image.
  for (int band = 0; band < 8; ++band)
    for (int column = 2; column < setting.matching.columns - 1; ++column)
      EXPECT_EQ(found[static_cast<std::size_t>(band * setting.matching.columns + column)].disparity, 30 - 12);
}

std::string target_name(const testing::TestParamInfo<std::int64_t>& target) { return hwy::TargetName(target.param); }
INSTANTIATE_TEST_SUITE_P(EveryTarget, MatchCells, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()), target_name);

}  // namespace
}  // namespace flies::kernels
