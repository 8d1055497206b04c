#include "flies/io/json_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flies::detail {
namespace {

using ::testing::ElementsAre;

TEST(JsonText, IsKnownByItsFirstBracketBehindBlanksAndComments) {
  EXPECT_TRUE(is_json_text("\n {}"));
  EXPECT_TRUE(is_json_text("// rig A\n/* of\nMay */ # x\n[1]"));
  EXPECT_FALSE(is_json_text("fx: {a: 1}"));
  EXPECT_FALSE(is_json_text("# {\nfx: 1"));
  EXPECT_FALSE(is_json_text(""));
  EXPECT_FALSE(is_json_text("/* {"));
}

TEST(JsonText, CommentsAreBlanksAndLinesStay) {
  EXPECT_THAT(json_values_of("// a\n{\"a\": 1,// b\n/* c\nd */\t\"e\": 2} # f"),
              ElementsAre("    \n{\"a\": 1,    \n    \n     \"e\": 2}"));
}

TEST(JsonText, WhatLooksLikeACommentWithinAWordIsNone) {
  const std::string text = R"({"a": "// no", 'b': '/* no */', c: http://x, d: x#y, "e": "\"// no"})";
  EXPECT_THAT(json_values_of(text), ElementsAre(text));
}

TEST(JsonText, AnApostropheOpensNoQuotes) {
  EXPECT_THAT(json_values_of("{a: John's} {b: 2}"), ElementsAre("{a: John's}", " {b: 2}"));
}

TEST(JsonText, ValuesFollowOneTheOther) {
  EXPECT_THAT(json_values_of("{\"a\": \"}\"}\n{\"b\": [{}]}\n\n"), ElementsAre("{\"a\": \"}\"}", "\n{\"b\": [{}]}"));
  EXPECT_THAT(json_values_of("{}} x"), ElementsAre("{}", "} x"));
  EXPECT_THAT(json_values_of("[a, b]: {c: 1}\n"), ElementsAre("[a, b]: {c: 1}"));  // a key of YAML
  EXPECT_THAT(json_values_of("{\"a\": 1"), ElementsAre("{\"a\": 1"));
}

}  // namespace
}  // namespace flies::detail
