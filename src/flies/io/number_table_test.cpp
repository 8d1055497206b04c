#include "flies/io/number_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flies/io/temporary_folder.hpp"

namespace flies {
namespace {

using flies::testing::error_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

NumberTable parsed(const std::string& text) { return parse_number_table(text, "c"); }

TEST(NumberTableText, JsonMayHaveComments) {
  for (const char* text :
       {"// rig A\n{\"fx\": 700, \"cx\": 320}", "{\n  // rig A\n\t\"fx\": 700, /* px */ \"cx\": 320\n}"}) {
    EXPECT_EQ(parsed(text).require_number("fx"), 700.0) << text;
    EXPECT_EQ(parsed(text).require_number("cx"), 320.0) << text;
  }
}

TEST(NumberTableText, JsonLinesOfOneCameraAreReadAndOfTwoRefused) {
  EXPECT_EQ(parsed("{\"fx\": 700}\n{\"fx\": 700}\n").require_number("fx"), 700.0);
  EXPECT_THAT(error_of([] { parsed("{\"fx\": 700, \"cy\": 240}\n{\"fx\": 900, \"cy\": 240}\n"); }),
              HasSubstr("c: fx: stands in two of the 2 documents"));
  EXPECT_THAT(error_of([] { parsed("{fx: 700}\nfx 900\n"); }), HasSubstr("found 'fx 900' behind"));
  EXPECT_THAT(error_of([] { parsed("{\"fx\": 700}}\n"); }), HasSubstr("malformed"));
}

TEST(NumberTableText, DocumentsMayBeginOnTheLineOfTheirBorder) {
  const auto table = parsed("%YAML:1.0\n---\na: 1\n...\n--- # more\nb: 2\n--- {c: 3}\n...\n");
  EXPECT_EQ(table.require_number("a") + table.require_number("b") + table.require_number("c"), 6.0);
}

TEST(NumberTableText, ABlankMayBeMissingBehindAKey) {
  const auto table = parsed("Fx:2301.3\nCamera:\n  K:[1, 2]\nhost: a\n  b:c\nBaseline: 0.36\n");
  EXPECT_EQ(table.require_number("Fx"), 2301.3);
  EXPECT_THAT(table.require("Camera.K"), ElementsAre(1, 2));
  EXPECT_EQ(table.require_number("Baseline"), 0.36);
  EXPECT_THAT(error_of([] { parsed("unit:mm\nBaseline: 360\n"); }),
              HasSubstr("c: line 1: malformed YAML: found no blank behind 'unit:'"));
}

TEST(NumberTableText, ADecimalCommaInAFlowMapIsRefusedByItsName) {
  EXPECT_THAT(error_of([] { parsed("{\"fx\": 721.5, \"baseline\": 1,2}"); }),
              HasSubstr("c: baseline: found '1,2', expected a decimal point"));
  EXPECT_THAT(error_of([] { parsed("{\"fx\": 721,5377, \"fy\": 721,5377}"); }), HasSubstr("c: fx: found '721,5377'"));
  EXPECT_THAT(error_of([] { parsed("{\"intrinsic\": {\"u0\": 609, \"z\": 1,65}}"); }), HasSubstr("c: z: found '1,65'"));
  EXPECT_THAT(error_of([] { parsed("fx: 700\nstereo: {baseline: 1,2, unit: m}\n"); }),
              HasSubstr("c: baseline: found '1,2'"));
  EXPECT_EQ(parsed("{fx: 700, cameras: {0, 1}, note: null, \"7\": null}").require_number("fx"), 700.0);
}

TEST(NumberTableText, DecimalCommasAreNamedWhereThereAreTooManyNumbers) {
  const auto hint = HasSubstr("is a comma meant as a decimal point?");
  EXPECT_THAT(error_of([] { parsed("fx: 721,5377\ncx: 609\n").require_number("fx"); }),
              AllOf(HasSubstr("c: fx: found 2 numbers, expected 1"), hint));
  EXPECT_THAT(error_of([] { parsed("k: [740,0, 738.5, 490.0, 132.0]\n").require("k", 4); }), hint);
  EXPECT_THAT(error_of([] { parsed("k: [740.5, 738.5, 490.5, 132.5, 0.5]\n").require("k", 4); }), Not(hint));
  EXPECT_THAT(error_of([] { parsed("k: [740, 738, 490]\n").require("k", 4); }), Not(hint));
}

TEST(NumberTableText, AListWithoutItsEndIsRefused) {
  EXPECT_THAT(error_of([] { parsed("[A]\nsize = [640 480]\npose = [0.5 0.1 0\n"); }),
              HasSubstr("c: A.pose: found no ']' at the end of its list"));
  EXPECT_THAT(error_of([] { parsed("cc_left = [ 508.0 ; 138.0\nkc_left = [ 0 ; 0 ];\n"); }),
              HasSubstr("c: cc_left: found no ']'"));
  const auto table = parsed("cc_left = [ 508.0 ;\n 138.0 ];\nkc_left = [ 0 ; 0 ];\n");
  EXPECT_THAT(table.require("cc_left"), ElementsAre(508.0, 138.0));
}

/// What OpenCV 4's FileStorage writes of [700 0 600; 0 702 180; 0 0 1].
constexpr const char* kMatrix =
    "MWQgICAgICAgICAgICAgICAgICAgICAgAAAAAADghUAAAAAAAAAAAAAAAAAAwIJAAAAAAAAAAAAAAAAAAPCFQAAAAAAAgGZAAAAAAAAAAAAAAAAA"
    "AAAAAAAAAAAAAPA/";

TEST(NumberTableText, OpenCvsBase64IsReadInAllItsSyntaxes) {
  const std::string text = kMatrix, head = text.substr(0, 60), tail = text.substr(60);
  for (const std::string& file :
       {"%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: !!binary |\n      " + head +
            "\n      " + tail + "\n",
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1 type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  "
        "<cols>3</cols>\n"
        "  <dt>d</dt>\n  <data type_id=\"binary\">\n    " +
            head + "\n    " + tail + "\n  </data></M1>\n</opencv_storage>\n",
        "{\"M1\": {\"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\", \"data\": \"$base64$" +
            text + "\"}}"}) {
    SCOPED_TRACE(file);
    EXPECT_THAT(parsed(file).require("M1"), ElementsAre(700, 0, 600, 0, 702, 180, 0, 0, 1));
  }
}

TEST(NumberTableText, Base64HasItsOwnTypeAndIsAFaultOnlyWhereItIsAskedFor) {
  // "2f", and 1.5 and -2 in four bytes each; "f" and three bytes; "if", a structure.
  const auto one = parsed("a: !!binary |\n  MmYgICAgICAgICAgICAgICAgICAgICAgAADAPwAAAMA=\nb: 1\n");
  EXPECT_THAT(one.require("a"), ElementsAre(1.5, -2));
  for (const char* damaged :
       {"ZiAgICAgICAgICAgICAgICAgICAgICAgAADA", "aWYgICAgICAgICAgICAgICAgICAgICAgAADAPwAAAMA=", "?"}) {
    const auto table = parsed(std::string("a: !!binary |\n  ") + damaged + "\nb: 1\n");
    EXPECT_EQ(table.require_number("b"), 1.0);
    EXPECT_THAT(error_of([&] { table.require("a"); }),
                HasSubstr("c: a: found 'Base64 that OpenCV cannot have written"));
  }
}

}  // namespace
}  // namespace flies
