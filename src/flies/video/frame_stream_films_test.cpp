// The times of films, and whether they end early.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "flies/video/frame_stream.hpp"
#include "flies/video/told.hpp"

namespace flies {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using testing::file_options;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::Told;

/// A film whose pictures have these stamps.
class StampedFilm final : public FrameReader {
 public:
  explicit StampedFilm(std::vector<double> stamps_s, double rate_hz = 10.0, bool is_incomplete = true)
      : stamps_s_(std::move(stamps_s)), rate_hz_(rate_hz), is_incomplete_(is_incomplete) {}
  bool read(SourceFrame& frame) override {
    if (next_ == stamps_s_.size()) return false;
    frame.images.left = {1, 1, {9}};
    frame.stamp_s = stamps_s_[next_++];
    return true;
  }
  double rate_hz() const override { return rate_hz_; }
  std::uint64_t frames() const override { return 10; }
  bool is_incomplete() const override { return is_incomplete_; }

 private:
  std::vector<double> stamps_s_;
  double rate_hz_;
  bool is_incomplete_;
  std::size_t next_ = 0;
};

std::vector<double> times_of(const StampedFilm& film, FrameStreamOptions options, Told& told) {
  options.is_patient = true;
  FrameStream stream([film] { return std::make_unique<StampedFilm>(film); }, options, told.tell(),
                     std::chrono::steady_clock::now());
  std::vector<double> times_s;
  SourceFrame frame;
  for (auto answer = stream.next(frame, 5s); answer == FrameStream::Answer::frame; answer = stream.next(frame, 5s))
    times_s.push_back(frame.time_s);
  return times_s;
}

TEST(FrameStream, FilmHasTheTimesOfItsStampsUnlessARateIsGiven) {
  Told told;
  const StampedFilm film({0.0, 0.1, 0.3, 0.9});
  FrameStreamOptions options = file_options();
  EXPECT_THAT(times_of(film, options, told), ElementsAre(0.0, 0.1, 0.3, 0.9));
  options.rate_hz = 4.0;
  EXPECT_THAT(times_of(film, options, told), ElementsAre(0.0, 0.25, 0.5, 0.75));
}

TEST(FrameStream, OnlyAFilmThatLacksSomethingEndsEarly) {
  const std::vector<double> stamps_s = {0.0, 0.1, 0.2, 0.3};
  Told whole, cut, sparse;
  times_of(StampedFilm(stamps_s, 10.0, false), file_options(), whole);
  EXPECT_THAT(whole.sentences(), SizeIs(0));
  times_of(StampedFilm(stamps_s), file_options(), cut);
  EXPECT_THAT(cut.sentences(),
              ElementsAre("toy: ends after 0.40 of the 1.00 s that it says it lasts; is it damaged or cut off?"));
  times_of(StampedFilm({0.0, 0.5, 0.9}), file_options(), sparse);
  EXPECT_THAT(sparse.sentences(), SizeIs(0)) << "fewer pictures, but to the end";
}

TEST(FrameStream, FilmWithoutARateIsTold) {
  Told without, stamped;
  EXPECT_THAT(times_of(StampedFilm({0.0, 0.0, 0.0}, 0.0), file_options(), without), ElementsAre(0.0, 0.1, 0.2));
  EXPECT_THAT(
      without.sentences(),
      ::testing::Contains("toy: the film has no times: 10 pairs per second are assumed (--rate gives another)"));
  EXPECT_THAT(times_of(StampedFilm({0.0, 0.25, 0.5}, 0.0), file_options(), stamped), ElementsAre(0.0, 0.25, 0.5));
  EXPECT_THAT(stamped.sentences(), ::testing::Not(::testing::Contains(HasSubstr("assumed"))));
}

}  // namespace
}  // namespace flies
