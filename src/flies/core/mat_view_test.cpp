#include "flies/core/mat_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace flies {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(MatView, SeesThePixelsOfTheMatrixWhereTheyAre) {
  cv::Mat image(6, 8, CV_8UC1);
  cv::randu(image, 0, 256);
  const cv::Mat region = image(cv::Rect(2, 1, 4, 3));
  const GrayView view = view_of(region);
  EXPECT_EQ(view.width_px, 4);
  EXPECT_EQ(view.height_px, 3);
  for (int v = 0; v < 3; ++v)
    for (int u = 0; u < 4; ++u) EXPECT_EQ(&view.row(v)[u], &image.at<std::uint8_t>(v + 1, u + 2));
  const cv::Mat back = mat_of(view);
  EXPECT_EQ(back.data, region.data);
  EXPECT_EQ(cv::norm(back, region, cv::NORM_INF), 0.0);
}

TEST(MatView, RefusesWhatIsNotGrey) {
  const auto view = [](const cv::Mat& image) { return view_of(image); };
  EXPECT_THAT([&] { view(cv::Mat()); }, ThrowsMessage<InputError>(HasSubstr("cv::Mat: size")));
  EXPECT_THAT([&] { view(cv::Mat(2, 2, CV_8UC3)); }, ThrowsMessage<InputError>(HasSubstr("found 3 channels")));
  EXPECT_THAT([&] { view(cv::Mat(2, 2, CV_16UC1)); }, ThrowsMessage<InputError>(HasSubstr("CV_8UC1")));
}

}  // namespace
}  // namespace flies
