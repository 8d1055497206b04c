#include "flies/train/training_windows.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "flies/core/mat_view.hpp"
#include "flies/core/random.hpp"
#include "flies/eval/people.hpp"
#include "flies/eval/window_data.hpp"
#include "flies/train/toy_pictures.hpp"

namespace flies {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

GrayImage toy_image(int width_px, int height_px) {
  const cv::Mat picture = testing::toy_background(width_px, height_px, 3);
  return {width_px, height_px, {picture.datastart, picture.dataend}};
}

TEST(WindowsWithPeople, StayWithinTheJitter) {
  TrainingPicture picture;
  picture.people = {{100, 50, 40, 90}};
  PositiveOptions options;
  options.jitters = 50;
  const auto windows = windows_with_people(picture, 7, options, 1);
  ASSERT_THAT(windows, SizeIs(52));
  const ImageBox exact = windows[0].window;
  EXPECT_EQ(exact.height_px, 120.0);
  EXPECT_TRUE(windows[1].is_mirrored);
  double largest = 0.0;
  for (const auto& w : windows) {
    EXPECT_EQ(w.picture, 7U);
    EXPECT_DOUBLE_EQ(w.window.width_px, w.window.height_px / 2.0);
    EXPECT_LE(w.window.height_px, 1.1001 * exact.height_px);
    EXPECT_GE(w.window.height_px, exact.height_px / 1.1001);
    const double shift = w.window.v_px + w.window.height_px / 2 - exact.v_px - exact.height_px / 2;
    EXPECT_LE(std::abs(shift), 0.0301 * exact.height_px);
    largest = std::max(largest, std::abs(shift));
  }
  EXPECT_GT(largest, 0.02 * exact.height_px);
}

TEST(WindowsWithoutPeople, KeepClearOfThem) {
  TrainingPicture picture;
  picture.people = {{20, 20, 50, 100}};
  picture.unclear = {{120, 20, 50, 100}};
  TrainOptions options;
  const auto windows = windows_without_people(picture, 200, 160, 0, 1, 2000, options);
  EXPECT_LT(windows.size(), 2000U);
  EXPECT_GT(windows.size(), 500U);
  for (const auto& w : windows)
    for (const auto& person : {picture.people[0], picture.unclear[0]})
      EXPECT_LE(intersection_over_union(w.window, window_around(person, 0.75)), 0.3);
}

TEST(WindowsWithoutPeople, DifferByRoundAndNotByCall) {
  const TrainingPicture picture;
  const TrainOptions options;
  const auto once = windows_without_people(picture, 200, 160, 0, 1, 10, options);
  EXPECT_EQ(once, windows_without_people(picture, 200, 160, 0, 1, 10, options));
  EXPECT_NE(once, windows_without_people(picture, 200, 160, 0, 2, 10, options));
}

// The order of the two draws is part of what a seed means: models of old are trained again with the same bytes.
TEST(WindowsWithoutPeople, AreDrawnFromTheFirstBitsAndThenTheNext) {
  constexpr std::uint32_t kPlaces = 0x7262, kRound = 1, kPicture = 4;
  TrainOptions options;
  FlyRandom random(options.seed, kPlaces, kRound, kPicture);
  WindowSampling sampling;
  sampling.min_height_px = options.negatives.min_height_px;
  sampling.seed = random.bits();
  sampling.seed = sampling.seed << 32 | random.bits();
  std::vector<ImageBox> boxes;
  for (const auto& window : windows_without_people({}, 200, 160, kPicture, kRound, 5, options))
    boxes.push_back(window.window);
  const auto expected = draw_windows(200, 160, 5, sampling, kPicture);
  ASSERT_EQ(boxes.size(), expected.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_EQ(boxes[i].u_px, expected[i].u_px);
    EXPECT_EQ(boxes[i].v_px, expected[i].v_px);
    EXPECT_EQ(boxes[i].height_px, expected[i].height_px);
  }
}

TEST(WindowsWithoutPeople, AreProposalsWhereThereAre) {
  TrainingPicture picture;
  picture.has_proposals = true;
  TrainOptions options;
  EXPECT_THAT(windows_without_people(picture, 200, 160, 0, 1, 10, options), IsEmpty());
  for (int i = 0; i < 20; ++i) picture.proposals.push_back({static_cast<double>(i), 0, 40, 80});
  auto windows = windows_without_people(picture, 200, 160, 0, 1, 10, options);
  ASSERT_THAT(windows, SizeIs(10));
  std::sort(windows.begin(), windows.end(), [](auto& a, auto& b) { return a.window.u_px < b.window.u_px; });
  for (std::size_t i = 1; i < windows.size(); ++i) EXPECT_NE(windows[i].window.u_px, windows[i - 1].window.u_px);
}

TEST(FeaturesIn, OfAMirroredWindowAreThoseOfTheMirroredPicture) {
  const GrayImage image = toy_image(200, 160);
  cv::Mat flipped;
  cv::flip(mat_of(image.view()), flipped, 1);
  const GrayImage mirror{200, 160, {flipped.datastart, flipped.dataend}};
  const TrainingWindow window{0, true, {30, 20, 50, 100}};
  const TrainingWindow same{0, false, {200 - 30 - 50, 20, 50, 100}};
  EXPECT_EQ(features_in(image, {&window, 1}, {}).values, features_in(mirror, {&same, 1}, {}).values);
}

TEST(FeaturesOf, AreInTheOrderOfTheWindows) {
  const testing::TemporaryFolder folder;
  std::vector<TrainingPicture> pictures(2);
  for (int i = 0; i < 2; ++i) {
    pictures[static_cast<std::size_t>(i)].path = folder.file(std::to_string(i) + ".png");
    testing::write_picture(pictures[static_cast<std::size_t>(i)].path, testing::toy_background(200, 160, i));
  }
  const std::vector<TrainingWindow> windows = {
      {1, false, {0, 0, 60, 120}}, {0, false, {0, 0, 60, 120}}, {1, false, {50, 9, 60, 120}}};
  const Matrix features = features_of(pictures, windows, {});
  ASSERT_EQ(features.rows, 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Matrix alone = features_in(load_picture(pictures[windows[i].picture]), {&windows[i], 1}, {});
    EXPECT_TRUE(std::ranges::equal(features.row(i), alone.row(0))) << i;
  }
}

}  // namespace
}  // namespace flies
