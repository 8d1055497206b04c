// What becomes of the files of a run when another output of it ends early, or another run writes them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/videoio.hpp>
#include <string>

#include "live_command.hpp"
#include "run_flies.hpp"

namespace flies::testing {
namespace {

using ::testing::HasSubstr;

struct LiveOutputs : LiveCommand {
  /// Somebody reads the first line of the pipe `p` only.
  static constexpr const char* kOneLineReader = "mkfifo p; (head -n1 p > first.jsonl) &";
  int pictures_of(const std::string& film) const {
    const cv::VideoCapture capture((folder.path() / film).string(), cv::CAP_FFMPEG);
    return capture.isOpened() ? static_cast<int>(capture.get(cv::CAP_PROP_FRAME_COUNT)) : 0;
  }
};

TEST_F(LiveOutputs, RecordingAndFilmAreClosedWellWhenTheReaderOfTheLinesGoesAway) {
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--loop", "--every-pair", "--pairs", "2000",
                                "--json", "p", "--record", "r.mcap", "--video", "v.mp4"},
                               kOneLineReader);
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(lines(result.err).back(), "flies: p: cannot write: whoever read it went away");
  EXPECT_GE(pictures_of("v.mp4"), 1);
  const RunResult track = run_flies(folder.path(), {"track", "r.mcap", "--json", "-"});
  EXPECT_EQ(track.status, 0);
  EXPECT_GE(lines(track.out).size(), 1U);
  EXPECT_THAT(track.err, ::testing::Not(HasSubstr("cut off")));
}

TEST_F(LiveOutputs, TheFilmOfTrackIsToo) {
  ASSERT_EQ(run({"beside.avi", "--calib", "calib.txt", "--loop", "--every-pair", "--pairs", "40", "--record", "r.mcap"})
                .status,
            0);
  const RunResult result =
      run_flies(folder.path(), {"track", "r.mcap", "--json", "p", "--video", "v.mp4"}, kOneLineReader);
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(lines(result.err).back(), "flies: p: cannot write: whoever read it went away");
  EXPECT_GE(pictures_of("v.mp4"), 1);
}

TEST_F(LiveOutputs, WithNothingElseToCloseAPipeThatClosesEndsTheRunQuietly) {
  const RunResult result =
      run({"beside.avi", "--calib", "calib.txt", "--loop", "--every-pair", "--pairs", "2000", "--json", "p"},
          kOneLineReader);
  EXPECT_EQ(result.status, 128 + SIGPIPE);
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("cannot write")));
}

TEST_F(LiveOutputs, ARecordingThatAnotherRunWritesIsRefused) {
  write_text(folder.path() / "r.mcap", "what another run has written");
  const int other = ::open((folder.path() / "r.mcap").c_str(), O_WRONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--every-pair", "--record", "r.mcap"});
  ::close(other);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err).back(), HasSubstr("r.mcap: another run is writing it"));
  EXPECT_EQ(read_text(folder.path() / "r.mcap"), "what another run has written");
}

}  // namespace
}  // namespace flies::testing
