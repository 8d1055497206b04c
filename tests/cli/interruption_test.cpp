#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace flies::testing {
namespace {

using ::testing::IsEmpty;

class Interruption : public ::testing::TestWithParam<int> {};

TEST_P(Interruption, EndsTheProcessAndLeavesNothingBehind) {
  const TestFolder folder;
  const RunResult result = interrupt_flies(folder.path(), {"synth", "street", "--frames", "10000"}, GetParam(),
                                           [&] { return folder.listing().size() >= 4; });
  EXPECT_EQ(result.status, 128 + GetParam());
  EXPECT_THAT(folder.listing(), IsEmpty());
}

TEST_P(Interruption, KeepsTheLinesOfPairsThatAreDone) {
  const TestFolder folder;
  write_street(folder.path());
  for (const std::string side : {"left", "right"}) {
    std::filesystem::create_directory(folder.path() / (side + "s"));
    for (int i = 0; i < 1000; ++i)
      std::filesystem::create_symlink("../" + side + ".png",
                                      folder.path() / (side + "s") / (std::to_string(i) + ".png"));
  }
  const RunResult result =
      interrupt_flies(folder.path(), {"detect", "lefts", "rights", "--calib", "calib.txt", "--json", "out.jsonl"},
                      GetParam(), [&] { return are_written(folder.path(), "out.jsonl.part-", 2); });
  EXPECT_EQ(result.status, 128 + GetParam());
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
