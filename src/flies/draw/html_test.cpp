#include "flies/draw/html.hpp"

#include <gtest/gtest.h>

namespace flies {
namespace {

TEST(HtmlText, EscapesWhatHtmlReads) {
  EXPECT_EQ(html_text("<a href=\"x\"> & co"), "&lt;a href=&quot;x&quot;&gt; &amp; co");
}

TEST(HtmlImage, HoldsThePictureInTheSaidFormat) {
  const cv::Mat picture(4, 5, CV_8UC3, cv::Scalar(10, 20, 30));
  const std::string png = html_image(picture), jpeg = html_image(picture, true);
  // The first bytes of the formats, 89 50 4E and FF D8 FF, in base 64.
  EXPECT_TRUE(png.starts_with("data:image/png;base64,iVBO")) << png;
  EXPECT_TRUE(jpeg.starts_with("data:image/jpeg;base64,/9j/")) << jpeg;
  EXPECT_EQ((png.size() - png.find(',') - 1) % 4, 0u) << "base 64 comes in groups of four";
}

}  // namespace
}  // namespace flies
