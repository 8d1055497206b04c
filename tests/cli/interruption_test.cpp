#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

/// Starts a command that writes for a long time. @returns its process
pid_t start_synth(const std::filesystem::path& folder) {
  const pid_t process = ::fork();
  if (process != 0) return process;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  if (::chdir(folder.c_str()) == 0) ::execl(FLIES_BINARY, "flies", "synth", "street", "--frames", "10000", nullptr);
  ::_exit(127);
}

class Interruption : public ::testing::TestWithParam<int> {};

TEST_P(Interruption, EndsTheProcessAndLeavesNothingBehind) {
  constexpr std::chrono::seconds kPatience{60};
  constexpr std::chrono::milliseconds kPause{5};
  const TestFolder folder;
  const pid_t process = start_synth(folder.path());
  ASSERT_GT(process, 0);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (folder.listing().size() < 4 && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kPause);
  EXPECT_THAT(folder.listing(), Not(IsEmpty()));

  ASSERT_EQ(::kill(process, GetParam()), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(process, &status, 0), process);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), GetParam());
  EXPECT_THAT(folder.listing(), IsEmpty());
}

TEST_P(Interruption, KeepsTheLinesOfPairsThatAreDone) {
  constexpr std::chrono::seconds kPatience{60};
  constexpr std::chrono::milliseconds kPause{5};
  const TestFolder folder;
  write_street(folder.path());
  for (const std::string side : {"left", "right"}) {
    std::filesystem::create_directory(folder.path() / (side + "s"));
    for (int i = 0; i < 1000; ++i)
      std::filesystem::create_symlink("../" + side + ".png",
                                      folder.path() / (side + "s") / (std::to_string(i) + ".png"));
  }
  const pid_t process = ::fork();
  if (process == 0) {
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
    if (::chdir(folder.path().c_str()) == 0)
      ::execl(FLIES_BINARY, "flies", "detect", "lefts", "rights", "--calib", "calib.txt", "--json", "out.jsonl",
              nullptr);
    ::_exit(127);
  }
  const auto is_written = [&] {
    for (const auto& name : folder.listing())
      if (name.starts_with("out.jsonl.part-") && lines(read_text(folder.path() / name)).size() >= 2) return true;
    return false;
  };
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!is_written() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(kPause);
  ASSERT_EQ(::kill(process, GetParam()), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(process, &status, 0), process);
  ASSERT_TRUE(WIFSIGNALED(status));
  const auto records = lines(read_text(folder.path() / "out.jsonl"));
  ASSERT_GE(records.size(), 2u);
  for (const auto& record : records) EXPECT_TRUE(record.starts_with('{') && record.ends_with('}')) << record;
  EXPECT_LT(records.size(), 1000u);
  for (const auto& name : folder.listing()) EXPECT_EQ(name.find(".part-"), std::string::npos) << name;
}

INSTANTIATE_TEST_SUITE_P(Signals, Interruption, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& signal) { return signal.param == SIGINT ? "Interrupt" : "Terminate"; });

}  // namespace
}  // namespace flies::testing
