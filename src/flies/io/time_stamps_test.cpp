#include "flies/io/time_stamps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ReadTimeStamps, ReadsKittisAcrossMidnight) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_time_stamps(folder.write("t", "2011-09-26 23:59:59.950000000\r\n2011-09-27 00:00:00.050000001\n\n")),
              ElementsAre(0.0, DoubleNear(0.100000001, 1e-12)));
}

TEST(ReadTimeStamps, ReadsRfc3339WithItsTimeZones) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_time_stamps(folder.write("t",
                                            "2023-12-31T23:59:59.950Z\n2024-01-01T01:00:00.05+01:00\n"
                                            "2023-12-31t19:30:00.15-04:30\n2024-01-01 00:00:00.25\n")),
              ElementsAre(0.0, DoubleNear(0.1, 1e-12), DoubleNear(0.2, 1e-12), DoubleNear(0.3, 1e-12)));
  const auto moment = parse_date_and_time("1970-01-02T00:00:01.5Z");
  ASSERT_TRUE(moment);
  EXPECT_EQ(moment->whole_s, 86400);
  EXPECT_EQ(moment->rest_s, 1.5);
  const auto ahead = parse_date_and_time("1970-01-02T01:30:01,5+0130");
  ASSERT_TRUE(ahead);
  EXPECT_EQ(ahead->whole_s, 86400);
  EXPECT_EQ(ahead->rest_s, 1.5);
  for (const char* text :
       {"2024-01-01T00:00:00+1", "2024-01-01T00:00:00+01:00x", "2024-01-01T00:00:00+01:60", "2024-01-01T00:00:00+-1:00",
        "2024-01-01x00:00:00", "2024-01-01T00:00:00 UTC", "2024-01-01T00:00:1e1Z", "2024-01-01T00:00:0x10",
        "2024-01-01T00:00:", "2024-01-01T00:00: 1"})
    EXPECT_FALSE(parse_date_and_time(text)) << text;
}

TEST(ReadTimeStamps, ReadsSecondsAndKeepsTheirFraction) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_time_stamps(folder.write("t", "1317042272.349659964\n1317042272.459792166\n")),
              ElementsAre(0.0, DoubleNear(0.110132202, 1e-6)));
}

TEST(ReadTimeStamps, NamesTheLineAtFault) {
  const TemporaryFolder folder;
  const auto fault = [&](const char* text) { return error_of([&] { read_time_stamps(folder.write("t", text)); }); };
  EXPECT_THAT(fault("1.0\nsoon\n"), AllOf(HasSubstr("line 2"), HasSubstr("'soon'")));
  EXPECT_THAT(fault("1.0\n1.0\n"), AllOf(HasSubstr("line 2"), HasSubstr("later")));
  EXPECT_THAT(fault("2011-02-30 00:00:00.0\n"), HasSubstr("line 1"));
  EXPECT_THAT(fault("2011-02-03 25:00:00.0\n"), HasSubstr("line 1"));
  EXPECT_THAT(fault("nan\n"), HasSubstr("line 1"));
  EXPECT_THAT(fault("\n\n"), HasSubstr("no times"));
}

TEST(ReadTimeStamps, TellsThatUnitsAreNoSeconds) {
  const TemporaryFolder folder;
  for (const char* text : {"1698765432103\n", "1698765432103000\n", "1698765432103000000\n"})
    EXPECT_THAT(error_of([&] { read_time_stamps(folder.write("t", text)); }),
                AllOf(HasSubstr("line 1"), HasSubstr("since 1970? expected seconds")));
  EXPECT_THAT(error_of([&] { read_time_stamps(folder.write("t", "inf\n")); }),
              HasSubstr("date and time such as 2011-09-26 13:04:32.35"));
}

TEST(ReadTimeStamps, BearsMarksBlanksAndComments) {
  const testing::TemporaryFolder folder;
  const auto file = folder.write("t.txt", "\xEF\xBB\xBF# seconds\r\n\r\n  1.5 \t\r\n2.5 # the second\r\n");
  EXPECT_THAT(read_time_stamps(file), ::testing::ElementsAre(0.0, 1.0));
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("1\n3\n")) wide += std::string{c, '\0'};
  EXPECT_THAT(read_time_stamps(folder.write("w.txt", wide)), ::testing::ElementsAre(0.0, 2.0));
}

}  // namespace
}  // namespace flies
