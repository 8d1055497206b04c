#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Words = std::vector<std::string>;

/// The least that makes a report.
Words reproduce(const Words& more) {
  Words words = {"reproduce", "--scenes", "1", "--seeds", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Reproduce, WritesAReportThatHoldsEverything) {
  const TestFolder folder;
  const RunResult result = run_flies(folder.path(), reproduce({"--out", "report.html", "--json", "numbers.json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(folder.listing(), ElementsAre("numbers.json", "report.html"));
  EXPECT_THAT(result.out, HasSubstr("their ratio, Eq. (2) / Eq. (1)"));
  EXPECT_THAT(result.out, HasSubstr("report: report.html"));

  const std::string html = read_text(folder.path() / "report.html");
  EXPECT_THAT(html, ::testing::StartsWith("<!doctype html>"));
  EXPECT_THAT(html, ::testing::EndsWith("</html>\n"));
  for (const char* number :
       {"2a", "2b", "3a", "3b", "3c", "4, top left", "4, top right", "4, bottom left", "4, bottom right"})
    EXPECT_THAT(html, HasSubstr("alt=\"Figure " + std::string(number) + "\" src=\"data:image/"));
  for (const char* loader : {"http://", "https://", "<script", "<link", "url(", "src=\"/", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(loader)));
  EXPECT_THAT(html, HasSubstr("flies reproduce --seeds 1 --seed 1 --scenes 1"));

  const auto numbers = nlohmann::json::parse(read_text(folder.path() / "numbers.json"));
  ASSERT_EQ(numbers.at("sets").size(), 2u);
  EXPECT_GT(numbers.at("sets")[0].at("table").at("rms_eq2_m").at("median").get<double>(), 0.0);
}

TEST(Reproduce, PrintsOnlyJsonWhenThatIsAskedFor) {
  const TestFolder folder;
  const RunResult result = run_flies(folder.path(), reproduce({"--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("seeds"), 1);
}

TEST(Reproduce, TellsFaultsInOneLineAndLeavesNothing) {
  const struct {
    Words more;
    const char* named;
  } faults[] = {
      {{"--kitti", "nowhere"}, "nowhere"},
      {{"--kitti-object", "nowhere"}, "nowhere"},
      {{"--out", "missing/report.html"}, "missing/report.html"},
      {{"--out", "same", "--json", "same"}, "--json"},
      {{"--seeds", "0"}, "--seeds"},
      {{"--scenes", "0"}, "--scenes"},
      {{"--seed", "-3"}, "seed"},
  };
  for (const auto& fault : faults) {
    const TestFolder folder;
    const RunResult result = run_flies(folder.path(), reproduce(fault.more));
    EXPECT_EQ(result.status, 2) << fault.named;
    EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
    EXPECT_THAT(result.err, HasSubstr(fault.named));
    EXPECT_THAT(folder.listing(), IsEmpty());
  }
}

}  // namespace
}  // namespace flies::testing
