#include "flies/io/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/exclusive_file.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/unfinished_outputs.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::read_all;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  OutputFile file(folder.file("out.txt"));
  file.write("one\n");
  file.write("two\n");
  EXPECT_FALSE(fs::exists(folder.file("out.txt")));
  file.commit();
  EXPECT_EQ(read_all(folder.file("out.txt")), "one\ntwo\n");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  { OutputFile(folder.file("out.txt")).write("half"); }
  EXPECT_EQ(folder.count(), 0U);
}

TEST(OutputFile, IsRemovedWithAllThatIsUnfinished) {
  const TemporaryFolder folder;
  // In a process of its own: no output can be begun or ended afterwards.
  const auto write_and_end = [&] {
    OutputFile complete(folder.file("complete.txt"));
    complete.commit();
    const OutputFile unfinished(folder.file("unfinished.txt"));
    remove_unfinished_outputs();
    ::_exit(0);
  };
  EXPECT_EXIT(write_and_end(), ::testing::ExitedWithCode(0), "");
  EXPECT_TRUE(fs::exists(folder.file("complete.txt")));
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, KeepsWholeLinesOfWhatIsMadeToEnd) {
  const TemporaryFolder folder;
  const auto write_and_end = [&] {
    OutputFile lines(folder.file("out.jsonl"), OutputFile::Kind::lines),
        none(folder.file("none"), OutputFile::Kind::lines);
    lines.write("one\n");
    lines.write("two\n" + std::string(10'000, 'x'));
    none.write("no line");
    remove_unfinished_outputs();
    ::_exit(0);
  };
  EXPECT_EXIT(write_and_end(), ::testing::ExitedWithCode(0), "");
  EXPECT_EQ(read_all(folder.file("out.jsonl")), "one\ntwo\n");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, RemovesWhatAKilledProcessLeft) {
  const TemporaryFolder folder;
  const pid_t killed = ::fork();
  if (killed == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(killed, nullptr, 0), killed);
  const std::string gone = std::to_string(killed), alive = std::to_string(::getppid());
  for (const auto& left : {"out.txt.part-" + gone + "-0", "out.txt.part-" + gone}) folder.write(left, "half");
  const std::vector<std::string> kept = {"out.txt.part-" + alive + "-0", "other.txt.part-" + gone + "-0",
                                         "out.txt.part-x", "out.txt.part-" + gone + "-0.bak",
                                         "out.txt.part-" + gone + ".mp4"};
  for (const auto& name : kept) folder.write(name, "not ours");
  write_file(folder.file("out.txt"), "new");
  EXPECT_EQ(folder.count(), kept.size() + 1);
  for (const auto& name : kept) EXPECT_TRUE(fs::exists(folder.file(name))) << name;
}

TEST(OutputFile, KeepsTheOldFileWithoutCommit) {
  const TemporaryFolder folder;
  const auto path = folder.write("out.txt", "old");
  { OutputFile(path).write("half"); }
  EXPECT_EQ(read_all(path), "old");
  write_file(path, "new");
  EXPECT_EQ(read_all(path), "new");
  EXPECT_EQ(folder.count(), 1U);
}

TEST(OutputFile, DoesNotReplaceWhatAnotherRunIsWriting) {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  const int writer = open_exclusively(path, path);
  ASSERT_EQ(::write(writer, "line\n", 5), 5);
  EXPECT_THAT(error_of([&] { const OutputFile file(path); }), AllOf(HasSubstr(path), HasSubstr("another run")));
  EXPECT_EQ(read_all(path), "line\n");
  EXPECT_EQ(folder.count(), 1U);
  ::close(writer);
  write_file(path, "whole");
  EXPECT_EQ(read_all(path), "whole");
}

TEST(OutputFile, DoesNotReplaceWhatAnotherRunHasBegunToWrite) {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  OutputFile file(path);
  const int writer = open_exclusively(path, path);
  EXPECT_THAT(error_of([&] { file.commit(); }), HasSubstr("another run"));
  EXPECT_TRUE(is_being_written(path));
  ::close(writer);
}

TEST(OutputFile, KeepsWritersFromTheFileThatItIsToReplace) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out.txt", "old");
  OutputFile file(path), other(path);
  EXPECT_THAT(error_of([&] { open_exclusively(path, path); }), HasSubstr("another run"));
  file.commit();
  other.commit();
  ::close(open_exclusively(path, path));
}

TEST(OutputFile, CanBeMoved) {
  const TemporaryFolder folder;
  OutputFile first(folder.file("out.txt"));
  OutputFile second(std::move(first));
  second.write("x");
  second.commit();
  EXPECT_EQ(read_all(folder.file("out.txt")), "x");
}

TEST(OutputFile, FollowsLinks) {
  const TemporaryFolder folder;
  const auto target = folder.write("target.txt", "old");
  fs::create_symlink(target, folder.file("link.txt"));
  write_file(folder.file("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.file("link.txt")));
  EXPECT_EQ(read_all(target), "new");
}

TEST(OutputFile, LeavesDevicesInPlace) {
  write_file("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(OutputFile, NoticesAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  EXPECT_THAT(error_of([] { write_file("/dev/full", "a short text that waits in the buffer"); }),
              AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
  EXPECT_THAT(error_of([] { write_file("/dev/full", std::string(1U << 20, 'x')); }), HasSubstr("No space left"));
}

TEST(OutputFile, NamesWhatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { OutputFile(folder.file("no/such/out.txt")); }),
              AllOf(HasSubstr("no/such/out.txt"), HasSubstr("cannot be written: No such file")));
  EXPECT_THAT(error_of([&] { OutputFile(folder.file("")); }), HasSubstr("is a folder"));
  EXPECT_THAT(error_of([&] { OutputFile(""); }), HasSubstr("is empty"));
}

TEST(OutputFile, RespectsAFolderThatMayNotBeWritten) {
  const testing::OrdinaryUser user;
  const TemporaryFolder folder;
  fs::create_directory(folder.file("locked"));
  fs::permissions(folder.file("locked"), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(error_of([&] { OutputFile(folder.file("locked/out.txt")); }), HasSubstr("Permission denied"));
  fs::permissions(folder.file("locked"), fs::perms::owner_all);
}

TEST(OutputFile, WritesStandardOutputForADash) {
  ::testing::internal::CaptureStdout();
  write_file("-", "to the pipe\n");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "to the pipe\n");
  EXPECT_FALSE(fs::exists("-"));
}

TEST(WritePng, ReadsBackTheSame) {
  const TemporaryFolder folder;
  cv::Mat image(5, 7, CV_8UC3);
  cv::randu(image, 0, 256);
  write_png(folder.file("a.png"), image);
  EXPECT_EQ(cv::norm(image, cv::imread(folder.file("a.png"), cv::IMREAD_UNCHANGED), cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace flies
