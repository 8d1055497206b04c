// What becomes of the files of a run when another output of it ends early, or another run writes them.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
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

TEST_F(LiveOutputs, TheFirstSignalEndsTheRunThoughNobodyReadsItsLines) {
  const std::string pipe = (folder.path() / "p").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDWR);  // it never reads
  ASSERT_GE(reader, 0);
  constexpr int kLooks = 200;  // of a pipe that is full nothing changes any more
  int bytes = 0, same = 0;
  const RunResult result = interrupt_flies(
      folder.path(), {"live", "beside.avi", "--calib", "calib.txt", "--loop", "--every-pair", "--json", "p"}, SIGTERM,
      [&] {
        int now = 0;
        if (::ioctl(reader, FIONREAD, &now) != 0) return false;
        same = now == bytes && now > 0 ? same + 1 : 0;
        bytes = now;
        return same >= kLooks;
      });
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("p: is not read any more, so its last lines are missing"));
  ::close(reader);
}

TEST_F(LiveOutputs, OtherCommandsDoNotReplaceAFileThatIsBeingWritten) {
  const std::string path = (folder.path() / "out.jsonl").string();
  const int other = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  for (const char* option : {"--json", "--csv", "--scan"}) {
    const RunResult result =
        run_flies(folder.path(), {"detect", "left.png", "right.png", "--calib", "calib.txt", option, "out.jsonl"});
    EXPECT_EQ(result.status, 2) << option;
    EXPECT_EQ(lines(result.err).back(),
              "flies: out.jsonl: another run is writing it, expected another place for each run");
  }
  ::close(other);
}

TEST_F(LiveOutputs, SourcesOfTwoKindsAreTold) {
  const RunResult result = run({"l.avi", "right", "--calib", "calib.txt"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(lines(result.err).back(), "flies: right: is a folder, but l.avi is none: expected two sources of one kind");
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
