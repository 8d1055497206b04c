#include "flies/draw/curves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace flies {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Rows, from the top, of the pixels in which two pictures of one size differ; none when they are equal.
cv::Range changed_rows(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat rows;
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  cv::reduce(difference.reshape(1), rows, 1, cv::REDUCE_MAX);
  int first = -1, last = -1;
  for (int v = 0; v < rows.rows; ++v)
    if (rows.at<std::uint8_t>(v) > 0) first = first < 0 ? v : first, last = v;
  return first < 0 ? cv::Range(0, 0) : cv::Range(first, last + 1);
}

ErrorCurve flat_curve(double miss_rate) { return {"", {{1e-5, miss_rate}, {1e-1, miss_rate}}, {}}; }

TEST(DrawErrorCurves, DrawsAWorseCurveHigher) {
  const cv::Mat empty = draw_error_curves({}, {});
  const auto rows_of = [&](double miss_rate) {
    const ErrorCurve curve = flat_curve(miss_rate);
    return changed_rows(draw_error_curves({&curve, 1}), empty);
  };
  EXPECT_LT(rows_of(0.5).start, rows_of(0.2).start);
  EXPECT_LT(rows_of(0.2).start, rows_of(0.05).start);
}

TEST(DrawErrorCurves, RunsAlongTheLowerEdgeWhereNothingIsMissed) {
  const cv::Mat empty = draw_error_curves({}, {});
  const ErrorCurve perfect = flat_curve(0.0), least = flat_curve(ErrorAxes{}.min_miss_rate);
  const cv::Mat drawn = draw_error_curves({&perfect, 1});
  EXPECT_GT(changed_rows(drawn, empty).size(), 0);
  EXPECT_EQ(cv::norm(drawn, draw_error_curves({&least, 1}), cv::NORM_INF), 0.0);
}

TEST(DrawErrorCurves, MarksTheOperatingPoint) {
  ErrorCurve curve = flat_curve(0.1);
  const cv::Mat without = draw_error_curves({&curve, 1});
  const auto middle = [](const cv::Range& range) { return 0.5 * (range.start + range.end); };
  const double row_of_curve = changed_rows(without, draw_error_curves({}, {})).start;  // its key stands lower
  const auto columns_of = [&](double false_positives) {
    curve.operating_point = ErrorPoint{false_positives, 0.1};
    const cv::Mat with = draw_error_curves({&curve, 1});
    const cv::Range rows = changed_rows(with, without);
    EXPECT_NEAR(rows.size(), 11, 3);  // a disc
    EXPECT_NEAR(middle(rows), row_of_curve, 3.0) << "on the curve";
    return changed_rows(with.t(), without.t());
  };
  EXPECT_NEAR(columns_of(1e-3).size(), 11, 3);
  EXPECT_LT(columns_of(1e-4).end, columns_of(1e-2).start);
}

TEST(DrawErrorCurves, LeavesOutWhatIsNotFinite) {
  const ErrorCurve bad{"", {{kNaN, 0.1}, {0.01, kNaN}}, ErrorPoint{kNaN, kNaN}};
  EXPECT_EQ(changed_rows(draw_error_curves({}), draw_error_curves({}, {})).size(), 0);
  const ErrorCurve none;
  EXPECT_EQ(cv::norm(draw_error_curves({&bad, 1}), draw_error_curves({&none, 1}), cv::NORM_INF), 0.0);
}

TEST(DrawReliability, DrawsALargerShareHigher) {
  const cv::Mat empty = draw_reliability({});
  const auto rows_of = [&](double share) {
    const ReliabilityCurve curve{"", {{0.2, share}, {0.4, share}}};
    return changed_rows(draw_reliability({&curve, 1}), empty);
  };
  EXPECT_LT(rows_of(0.9).start, rows_of(0.6).start);
  const ReliabilityCurve bad{"", {{kNaN, 0.5}}}, none;
  EXPECT_EQ(cv::norm(draw_reliability({&bad, 1}), draw_reliability({&none, 1}), cv::NORM_INF), 0.0);
}

TEST(DrawScoreHistograms, ShowsFewPositivesBesideManyNegatives) {
  ScorePlot plot{"", {1.0, 1.1, 1.2}, std::vector<double>(10000, -1.0), {}};
  const cv::Mat both = draw_score_histograms(plot);
  ASSERT_EQ(both.type(), CV_8UC3);
  plot.positives.resize(2);  // the third of three is a large share
  plot.positives.push_back(0.0);
  EXPECT_GT(changed_rows(both, draw_score_histograms(plot)).size(), 0);
}

TEST(DrawScoreHistograms, TakesEmptyEqualAndInfiniteScores) {
  EXPECT_FALSE(draw_score_histograms({}).empty());
  EXPECT_FALSE(draw_score_histograms({"", {2.0}, {2.0}, 2.0}).empty());
  EXPECT_FALSE(draw_score_histograms({"", {kNaN}, {-std::numeric_limits<double>::infinity()}, kNaN}).empty());
}

}  // namespace
}  // namespace flies
