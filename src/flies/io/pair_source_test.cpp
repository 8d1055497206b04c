#include "flies/io/pair_source.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "flies/io/pair_matching.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
namespace fs = std::filesystem;

/// Two sub-folders to fill.
struct Folders {
  TemporaryFolder root;
  Folders() {
    fs::create_directory(left());
    fs::create_directory(right());
  }
  std::string left() const { return root.file("left"); }
  std::string right() const { return root.file("right"); }
  void add(const std::string& left_name, const std::string& right_name) const {
    root.write("left/" + left_name, "x");
    root.write("right/" + right_name, "x");
  }
};

TEST(FindPairs, TakesTwoFilesAsOnePair) {
  const Folders folders;
  folders.add("a.png", "b.png");
  const auto pairs = find_pairs(folders.left() + "/a.png", folders.right() + "/b.png");
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].left, folders.left() + "/a.png");
  EXPECT_EQ(pairs[0].right, folders.right() + "/b.png");
}

TEST(FindPairs, PairsFoldersInNameOrderWithNumbersAsNumbers) {
  const Folders folders;
  for (const char* name : {"l_10.png", "l_9.png", "l_008.JPG"}) folders.root.write(std::string("left/") + name, "");
  for (const char* name : {"r_0010.tiff", "r_0009.pgm", "r_0008.jpeg"})
    folders.root.write(std::string("right/") + name, "");
  folders.add("times.txt", "times.txt");
  folders.root.write("left/.hidden.png", "");
  fs::create_directory(folders.left() + "/folder.png");
  const auto pairs = find_pairs(folders.left(), folders.right());
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_THAT(pairs[0].left, HasSubstr("l_008.JPG"));
  EXPECT_THAT(pairs[0].right, HasSubstr("r_0008.jpeg"));
  EXPECT_THAT(pairs[1].left, HasSubstr("l_9.png"));
  EXPECT_THAT(pairs[2].left, HasSubstr("l_10.png"));
  EXPECT_THAT(pairs[2].right, HasSubstr("r_0010.tiff"));
}

TEST(FindPairs, NamesBothCountsWhenTheyDiffer) {
  const Folders folders;
  folders.add("1.png", "1.png");
  folders.root.write("left/2.png", "");
  EXPECT_THAT(error_of([&] { find_pairs(folders.left(), folders.right()); }),
              AllOf(HasSubstr("holds 1 images"), HasSubstr("expected 2")));
}

/// Left and right names of the pairs, without their folders.
std::vector<std::string> names_of(const MatchedPairs& found) {
  std::vector<std::string> names;
  for (const auto& pair : found.pairs)
    names.push_back(fs::path(pair.left).filename().string() + " " + fs::path(pair.right).filename().string());
  return names;
}

TEST(MatchPairs, ALostFrameDoesNotShiftThoseThatFollow) {
  const Folders folders;
  for (const char* name : {"0.png", "1.png", "2.png", "4.png"}) folders.root.write(std::string("left/") + name, "");
  for (const char* name : {"0.jpg", "2.jpg", "3.jpg", "4.jpg"}) folders.root.write(std::string("right/") + name, "");
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_THAT(names_of(found), ElementsAre("0.png 0.jpg", "2.png 2.jpg", "4.png 4.jpg"));
  EXPECT_THAT(found.odd, ElementsAre(HasSubstr("left/1.png"), HasSubstr("right/3.jpg")));
  EXPECT_EQ(match_pairs(folders.left(), folders.right(), PairBy::order).pairs.size(), 4U);
  // Whoever cannot pass over images refuses.
  EXPECT_THAT(error_of([&] { find_pairs(folders.left(), folders.right()); }),
              AllOf(HasSubstr("no partner has"), HasSubstr("left/1.png"), HasSubstr("right/3.jpg")));
}

TEST(MatchPairs, NamesMayTellLeftFromRight) {
  const Folders folders;
  for (const char* name : {"left_1.png", "left_2.png"}) folders.root.write(std::string("left/") + name, "");
  for (const char* name : {"right_2.png", "right_3.png"}) folders.root.write(std::string("right/") + name, "");
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_THAT(names_of(found), ElementsAre("left_2.png right_2.png"));
  EXPECT_EQ(found.odd.size(), 2U);
}

