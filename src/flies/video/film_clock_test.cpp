#include "flies/video/film_clock.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace flies {
namespace {

using ::testing::ElementsAre;
using ::testing::Pointwise;

std::vector<double> times_s(double rate_hz, const std::vector<double>& stamps_s) {
  FilmClock clock(rate_hz);
  std::vector<double> times;
  for (const double stamp_s : stamps_s) times.push_back(clock.next(stamp_s));
  return times;
}

TEST(FilmClock, StampsInWholeMillisecondsLeaveAnEvenRateEven) {
  constexpr double kRate_hz = 30000.0 / 1001.0;
  FilmClock clock(kRate_hz);
  for (int i = 0; i < 1000; ++i) EXPECT_DOUBLE_EQ(clock.next(std::round(1e3 * i / kRate_hz) / 1e3), i / kRate_hz) << i;
  EXPECT_TRUE(clock.has_stamps());
}

TEST(FilmClock, UnevenFilmGoesByItsStamps) {
  const std::vector<double> stamps = {0.0, 0.1, 0.3, 0.5, 0.6, 0.7, 0.9};
  EXPECT_THAT(times_s(10.0, stamps), Pointwise(::testing::DoubleNear(1e-9), stamps));
  EXPECT_THAT(times_s(7.5, stamps), Pointwise(::testing::DoubleNear(1e-9), stamps));
}

TEST(FilmClock, LastPicturesWithoutStampsComeInTheUsualStep) {
  EXPECT_THAT(times_s(10.0, {0.0, 0.1, 0.2, 0.0, 0.0}),
              Pointwise(::testing::DoubleNear(1e-9), {0.0, 0.1, 0.2, 0.3, 0.4}));
  EXPECT_THAT(times_s(7.5, {0.0, 0.1, 0.2, 0.3, 2.0, 0.0, 0.0}),
              Pointwise(::testing::DoubleNear(1e-9), {0.0, 0.1, 0.2, 0.3, 2.0, 2.1, 2.2}));
}

TEST(FilmClock, WithoutStampsTheRateCounts) {
  EXPECT_THAT(times_s(4.0, {0.0, 0.0, 0.0}), ElementsAre(0.0, 0.25, 0.5));
  FilmClock clock(4.0);
  EXPECT_DOUBLE_EQ(clock.next(std::nullopt), 0.0);
  EXPECT_DOUBLE_EQ(clock.next(std::nullopt), 0.25);
  EXPECT_FALSE(clock.has_stamps());
}

TEST(FilmClock, LaterFirstStampIsKept) {
  EXPECT_THAT(times_s(10.0, {0.3, 0.4, 0.5}), Pointwise(::testing::DoubleNear(1e-9), {0.3, 0.4, 0.5}));
}

}  // namespace
}  // namespace flies
