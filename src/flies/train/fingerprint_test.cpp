#include "flies/train/fingerprint.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace flies {
namespace {

std::string fingerprint_of_texts(const std::vector<std::string>& texts) {
  Fingerprint fingerprint;
  for (const auto& text : texts) fingerprint.add(text);
  return fingerprint.text();
}

TEST(Fingerprint, TellsTextsTheirOrderAndTheirEndsApart) {
  const std::string first = fingerprint_of_texts({"ab", "c"});
  EXPECT_EQ(first.size(), 16U);
  EXPECT_EQ(first, fingerprint_of_texts({"ab", "c"}));
  for (const auto& other : std::vector<std::vector<std::string>>{{"a", "bc"}, {"c", "ab"}, {"abc"}, {"ab", "c", ""}})
    EXPECT_NE(first, fingerprint_of_texts(other));
}

TEST(Fingerprint, TellsBoxesApart) {
  const std::vector<ImageBox> boxes = {{1.0, 2.0, 3.0, 4.0}}, other = {{1.0, 2.0, 3.0, 4.5}};
  Fingerprint a, b;
  a.add(boxes);
  b.add(other);
  EXPECT_NE(a.text(), b.text());
}

}  // namespace
}  // namespace flies
