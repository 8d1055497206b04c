#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// Every command with every option of its own that takes a value, as the helps list them; those of the method, with
/// dots in their names, are all made alike.
std::vector<std::pair<std::string, std::string>> options_with_values(const TestFolder& folder) {
  const std::regex option(R"(^  (?:-\w,)?(--[\w-]+)[\w,-]* (?:FILE|DIR|PNG|MODEL|NAME|PATTERN|HOW|HZ|MS?\b|N\b|TEXT))");
  std::vector<std::pair<std::string, std::string>> found;
  for (const char* command : {"detect", "track", "live", "check", "calib", "calibrate", "synth", "evaluate",
                              "evaluate-classifier", "train", "reproduce", "bench", "config"}) {
    for (const auto& line : lines(run_flies(folder.path(), {command, "--help"}).out))
      if (std::smatch match; std::regex_search(line, match, option)) found.emplace_back(command, match[1]);
  }
  return found;
}

TEST(CommandLine, RefusesAnEmptyValueOfAnyOption) {
  const TestFolder folder;
  const auto options = options_with_values(folder);
  EXPECT_GT(options.size(), 90u) << "the helps could not be read";

  for (const auto& [command, option] : options) {
    const RunResult result = run_flies(folder.path(), {command, option, ""});
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_THAT(result.err, HasSubstr(option.substr(2) + ": is empty, expected ")) << command << " " << option;
  }
  EXPECT_THAT(folder.listing(), ::testing::IsEmpty());
}

TEST(CommandLine, SaysWhatAnEmptyValueShouldHaveBeen) {
  const TestFolder folder;
  const auto complaint = [&](const Words& words) { return run_flies(folder.path(), words).err; };

  EXPECT_THAT(complaint({"track", "drive", "--json", ""}), HasSubstr("--json: is empty, expected the name of a file"));
  EXPECT_THAT(complaint({"detect", "l", "r", "--top-view", ""}), HasSubstr("expected the name of a file"));
  EXPECT_THAT(complaint({"train", "--work", ""}), HasSubstr("--work: is empty, expected the name of a folder"));
  EXPECT_THAT(complaint({"detect", "", "r"}), HasSubstr("LEFT: is empty, expected a value"));
  EXPECT_THAT(complaint({"track", "--json=", "drive"}), HasSubstr("--json: is empty"));
}

TEST(CommandLine, NamesTheNearestOptionOnlyWhereOneIsNear) {
  const TestFolder folder;
  const auto complaint = [&](const Words& words) { return run_flies(folder.path(), words).err; };
  EXPECT_THAT(complaint({"config", "--evolve.flis", "3"}), HasSubstr("--evolve.flis; did you mean --evolve.flies?"));
  for (const char* far : {"--nope", "--plot-it-all"})
    EXPECT_THAT(complaint({"config", far, "3"}), HasSubstr("unknown option " + std::string(far) + "; try")) << far;
  EXPECT_THAT(complaint({"paint"}), HasSubstr("unknown command 'paint'; try"));
}

TEST(CommandLine, RefusesNumbersThatAreNoneOrEndless) {
  const TestFolder folder;
  const std::vector<Words> commands = {
      {"synth", "out", "--sequence", "--rate"}, {"live", "both.mp4", "--rate"},
      {"live", "both.mp4", "--max-skew"},       {"track", "drive", "--rate"},
      {"train", "--crop-person-share"},         {"detect", "left.png", "right.png", "--baseline"}};
  for (Words command : commands) {
    const std::string option = command.back();
    command.emplace_back();
    for (const char* value : {"nan", "-nan", "inf", "-inf", "1e999"}) {
      command.back() = value;
      const RunResult result = run_flies(folder.path(), command);
      EXPECT_EQ(result.status, 2);
      EXPECT_THAT(result.err, HasSubstr(option + ": found " + value + ", expected a number in "));
    }
  }
  EXPECT_THAT(folder.listing(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace flies::testing
