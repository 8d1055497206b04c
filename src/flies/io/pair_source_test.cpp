#include "flies/io/pair_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
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
