#include "flies/synth/cut_out.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>

#include "flies/core/mat_view.hpp"
#include "flies/core/random.hpp"
#include "flies/io/output_file.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int kWidth_px = 64, kHeight_px = 128;

/// A person of 96 px: head, trunk and two legs.
bool is_drawn_person(int u, int v) {
  const double across = (u - 31.5) / 96.0, down = (v - 16) / 96.0;
  const auto in_ellipse = [&](double middle, double half_width, double half_height) {
    const double a = across / half_width, b = (down - middle) / half_height;
    return a * a + b * b <= 1.0;
  };
  if (in_ellipse(0.08, 0.06, 0.08) || in_ellipse(0.34, 0.14, 0.22)) return true;
  return down > 0.5 && down < 1.0 && std::abs(std::abs(across) - 0.055) < 0.045;
}

/// Grey levels with some noise; `person` where the person is.
GrayImage crop(double person, double background) {
  GrayImage image{kWidth_px, kHeight_px, {}};
  FlyRandom random(1, 0, 0, 0);
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u)
      image.pixels.push_back(
          static_cast<std::uint8_t>((is_drawn_person(u, v) ? person : background) + 8.0 * random.uniform()));
  return image;
}

GrayImage mask() {
  GrayImage image{kWidth_px, kHeight_px, {}};
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) image.pixels.push_back(is_drawn_person(u, v) ? 255 : 0);
  return image;
}

double intersection_over_union(const GrayImage& found, const GrayImage& wanted) {
  int both = 0, either = 0;
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i) {
    const bool a = found.pixels[i] >= 128, b = wanted.pixels[i] >= 128;
    both += a && b;
    either += a || b;
  }
  return static_cast<double>(both) / either;
}

void write(const TemporaryFolder& folder, const std::string& name, const GrayImage& image) {
  write_png(folder.file(name), mat_of(image.view()));
}

constexpr double kWellCut = 0.85;  // of 2200 pixels 1200 lie at the edge or beside it, where one in seven may go wrong

TEST(CutOutPerson, FindsADarkPersonBeforeALightPlaceAndTheReverse) {
  for (const auto& [person, background] : {std::pair{40.0, 160.0}, {200.0, 70.0}}) {
    const auto cut = cut_out_person(crop(person, background).view());
    ASSERT_TRUE(cut);
    EXPECT_GT(intersection_over_union(cut->mask, mask()), kWellCut);
    EXPECT_NEAR(cut->body.v_px, 16, 2);
    EXPECT_NEAR(cut->body.v_px + cut->body.height_px, 112, 2);
    EXPECT_NEAR(cut->dark, person, 10);
  }
}

TEST(CutOutPerson, GivesTheSameMaskTwice) {
  const GrayImage image = crop(60, 90);
  const auto first = cut_out_person(image.view()), second = cut_out_person(image.view());
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->mask.pixels, second->mask.pixels);
}

TEST(CutOutPerson, RefusesWhatIsNoPerson) {
  GrayImage edge{kWidth_px, kHeight_px, {}};  // light above, dark below
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) edge.pixels.push_back(v < 70 ? 200 : static_cast<std::uint8_t>(30 + u % 3));
  EXPECT_FALSE(cut_out_person(edge.view()));
}

TEST(CutOutByMask, MeasuresBodyAndLight) {
  const auto cut = cut_out_by_mask(crop(50, 150), mask());
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->body.v_px, 17);  // the top of the head lies between two pixels of row 16
  EXPECT_EQ(cut->body.height_px, 95);
  EXPECT_GT(cut->level_mean, 110);
  EXPECT_LT(cut->bright, 60) << "of the person alone";
  EXPECT_FALSE(cut_out_by_mask(crop(50, 150), {kWidth_px, kHeight_px, std::vector<std::uint8_t>(64 * 128, 0)}));
}

TEST(LoadCutOuts, TakesMasksWhereTheyAreAndLeavesOutFailures) {
  const TemporaryFolder folder;
  write(folder, "a.png", crop(50, 150));
  write(folder, "b.png", crop(100, 101));  // nobody sees him, but the mask knows
  write(folder, "b_mask.png", mask());
  GrayImage plain = crop(100, 100);
  for (int i = 0; i < 64 * 60; ++i) plain.pixels[static_cast<std::size_t>(i)] = 220;
  write(folder, "c.png", plain);
  const CutOuts cuts = load_cut_outs(folder.file("."));
  EXPECT_EQ(cuts.photographs, 3U);
  ASSERT_EQ(cuts.people.size(), 2U);
  EXPECT_EQ(cuts.people[1].mask.pixels, mask().pixels);
}

TEST(LoadCutOuts, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { load_cut_outs(folder.file("none")); }), HasSubstr("none"));
  EXPECT_THAT(error_of([&] { load_cut_outs(folder.file(".")); }), HasSubstr("nobody could be cut out of 0 pictures"));
  write(folder, "a.png", crop(50, 150));
  GrayImage small{32, 32, std::vector<std::uint8_t>(32 * 32, 255)};
  small.pixels[0] = 0;
  write(folder, "a_mask.png", small);
  const std::string error = error_of([&] { load_cut_outs(folder.file(".")); });
  EXPECT_THAT(error, HasSubstr("a_mask.png"));
  EXPECT_THAT(error, HasSubstr("found 32 x 32 px, expected 64 x 128 px"));
}

}  // namespace
}  // namespace flies