TEST(MatchPairs, StampsWithoutTrailingZerosCompareAsNumbers) {
  const Folders folders;
  for (const char* name : {"1698.103911.png", "1698.204211.png", "1698.304511.png"})
    folders.root.write(std::string("left/") + name, "");
  for (const char* name : {"1698.104031.png", "1698.20433.png", "1698.3046.png", "1698.404931.png"})
    folders.root.write(std::string("right/") + name, "");
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_THAT(names_of(found), ElementsAre("1698.103911.png 1698.104031.png", "1698.204211.png 1698.20433.png",
                                           "1698.304511.png 1698.3046.png"));
  EXPECT_THAT(found.odd, ElementsAre(HasSubstr("1698.404931.png")));
}

/// Left loses its fourth image, right its ninth, so that their counts are equal.
struct LostOnBothSides {
  const char* left;  ///< name of an image; {} is its number
  const char* right;
};

TEST(MatchPairs, WhateverTellsTheSidesApartALostFrameOnEachDoesNotShift) {
  for (const auto& [left, right] :
       std::vector<LostOnBothSides>{{"{:04}_L", "{:04}_R"},
                                    {"L{:04}", "R{:04}"},
                                    {"img_{:04}_0", "img_{:04}_1"},
                                    {"cam2_{:04}", "cam3_{:04}"},
                                    {"c0_{:04}", "c1_{:04}"},
                                    {"frame_{:04}_cam_0", "frame_{:04}_cam_1"},
                                    {"frame_{:04}", "{:04}_right"},
                                    {"left_16987654{:02}.000", "right_16987654{:02}.004"},
                                    {"2024-05-01T10-00-{:02}.100", "2024-05-01T10-00-{:02}.104"},
                                    {"1698765432_{}00000000", "1698765432_{}03000000"},
                                    {"10-00-00-{}00", "10-00-00-{}04"},
                                    {"01-05-2024_10-00-00.{}00", "01-05-2024_10-00-00.{}04"},
                                    {"83{}11", "83{}13"},
                                    {"{:04}_83{}11", "{:04}_83{}13"},
                                    {"DSC_199{}", "DSC_003{}"},
                                    {"a_{}0", "b_{}7"}}) {
    const Folders folders;
    for (int i = 0; i < 10; ++i) {
      if (i != 3) folders.root.write("left/" + fmt::format(fmt::runtime(left), i, i) + ".png", "");
      if (i != 8) folders.root.write("right/" + fmt::format(fmt::runtime(right), i, i) + ".png", "");
    }
    const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
    ASSERT_EQ(found.pairs.size(), 8U) << left;
    EXPECT_EQ(found.odd.size(), 2U) << left;
    EXPECT_THAT(found.pairs[3].left, HasSubstr(fmt::format(fmt::runtime(left), 4, 4)));
    EXPECT_THAT(found.pairs[3].right, HasSubstr(fmt::format(fmt::runtime(right), 4, 4)));
  }
}

/// Images whose names are a pattern and a number.
struct Numbered : Folders {
  Numbered(const char* left, const std::vector<int>& lefts, const char* right, const std::vector<int>& rights) {
    for (const int i : lefts) root.write("left/" + fmt::format(fmt::runtime(left), i) + ".png", "");
    for (const int i : rights) root.write("right/" + fmt::format(fmt::runtime(right), i) + ".png", "");
  }
};

TEST(MatchPairs, StampsTellMoreThanCountersOfWhatWasSaved) {
  const Folders folders;
  for (int i = 0, left = 0, right = 0; i < 6; ++i) {
    if (i != 1) folders.root.write(fmt::format("left/{:04}_83{}11.png", left++, i), "");
    if (i != 3) folders.root.write(fmt::format("right/{:04}_83{}13.png", right++, i), "");
  }
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_THAT(names_of(found), ElementsAre("0000_83011.png 0000_83013.png", "0001_83211.png 0002_83213.png",
                                           "0003_83411.png 0003_83413.png", "0004_83511.png 0004_83513.png"));
  EXPECT_THAT(found.notes, ElementsAre(AllOf(HasSubstr("each with the nearest"), HasSubstr("+2"),
                                             HasSubstr("and 100 from image to image"))));
}

