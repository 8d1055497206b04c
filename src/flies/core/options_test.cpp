#include "flies/core/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/core/error.hpp"
#include "flies/core/name_hint.hpp"

namespace flies {
enum class Colour { red, green };
template <>
struct EnumNames<Colour> {
  static constexpr std::array<std::string_view, 2> names = {"red", "green"};
};

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Inner {
  double share = 0.25;
  Colour colour = Colour::red;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("share", self.share, Range{0, 1}, "a share");
    field("colour", self.colour, "a colour");
  }
};

struct Outer {
  std::uint64_t seed = 1;
  int count = 3;
  bool active = true;
  Inner inner;

  template <class Self, class Field>
  static void fields(Self& self, Field&& field) {
    field("seed", self.seed, "a seed");
    field("count", self.count, Range{1, 10}, "a count");
    field("active", self.active, "a switch");
    field("inner", self.inner);
  }
};

TEST(ListOptions, NamesEveryLeafWithValueAndRange) {
  const auto listings = list_options(Outer{});
  ASSERT_EQ(listings.size(), 5U);
  EXPECT_EQ(listings[0].path, "seed");
  EXPECT_EQ(listings[1].value, "3");
  EXPECT_EQ(listings[1].allowed, "1..10");
  EXPECT_EQ(listings[2].allowed, "true|false");
  EXPECT_EQ(listings[3].path, "inner.share");
  EXPECT_EQ(listings[3].value, "0.25");
  EXPECT_EQ(listings[4].value, "red");
  EXPECT_EQ(listings[4].allowed, "red|green");
  EXPECT_EQ(listings[4].meaning, "a colour");
}

TEST(SetOption, ReadsEveryType) {
  Outer options;
  set_option(options, "seed", "18446744073709551615", "test");
  set_option(options, "count", "7", "test");
  set_option(options, "active", "off", "test");
  set_option(options, "inner.share", "0.5", "test");
  set_option(options, "inner.colour", "green", "test");
  EXPECT_EQ(options.seed, 18446744073709551615ULL);
  EXPECT_EQ(options.count, 7);
  EXPECT_FALSE(options.active);
  EXPECT_EQ(options.inner.share, 0.5);
  EXPECT_EQ(options.inner.colour, Colour::green);
}

TEST(SetOption, ReadsWhatPythonAndYamlWrite) {
  Outer options;
  for (const char* text : {"False", "FALSE", "Off", "NO"}) {
    options.active = true;
    set_option(options, "active", text, "test");
    EXPECT_FALSE(options.active) << text;
    set_option(options, "active", std::string(text) == "FALSE" ? "TRUE" : "True", "test");
    EXPECT_TRUE(options.active);
  }
  set_option(options, "seed", "+5", "test");
  EXPECT_EQ(options.seed, 5U);
  for (const char* text : {"7.0", "7.", "+7", "+7.00"}) {
    options.count = 1;
    set_option(options, "count", text, "test");
    EXPECT_EQ(options.count, 7) << text;
  }
  set_option(options, "inner.share", "+.5", "test");
  EXPECT_EQ(options.inner.share, 0.5);
}

TEST(SetOption, ShowsAZeroByte) {
  using namespace std::string_literals;
  Outer options;
  EXPECT_THAT([&] { set_option(options, "count\0"s, "3", "test"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("count\\0: unknown option"), HasSubstr("'count'"))));
  EXPECT_THAT([&] { set_option(options, "count", "3\0"s, "test"); },
              ThrowsMessage<InputError>(HasSubstr("found '3\\0', expected a whole number")));
}

TEST(SetOption, ReadsBackWhatListOptionsPrints) {
  Outer options;
  options.inner.share = 1.0 / 3.0;
  Outer copy;
  for (const auto& listing : list_options(options)) set_option(copy, listing.path, listing.value, "test");
  EXPECT_EQ(copy.inner.share, options.inner.share);
}

struct BadOption {
  const char* path;
  const char* text;
  const char* complaint;
};
class SetOptionBad : public testing::TestWithParam<BadOption> {};

TEST_P(SetOptionBad, NamesSourceOptionAndWhatIsAllowed) {
  Outer options;
  EXPECT_THAT([&] { set_option(options, GetParam().path, GetParam().text, "my.yaml"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("my.yaml: "), HasSubstr(GetParam().path), HasSubstr(GetParam().complaint))));
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, SetOptionBad,
    testing::Values(BadOption{"count", "11", "1..10"}, BadOption{"count", "2.5", "a whole number"},
                    BadOption{"count", "+-2", "a whole number"}, BadOption{"count", ".0", "a whole number"},
                    BadOption{"count", "", "a whole number"}, BadOption{"seed", "-1", "0 or more"},
                    BadOption{"active", "maybe", "true or false"}, BadOption{"inner.share", "nan", "0..1"},
                    BadOption{"inner.share", "x", "a number"}, BadOption{"inner.colour", "blue", "red|green"},
                    BadOption{"inner.shar", "0.1", "the nearest known one is 'inner.share'"},
                    BadOption{"inner", "1", "a group of options"}));

TEST(NearestName, IsNoneWhereNothingIsNear) {
  const std::vector<std::string> known = {"seed", "threads", "evolve.flies"};
  EXPECT_EQ(nearest_name("evolve.flis", known), "evolve.flies");
  for (const char* far : {"nope", "preset", "model", "x"}) EXPECT_EQ(nearest_name(far, known), "") << far;
  EXPECT_EQ(did_you_mean("sed", known), "; did you mean 'seed'?");
  EXPECT_EQ(did_you_mean("nope", known), "");
}

TEST(CheckOptions, FindsAValueSetOutOfRangeInCode) {
  Outer options;
  EXPECT_NO_THROW(check_options(options, "options"));
  options.inner.share = 2.0;
  EXPECT_THAT([&] { check_options(options, "options"); }, ThrowsMessage<InputError>(HasSubstr("inner.share")));
}

}  // namespace
}  // namespace flies
