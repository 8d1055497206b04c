#include "flies/io/image_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace flies {
namespace {

using ::testing::ElementsAre;
using ::testing::Optional;

constexpr double kSmallest_s = 1e-6;  // of a double that counts seconds since 1970

TEST(TimesInNames, AreReadInTheFormsThatAreFound) {
  const std::vector<std::vector<std::string>> folders = {
      {"1698765432.500.png", "1698765433.000.png"},
      {"left_1698765432.5.png", "left_1698765433.png"},
      {"cam0_1698765432_500000000.png", "cam0_1698765433_000000000.png"},
      {"1698765432_500000.png", "1698765433_000000.png"},
      {"1698765432500.png", "1698765433000.png"},
      {"1698765432500000.png", "1698765433000000.png"},
      {"1698765432500000000.png", "1698765433000000000.png"},
      {"2023-10-31T15-17-12.500.png", "2023-10-31T15-17-13.000.png"},
      {"31-10-2023_15-17-12.500.png", "31-10-2023_15-17-13.000.png"},
      {"cam0_31.10.2023 15.17.12.5.png", "cam0_31.10.2023 15.17.13.0.png"},
      {"20231031_151712_500_left.png", "20231031_151713_000_left.png"},
      {"IMG_20231031_151712500.png", "IMG_20231031_151713000.png"},
      {"20231031151712500.png", "20231031151713.png"},
      {"left_20231031151712.5.png", "left_20231031151713.png"},
      {"a/2023-10-31 15:17:12.5.png", "a/2023-10-31 15:17:13.0.png"}};
  for (const auto& folder : folders) {
    const auto times_s = times_in_names(folder);
    ASSERT_TRUE(times_s) << folder[0];
    EXPECT_NEAR((*times_s)[0], 1698765432.5, kSmallest_s) << folder[0];
    EXPECT_NEAR((*times_s)[1], 1698765433.0, kSmallest_s) << folder[1];
  }
  const auto unpadded = times_in_names({"1698765432_3000000.png", "1698765432_103000000.png"});
  ASSERT_TRUE(unpadded);
  EXPECT_NEAR((*unpadded)[1] - (*unpadded)[0], 0.1, kSmallest_s);
}

TEST(TimesInNames, AreTimesOfDayWhereTheyAscend) {
  EXPECT_THAT(times_in_names({"cam0_10-00-00-100.png", "cam0_10-00-01-200.png"}),
              Optional(ElementsAre(36000.1, 36001.2)));
  EXPECT_THAT(times_in_names({"0007_10:00:00.100250.png"}), Optional(ElementsAre(36000.10025)));
  EXPECT_FALSE(times_in_names({"05-31-2024_23-00-00.100.png", "06-01-2024_01-00-00.100.png"})) << "of two days";
  EXPECT_FALSE(times_in_names({"01-02-03-004.png", "01-02-03-005.png", "01-02-03-006.png"})) << "a counter";
  for (const char* name : {"24-00-00-100.png", "10-60-00-100.png", "10-00-00.png", "10-00-00-10.png"})
    EXPECT_FALSE(times_in_names({name})) << name;
}

TEST(TimesInNames, AreCountsWhereARunOfDigitsIsNoDate) {
  const std::vector<std::pair<std::string, double>> counts = {{"1698123112595900.png", 1698123112.5959},
                                                              {"1698123112595900000.png", 1698123112.5959},
                                                              {"2033139912595900.png", 2033139912.5959},
                                                              {"2033123125595900.png", 2033123125.5959}};
  for (const auto& [name, time_s] : counts) {
    const auto times_s = times_in_names({name});
    ASSERT_TRUE(times_s) << name;
    EXPECT_NEAR((*times_s)[0], time_s, kSmallest_s) << name;
  }
}

TEST(TimesInNames, AreNoCountersAndNoWords) {
  for (const char* name : {"0000000012.png", "img_0001_0.png", "20240501.png", "left.png", "2024-13-01T10-00-00.png"})
    EXPECT_FALSE(times_in_names({name})) << name;
}

TEST(NumbersInNames, AreTheLastThatVary) {
  EXPECT_THAT(numbers_in_names({"a/0000000011.png", "a/0000000013.png"}), Optional(ElementsAre(11, 13)));
  EXPECT_THAT(numbers_in_names({"cam2_9_0.png", "cam2_10_0.png"}), Optional(ElementsAre(9, 10)));
  EXPECT_FALSE(numbers_in_names({"a.png", "b.png"}));
  EXPECT_FALSE(numbers_in_names({"2.png", "1.png"}));
}

TEST(FinestNumbersInNames, AreThoseOfTheLargestSteps) {
  EXPECT_THAT(finest_numbers_in_names({"0_83211_5.png", "1_83311_4.png"}), Optional(ElementsAre(83211, 83311)));
  EXPECT_THAT(finest_numbers_in_names({"83211_7.png", "83311_8.png"}), Optional(ElementsAre(83211, 83311)));
  EXPECT_FALSE(finest_numbers_in_names({"a_2.png", "a_1.png"}));
  EXPECT_FALSE(finest_numbers_in_names({"a_1.png"})) << "nothing ascends";
}

TEST(SidesInNames, AreWordsLettersOrNumbersThatAllHave) {
  const std::vector<std::vector<std::string>> folders = {
      {"d/left00.png", "d/left10.png", "d/right00.png", "d/right10.png"},
      {"d/Image_LEFT_0.png", "d/Image_LEFT_1.png", "d/Image_RIGHT_0.png", "d/Image_RIGHT_1.png"},
      {"d/01_camLeft.png", "d/02_camLeft.png", "d/01_camRight.png", "d/02_camRight.png"},
      {"d/01_l.png", "d/02_l.png", "d/01_r.png", "d/02_r.png"},
      {"d/L0001.png", "d/L0002.png", "d/R0001.png", "d/R0002.png"},
      {"d/cam0_07.png", "d/cam0_08.png", "d/cam1_07.png", "d/cam1_08.png"},
      {"d/img_07_0.png", "d/img_08_0.png", "d/img_07_1.png", "d/img_08_1.png"},
      {"d/07_1.png", "d/08_1.png", "d/07_2.png", "d/08_2.png"}};
  for (const auto& folder : folders) {
    const auto sides = sides_in_names(folder);
    ASSERT_TRUE(sides) << folder[0];
    EXPECT_THAT(sides->first, ElementsAre(folder[0], folder[1]));
    EXPECT_THAT(sides->second, ElementsAre(folder[2], folder[3]));
  }
}

TEST(SidesInNames, AreNotGuessed) {
  const std::vector<std::vector<std::string>> folders = {{"left0.png", "left1.png"},
                                                         {"left0.png", "right0.png", "board.png"},
                                                         {"frame_0.png", "frame_1.png"},
                                                         {"0_0.png", "0_1.png", "1_0.png", "1_1.png"},
                                                         {"000007_10.png", "000007_11.png", "000008_10.png"},
                                                         {"1.png", "2.png", "3.png"}};
  for (const auto& folder : folders) EXPECT_FALSE(sides_in_names(folder)) << folder[0];
}

TEST(NamesWithoutSide, KeepWhatTellsImagesApart) {
  const auto [left, right] = names_without_side({"0001_L.png"}, {"0002_R.png"});
  EXPECT_THAT(left, ElementsAre("0001_L"));  // without the number nothing would be left
  const auto [a, b] = names_without_side({"x/run1_008.png", "x/run1_9.png"}, {"run2_0008.png", "run2_0010.png"});
  EXPECT_EQ(a[0], b[0]);
  EXPECT_NE(a[1], b[1]);
}

}  // namespace
}  // namespace flies