TEST(MatchPairs, CountersThatDifferByAConstantTellOfALostImage) {
  const Numbered folders("DSC_{}", {1998, 2000, 2001, 2002, 2003}, "DSC_{:04}", {35, 36, 37, 39, 40});
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_THAT(names_of(found), ElementsAre("DSC_1998.png DSC_0035.png", "DSC_2000.png DSC_0037.png",
                                           "DSC_2002.png DSC_0039.png", "DSC_2003.png DSC_0040.png"));
  EXPECT_THAT(found.notes, ElementsAre(AllOf(HasSubstr("-1963"), HasSubstr("missing in between"))));
  const auto ordered = match_pairs(folders.left(), folders.right(), PairBy::order);
  EXPECT_EQ(ordered.pairs.size(), 5U);
  EXPECT_THAT(ordered.notes, ElementsAre(AllOf(HasSubstr("2 of 5"), HasSubstr("DSC_2000.png with DSC_0036.png"))));
  const Numbered irregular("{:06}", {17, 101, 322, 395, 502}, "{:06}", {9019, 9103, 9250, 9321, 9503});
  EXPECT_EQ(match_pairs(irregular.left(), irregular.right(), PairBy::automatic).pairs.size(), 4U);
  const Numbered more("DSC_{}", {1998, 1999, 2000, 2001}, "DSC_{:04}", {35, 37, 38});
  EXPECT_THAT(match_pairs(more.left(), more.right(), PairBy::automatic).odd, ElementsAre(HasSubstr("DSC_1999")));
}

TEST(MatchPairs, OrderHoldsWhereNumbersDoNotTellOfALostImage) {
  const std::vector<std::pair<std::vector<int>, std::vector<int>>> numbers = {
      {{0, 1, 2, 3}, {500, 501, 502, 503}},
      {{0, 130, 170, 320, 375, 535, 590}, {3, 109, 238, 293, 434, 481, 593}},  // jitter
      {{0, 10, 20, 30}, {11, 21, 31, 41}},                                     // a step and a bit
      {{0, 1, 3, 4}, {70, 71, 73, 74}},                                        // the same pair is left out
      {{0, 1, 3, 4}, {70, 71, 72, 73}},                                        // counted anew
      {{1, 2, 3, 4}, {70, 71, 73, 74}},                                        // who knows which one is lost
      {{0, 1, 2, 9, 10, 11}, {70, 71, 72, 73, 76, 77}},                        // each camera took pictures of its own
      {{0, 1, 2, 3}, {70, 72, 74, 76}}};                                       // every second
  for (const auto& [lefts, rights] : numbers) {
    const Numbered folders("a{}", lefts, "b{}", rights);
    const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
    EXPECT_THAT(found.odd, IsEmpty()) << rights[0];
    EXPECT_THAT(found.notes, ElementsAre(HasSubstr("in order although"))) << rights[0];
    EXPECT_THAT(match_pairs(folders.left(), folders.right(), PairBy::order).notes, IsEmpty()) << rights[0];
  }
}

TEST(MatchPairs, OrderHoldsWhereTimesAreOfOtherClocks) {
  const Numbered folders("169876543{}.5", {0, 1, 2, 3}, "169870000{}.5", {0, 1, 2, 3});
  EXPECT_THAT(match_pairs(folders.left(), folders.right(), PairBy::order).notes, IsEmpty());
}

TEST(MatchPairs, NamesThatOnlyLookLikeTimesPairByTheirNumbers) {
  const Numbered folders("01-02-03-{:03}", {10, 14, 18, 22}, "01-02-04-{:03}", {10, 14, 18, 22});
  EXPECT_EQ(match_pairs(folders.left(), folders.right(), PairBy::automatic).pairs.size(), 4U);
}

