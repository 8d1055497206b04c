#include "flies/io/folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <vector>

#include "flies/io/image_folder.hpp"
#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

namespace fs = std::filesystem;
using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> names_of(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const auto& path : paths) names.push_back(path.filename().string());
  return names;
}

TEST(IsThere, FollowsLinksAndTellsLoops) {
  const TemporaryFolder folder;
  folder.write("file", "");
  fs::create_symlink("file", folder.file("link"));
  fs::create_symlink("gone", folder.file("dangling"));
  fs::create_symlink("loop", folder.file("loop"));
  EXPECT_TRUE(detail::is_there(folder.file("link")));
  EXPECT_FALSE(detail::is_there(folder.file("dangling")));
  EXPECT_FALSE(detail::is_there_as_folder(folder.file("link")));
  EXPECT_TRUE(detail::is_there_as_folder(folder.file("")));
  EXPECT_THAT(error_of([&] { detail::is_there(folder.file("loop")); }), StartsWith(folder.file("loop") + ": cannot"));
  EXPECT_THAT(error_of([&] { detail::is_there_as_folder(folder.file("loop/below")); }), HasSubstr("loop/below"));
}

TEST(IsThere, NamesThatAreTooLongAreNot) {
  EXPECT_FALSE(detail::is_there(std::string(300, 'a')));
  EXPECT_FALSE(detail::is_there_as_folder("videotestsrc ! " + std::string(300, 'a')));
}

TEST(FilesOf, PassOverWhatIsNoFileButNotLinksThatLeadNowhere) {
  const TemporaryFolder folder;
  for (const char* name : {"b.png", "a.png", ".hidden.png"}) folder.write(name, "");
  fs::create_directory(folder.file("folder.png"));
  fs::create_symlink("loop.png", folder.file("loop.png"));
  fs::create_symlink("gone.png", folder.file("dangling.png"));
  ASSERT_EQ(::mkfifo(folder.file("zz.png").c_str(), 0600), 0);
  EXPECT_THAT(names_of(detail::files_of(folder.file(""))), ElementsAre("a.png", "b.png", "dangling.png", "loop.png"));
  EXPECT_THAT(names_of(detail::folders_of(folder.file(""))), ElementsAre("folder.png"));
  EXPECT_EQ(detail::images_of(folder.file("")).size(), 4U);
}

TEST(FilesOf, NameFoldersThatCannotBeRead) {
  const TemporaryFolder folder;
  fs::create_symlink("loop", folder.file("loop"));
  for (const char* name : {"loop", "gone"})
    EXPECT_THAT(error_of([&] { detail::files_of(folder.file(name)); }), StartsWith(folder.file(name) + ": cannot be"));
}

TEST(FilesBelow, FollowLinksToFoldersButNotBackUp) {
  const TemporaryFolder folder, other;
  fs::create_directories(folder.file("deep/deeper"));
  fs::create_directories(folder.file(".hidden"));
  folder.write("deep/deeper/c.txt", "");
  folder.write(".hidden/no.txt", "");
  folder.write("d.txt", "");
  other.write("e.txt", "");
  fs::create_directory_symlink(other.file(""), folder.file("deep/other"));
  fs::create_directory_symlink("..", folder.file("deep/up"));
  fs::create_directory_symlink(".", folder.file("self"));
  folder.write("f.png", "");
  const auto is_text = [](const fs::path& file) { return file.extension() == ".txt"; };
  EXPECT_THAT(names_of(detail::files_below(folder.file(""), is_text)), ElementsAre("d.txt", "c.txt", "e.txt"));
}

}  // namespace
}  // namespace flies
