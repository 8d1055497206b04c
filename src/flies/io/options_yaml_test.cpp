#include "flies/io/options_yaml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using flies::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct InnerOptions {
  int flies = 5000;
  double mutation = 0.25;
  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("flies", self.flies, Range{1, 100000}, "number of flies: all of them");
    field("mutation", self.mutation, Range{0, 1}, "share of mutants");
  }
};

struct OuterOptions {
  std::uint64_t seed = 1;
  InnerOptions evolve;
  bool road = true;
  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "seed # of all random numbers");
    field("evolve", self.evolve);
    field("road", self.road, "estimate the road");
  }
};

TEST(ParseOptionsYaml, FlattensNestedAndDottedKeys) {
  const auto settings = parse_options_yaml("seed: 7\nevolve:\n  flies: 300\nevolve.mutation: 0.5\n", "o.yaml");
  ASSERT_EQ(settings.size(), 3U);
  EXPECT_EQ(settings[0].path, "seed");
  EXPECT_EQ(settings[0].text, "7");
  EXPECT_EQ(settings[1].path, "evolve.flies");
  EXPECT_EQ(settings[1].text, "300");
  EXPECT_EQ(settings[1].source, "o.yaml line 3");
  EXPECT_EQ(settings[2].path, "evolve.mutation");
}

TEST(ParseOptionsYaml, TakesCommentsAloneAsNothing) { EXPECT_TRUE(parse_options_yaml("# nothing\n", "o").empty()); }

TEST(OptionsYaml, ReadsBackToTheSameOptions) {
  OuterOptions written;
  written.seed = 99;
  written.evolve.flies = 1234;
  written.evolve.mutation = 1.0 / 3.0;
  written.road = false;
  const std::string yaml = options_yaml(list_options(written));
  EXPECT_THAT(yaml, HasSubstr("evolve:\n  flies: 1234  # number of flies: all of them (1..100000)\n"));
  OuterOptions read;
  for (const auto& setting : parse_options_yaml(yaml, "o"))
    set_option(read, setting.path, setting.text, setting.source);
  EXPECT_EQ(read.seed, written.seed);
  EXPECT_EQ(read.evolve.flies, written.evolve.flies);
  EXPECT_EQ(read.evolve.mutation, written.evolve.mutation);
  EXPECT_EQ(read.road, written.road);
}

struct BadOptions {
  const char* name;
  std::string text;
  std::string complaint;
};

void PrintTo(const BadOptions& bad, std::ostream* out) { *out << bad.name; }

class BadOptionFiles : public ::testing::TestWithParam<BadOptions> {};

TEST_P(BadOptionFiles, NameFileLineAndKey) {
  const TemporaryFolder folder;
  const auto path = folder.write("bad.yaml", GetParam().text);
  EXPECT_THAT(error_of([&] { load_options_yaml(path); }),
              AllOf(HasSubstr("bad.yaml"), HasSubstr(GetParam().complaint), Not(HasSubstr("\n"))));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadOptionFiles,
    ::testing::Values(
        BadOptions{"Malformed", "seed: [1\n", "malformed YAML"},
        BadOptions{"Twice", "seed: 1\nseed: 2\n", "line 2: seed: is set twice, first in"},
        BadOptions{"NestedAndDotted", "evolve: {flies: 1}\nevolve.flies: 2\n", "line 2: evolve.flies: is set twice"},
        BadOptions{"List", "a: 1\nevolve:\n  flies: [1, 2]\n", "line 3: evolve.flies: found a list"},
        BadOptions{"NoValue", "evolve:\n", "line 1: evolve: has no value"},
        BadOptions{"NotAMap", "- seed\n", "expected options"}, BadOptions{"Prose", "just words\n", "expected options"},
        BadOptions{"ListAsKey", "[1, 2]: 3\n", "not a word"},
        BadOptions{"AliasesOfEmptyMaps", flies::testing::nested_aliases("{}", true), "aliases are unfolded"},
        BadOptions{"AliasesOfWords", flies::testing::nested_aliases("5", true), "aliases are unfolded"},
        BadOptions{"SelfContaining", "a: &a\n  b: *a\n", "bad.yaml"}, BadOptions{"Empty", "", "is empty"}),
    [](const auto& test) { return test.param.name; });

TEST(LoadOptionsYaml, BearsMarksAndOtherLineEnds) {
  const testing::TemporaryFolder folder;
  std::string wide = "\xFF\xFE";
  for (const char c : std::string("evolve:\r\n  flies: 300\r\n")) wide += std::string{c, '\0'};
  for (const auto& text : {std::string("\xEF\xBB\xBF# mine\r\nevolve:\r\n\r\n  flies: 300\r\n"), wide}) {
    const auto settings = load_options_yaml(folder.write("o.yaml", text));
    ASSERT_EQ(settings.size(), 1U);
    EXPECT_EQ(settings[0].path, "evolve.flies");
    EXPECT_EQ(settings[0].text, "300");
  }
}

}  // namespace
}  // namespace flies