TEST(MatchPairs, SplitsAFolderOfBothCamerasByWhatItsNamesSay) {
  const Folders folders;
  for (const char* name : {"left00", "left01", "left10", "right00", "right01", "right10"})
    folders.root.write("left/" + std::string(name) + ".png", "");
  for (const PairBy by : {PairBy::automatic, PairBy::order, PairBy::name}) {
    const auto found = match_pairs(folders.left(), folders.left() + "/../left", by);
    EXPECT_THAT(names_of(found),
                ElementsAre("left00.png right00.png", "left01.png right01.png", "left10.png right10.png"));
    EXPECT_THAT(found.notes, ElementsAre(HasSubstr("is given as both folders")));
  }
  folders.root.write("left/board.png", "");
  EXPECT_THAT(error_of([&] { find_pairs(folders.left(), folders.left()); }),
              AllOf(HasSubstr("is given as both folders"), HasSubstr("left01 and right01")));
}

TEST(MatchPairs, TellsWhenNumbersDifferInPairsThatAreTakenInOrder) {
  const Folders folders;
  folders.add("000.png", "500.png");
  folders.add("001.png", "501.png");
  const auto found = match_pairs(folders.left(), folders.right(), PairBy::automatic);
  EXPECT_EQ(found.pairs.size(), 2U);
  EXPECT_THAT(found.notes, ElementsAre(AllOf(HasSubstr("in order"), HasSubstr("000.png with 500.png"))));
  EXPECT_TRUE(match_pairs(folders.left(), folders.right(), PairBy::order).notes.empty());
}

TEST(MatchPairs, TellsWhenTheTimesOfPairsAreFarApart) {
  const auto notes_at = [](int skew_ms) {
    const Folders folders;
    for (int i = 1; i < 6; ++i)
      folders.add(fmt::format("1698765432.{:03}.png", 100 * i), fmt::format("1698765432.{:03}.png", 100 * i + skew_ms));
    return match_pairs(folders.left(), folders.right(), PairBy::automatic).notes;
  };
  EXPECT_THAT(notes_at(4), IsEmpty());
  EXPECT_THAT(notes_at(30), ElementsAre(AllOf(HasSubstr("+30 ms after"), HasSubstr("while 100 ms pass"))));
  EXPECT_THAT(notes_at(70), ElementsAre(HasSubstr("-30 ms after"))) << "the nearest is of the shot before";
}

TEST(MatchPairs, RefusesNamesThatAreNoTimesOrHaveNoPartner) {
  const Folders folders;
  folders.add("a.png", "b.png");
  EXPECT_THAT(error_of([&] { match_pairs(folders.left(), folders.right(), PairBy::time); }),
              HasSubstr("is not a time"));
  EXPECT_THAT(error_of([&] { match_pairs(folders.left(), folders.right(), PairBy::name); }), HasSubstr("no partner"));
  EXPECT_EQ(match_pairs(folders.left(), folders.right(), PairBy::automatic).pairs.size(), 1U);
}

TEST(FindPairs, RejectsWhatCannotBePaired) {
  const Folders folders;
  EXPECT_THAT(error_of([&] { find_pairs(folders.left(), folders.right()); }), HasSubstr("holds no images"));
  folders.add("1.png", "1.png");
  EXPECT_THAT(error_of([&] { find_pairs(folders.left(), folders.right() + "/1.png"); }), HasSubstr("is a file"));
  EXPECT_THAT(error_of([&] { find_pairs(folders.left() + "/1.png", folders.right()); }), HasSubstr("is a folder"));
  EXPECT_THAT(error_of([&] { find_pairs(folders.root.file("nowhere"), folders.right()); }),
              AllOf(HasSubstr("nowhere"), HasSubstr("does not exist")));
}

TEST(FindPairs, NamesAFolderThatMayNotBeRead) {
  const testing::OrdinaryUser user;
  const Folders folders;
  folders.add("1.png", "1.png");
  fs::permissions(folders.left(), fs::perms::none);
  const auto error = error_of([&] { find_pairs(folders.left(), folders.right()); });
  fs::permissions(folders.left(), fs::perms::owner_all);
  EXPECT_THAT(error, HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace flies
