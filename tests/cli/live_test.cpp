#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <utility>
#include <vector>

#include "flies/video/toy_video.hpp"
#include "live_command.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;
using ::testing::SizeIs;

std::vector<cv::Mat> pictures_of(const fs::path& film) {
  std::vector<cv::Mat> pictures;
  cv::VideoCapture capture(film.string());
  for (cv::Mat picture; capture.read(picture);) pictures.push_back(picture.clone());
  return pictures;
}

TEST_F(LiveCommand, FollowsAFilmOfBothPictures) {
  const auto all = records({"beside.avi", "--calib", "calib.txt", "--every-pair", "--json", "-"});
  ASSERT_THAT(all, SizeIs(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const json& record = all[static_cast<std::size_t>(i)];
    EXPECT_EQ(record.at("frame"), i);
    EXPECT_NEAR(record.at("time_s").get<double>(), i / 20.0, 1e-3);
    EXPECT_GT(record.at("live").at("latency_ms").get<double>(), 0.0);
    EXPECT_EQ(record.at("live").at("dropped"), 0);
    EXPECT_EQ(record.at("live").at("skipped"), 0);
    EXPECT_TRUE(sees_the_box(record)) << i;
  }
  EXPECT_TRUE(all.back().at("ego").at("is_known").get<bool>());
}

TEST_F(LiveCommand, IsMadeOfWhatTrackIsMadeOf) {
  const Words common = {"left", "right", "--rate", "20", "--calib", "calib.txt", "--mount", "given", "--json", "-"};
  Words live = common, track = common;
  live.insert(live.end(), {"--every-pair", "--camera-height", "0.5"});
  track.insert(track.begin(), "track");
  track.insert(track.end(), {"--camera-height", "0.5"});
  live.insert(live.begin(), "live");
  const RunResult of_live = run_flies(folder.path(), live), of_track = run_flies(folder.path(), track);
  ASSERT_EQ(of_live.status, 0) << of_live.err;
  ASSERT_EQ(of_track.status, 0) << of_track.err;
  const json run = json::parse(lines(of_live.out).front()).at("run");
  EXPECT_EQ(run, json::parse(lines(of_track.out).front()).at("run"));
  EXPECT_EQ(run.at("people_model"), "flies-48x96-network");
  EXPECT_LT(run.at("options").at("road.x_min_m").get<double>(), 4.0) << "a low camera sees the road sooner";
}

TEST_F(LiveCommand, FoldersComeInTheirOwnTimes) {
  std::ofstream(folder.path() / "times.txt") << "5.0\n5.2\n5.25\n";
  const auto times_of = [](const std::vector<json>& all) {
    std::vector<double> times_s;
    for (const auto& record : all) times_s.push_back(record.at("time_s").get<double>());
    return times_s;
  };
  const Words words = {"left", "right", "--calib", "calib.txt", "--every-pair", "--json", "-"};
  Words with_times = words;
  with_times.insert(with_times.end(), {"--times", "times.txt"});
  EXPECT_THAT(times_of(records(with_times)), Pointwise(DoubleNear(1e-6), {0.0, 0.2, 0.25}));
  EXPECT_THAT(times_of(records(words)), Pointwise(DoubleNear(1e-6), {0.0, 0.1, 0.2})) << "10 a second";

  const RunResult film = run({"beside.avi", "--calib", "calib.txt", "--times", "times.txt"});
  EXPECT_EQ(film.status, 2);
  EXPECT_THAT(film.err, HasSubstr("--times: is for folders of images"));
}

TEST_F(LiveCommand, QuietSaysNothingButResults) {
  const RunResult result =
      run({"left", "right", "--rate", "20", "--calib", "calib.txt", "--every-pair", "--json", "-", "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(lines(result.out), SizeIs(3));
}

TEST_F(LiveCommand, AllWaysToGiveTwoPicturesSeeTheSame) {
  for (const Words& source : {Words{"below.avi", "--layout", "top-bottom"}, Words{"l.avi", "r.avi"},
                              Words{"left", "right", "--rate", "20"}}) {
    Words words = source;
    for (const char* word : {"--calib", "calib.txt", "--every-pair", "--json", "-"}) words.emplace_back(word);
    const auto all = records(words);
    ASSERT_GE(all.size(), 3U) << source[0];
    EXPECT_TRUE(sees_the_box(all.back())) << source[0];
  }
}

TEST_F(LiveCommand, LoopsUntilEnoughPairs) {
  const auto all =
      records({"left", "right", "--calib", "calib.txt", "--rate", "50", "--loop", "--pairs", "7", "--json", "-"});
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.back().at("frame"), 6);
  EXPECT_NEAR(all.back().at("time_s").get<double>(), 6 / 50.0, 1e-6);
  EXPECT_EQ(all.back().at("live").at("dropped").get<std::size_t>(), 7 - all.size());
}

TEST_F(LiveCommand, RecordsWhatTrackReads) {
  // A mount that is far from the default: what is read back must have it.
  const Words mount = {"--camera-height", "1.65", "--camera-pitch", "2", "--camera-roll", "-3", "--mount", "given"};
  Words words = {"live", "beside.avi", "--calib", "calib.txt", "--every-pair", "--record", "r.mcap", "--json", "-"};
  words.insert(words.end(), mount.begin(), mount.end());
  const RunResult live = run_flies(folder.path(), words);
  ASSERT_EQ(live.status, 0) << live.err;
  const RunResult track = run_flies(folder.path(), {"track", "r.mcap", "--mount", "given", "--json", "-"});
  ASSERT_EQ(track.status, 0) << track.err;
  const auto before = lines(live.out), after = lines(track.out);
  ASSERT_EQ(before.size(), after.size());
  const json old_record = json::parse(before.back()), new_record = json::parse(after.back());
  EXPECT_NEAR(new_record.at("time_s").get<double>(), old_record.at("time_s").get<double>(), 1e-6);
  constexpr double kJpeg_m = 0.3;
  const auto &old_first = old_record.at("obstacles").at(0), &new_first = new_record.at("obstacles").at(0);
  for (const char* key : {"x_m", "y_m", "height_m"})
    EXPECT_NEAR(new_first.at(key).get<double>(), old_first.at(key).get<double>(), kJpeg_m) << key;
  const RunResult level =
      run_flies(folder.path(), {"track", "r.mcap", "--mount", "given", "--camera-pitch", "-2", "--json", "-"});
  EXPECT_NE(json::parse(lines(level.out).back()).at("obstacles").at(0).at("height_m"), new_first.at("height_m"));
}

TEST_F(LiveCommand, FaultsOfRecordingsAreTold) {
  write_text(folder.path() / "text.mcap", "no recording");
  const RunResult one = run_flies(folder.path(), {"track", "text.mcap"});
  EXPECT_EQ(one.status, 2);
  EXPECT_EQ(one.err, "flies: text.mcap: is no MCAP recording\n");
  const RunResult absent = run_flies(folder.path(), {"track", "absent.mcap"});
  EXPECT_EQ(absent.err, "flies: absent.mcap: cannot be read\n");
  EXPECT_EQ(run({"beside.avi", "--calib", "calib.txt", "--record", "no/r.mcap"}).err,
            "flies: no/r.mcap: cannot be written: No such file or directory\n");
  EXPECT_THAT(run({"beside.avi", "--calib", "calib.txt", "--foxglove", "1234567"}).err, HasSubstr("--foxglove"));
  EXPECT_THAT(run({"beside.avi", "--calib", "calib.txt", "--foxglove", "0", "--foxglove-address", "here"}).err,
              HasSubstr("here:0: is no IP address"));
  EXPECT_THAT(run({"beside.avi", "--calib", "calib.txt", "--view", "0", "--view-address", "192.0.2.1"}).err,
              HasSubstr("192.0.2.1:0: cannot be listened on"));
}

TEST_F(LiveCommand, InterruptEndsCleanly) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove(folder.path() / "out.jsonl");
    fs::remove(folder.path() / "out.mp4");
    const RunResult result =
        interrupt_flies(folder.path(),
                        {"live", "beside.avi", "--calib", "calib.txt", "--loop", "--json", "out.jsonl", "--video",
                         "out.mp4", "--camera-height", "1.65", "--camera-pitch", "0"},
                        signal, [&] { return are_written(folder.path(), "out.jsonl", 2); });
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("pairs, "));
    const std::string text = read_text(folder.path() / "out.jsonl");
    ASSERT_FALSE(text.empty());
    EXPECT_EQ(text.back(), '\n');
    for (const auto& line : lines(text)) EXPECT_TRUE(json::accept(line));
    EXPECT_GE(pictures_of(folder.path() / "out.mp4").size(), 1u);
  }
}

TEST_F(LiveCommand, FilmTakesAsLongAsTheSource) {
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--every-pair", "--video", "out.mp4"});
  ASSERT_EQ(result.status, 0) << result.err;
  // From the first pair to the last 7/20 s, each picture kept until the next: 10.5 of 30 a second, and the last one.
  const auto film = pictures_of(folder.path() / "out.mp4");
  EXPECT_NEAR(static_cast<double>(film.size()), (kFrames - 1) / 20.0 * 30.0 + 1.0, 0.5);
  // The left picture is in it, with the view from above beside it.
  const cv::Mat& left = street_pair().left;
  ASSERT_FALSE(film.empty());
  EXPECT_GT(film.back().cols, left.cols);
  EXPECT_GE(film.back().rows, left.rows);
  EXPECT_GT(cv::norm(film.front(), cv::NORM_INF), 128.0);
}

TEST_F(LiveCommand, FilmThatCannotBeIsRefusedBeforeTheRun) {
  const auto before = folder.listing();
  const RunResult kind = run({"beside.avi", "--calib", "calib.txt", "--video", "out.avi"});
  EXPECT_EQ(kind.status, 2);
  EXPECT_THAT(kind.err, HasSubstr("out.avi"));
  const RunResult place = run({"beside.avi", "--calib", "calib.txt", "--video", "no/out.mp4"});
  EXPECT_EQ(place.status, 2);
  EXPECT_THAT(place.err, HasSubstr("no/out.mp4: cannot be written"));
  EXPECT_EQ(folder.listing(), before);
}

TEST_F(LiveCommand, PrintsATableWithoutOutputs) {
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--every-pair"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("camera "));
  EXPECT_THAT(result.err, HasSubstr("8 pairs, "));
}

TEST_F(LiveCommand, PipelineThatEndsIsStartedAgain) {
  if (!has_gstreamer()) GTEST_SKIP() << "GStreamer's test sources are not there";
  const RunResult result =
      run({"filesrc location=beside.avi ! avidemux ! jpegdec", "--calib", "calib.txt", "--pairs", "20", "--json", "-"});
  if (result.status == 2) GTEST_SKIP() << "GStreamer's good plugins are not there: " << result.err;
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("gives no more pictures; trying again"));
  EXPECT_THAT(result.err, HasSubstr("is back"));
  EXPECT_EQ(json::parse(lines(result.out).back()).at("frame"), 19);
}

TEST_F(LiveCommand, FaultsAreToldInOneLine) {
  write_text(folder.path() / "text.avi", "no film");
  write_film(folder.path() / "odd.avi", cv::Mat(240, 322 * 2, CV_8UC1, cv::Scalar(9)), 2);
  const std::vector<std::pair<Words, std::string>> faults = {
      {{"absent.avi", "--calib", "calib.txt"}, "absent.avi: does not exist"},
      {{"text.avi", "--calib", "calib.txt"}, "text.avi: cannot be read as a film"},
      {{"/dev/video987", "--calib", "calib.txt"}, "/dev/video987: no camera"},
      {{"beside.avi"}, "--calib"},
      {{"beside.avi", "--calib", "absent.txt"}, "absent.txt: does not exist"},
      {{"beside.avi", "--calib", "calib.txt", "--layout", "diagonal"},
       "--split: found 'diagonal', expected none, side or top"},
      {{"beside.avi", "--calib", "calib.txt", "--lop"}, "did you mean --loop?"},
      {{"beside.avi", "--calib", "calib.txt", "--pairs", "0"}, "--pairs"},
      {{"beside.avi", "--calib", "calib.txt", "--json", "no/such/folder.jsonl"},
       "no/such/folder.jsonl: cannot be written"},
      {{"beside.avi", "--calib", "calib.txt", "--record", "-"}, "--record: cannot go to standard output"},
      {{"beside.avi", "--calib", "calib.txt", "--record", "beside.avi"}, "--record: this file is already an input"},
      {{"beside.avi", "--calib", "calib.txt", "--json", "f", "--record", "f"}, "f: --record: this file is already"},
      {{"left", "beside.avi", "--calib", "calib.txt"}, "beside.avi"},
      {{"videotestsrc ! " + std::string(300, 'x'), "--calib", "calib.txt"}, "videotestsrc ! xxx"},
      {{"beside.avi", "--calib", std::string(300, 'x')}, "does not exist"},
  };
  for (const auto& [words, expected] : faults) {
    const RunResult result = run(words);
    EXPECT_EQ(result.status, 2) << expected << result.err;
    EXPECT_THAT(lines(result.err), SizeIs(1));
    EXPECT_THAT(result.err, HasSubstr(expected));
  }
}

TEST_F(LiveCommand, OptionsThatCannotApplyAreRefused) {
  const std::vector<std::pair<Words, std::string>> faults = {
      {{"beside.avi", "--view-address", "0.0.0.0"}, "--view-address requires --view"},
      {{"beside.avi", "--foxglove-address", "0.0.0.0"}, "--foxglove-address requires --foxglove"},
      {{"l.avi", "r.avi", "--split", "top"}, "r.avi: is not needed: with --split one source holds both images"},
      {{"beside.avi", "--size", "640,240"}, "--size: is asked of cameras (0, /dev/video0), and beside.avi is none"},
      {{"left", "right", "--size", "640,240"}, "--size: is asked of cameras"},
      {{"beside.avi", "--max-skew", "5"}, "--max-skew: is for two cameras, films or pipelines"},
      {{"left", "right", "--max-skew", "5"}, "--max-skew: is for two cameras, films or pipelines"},
      {{"/dev/video987", "--loop"}, "--loop: is for films and folders, and /dev/video987 is neither"},
      {{"videotestsrc ! identity", "--rate", "5"}, "--rate: is for cameras, films and folders"},
  };
  for (auto [words, expected] : faults) {
    words.insert(words.end(), {"--calib", "calib.txt"});
    const RunResult result = run(words);
    EXPECT_EQ(result.status, 2) << expected;
    EXPECT_THAT(lines(result.err), SizeIs(1));
    EXPECT_THAT(result.err, HasSubstr(expected));
  }
}

TEST_F(LiveCommand, StartThatFailsLeavesOldOutputsAlone) {
  write_text(folder.path() / "text.avi", "no film");
  cv::Mat beside;
  cv::hconcat(street_pair().left, unrelated_picture(), beside);
  write_film(folder.path() / "unrelated.avi", beside, 3);
  for (const char* name : {"out.jsonl", "out.mcap"}) write_text(folder.path() / name, "of an earlier run");
  for (const char* source : {"text.avi", "unrelated.avi"}) {
    const RunResult result = run({source, "--calib", "calib.txt", "--json", "out.jsonl", "--record", "out.mcap"});
    EXPECT_EQ(result.status, 2) << source;
    for (const char* name : {"out.jsonl", "out.mcap"})
      EXPECT_EQ(read_text(folder.path() / name), "of an earlier run") << source;
  }
  const RunResult result =
      run({"beside.avi", "--calib", "calib.txt", "--every-pair", "--json", "out.jsonl", "--record", "out.mcap"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(lines(read_text(folder.path() / "out.jsonl")), SizeIs(kFrames));
  EXPECT_THAT(read_text(folder.path() / "out.mcap"), Not(HasSubstr("of an earlier run")));
}

TEST_F(LiveCommand, CountsOnePairInTheSingular) {
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--pairs", "1", "--json", "-"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(lines(result.err).back(), HasSubstr("flies: 1 pair, "));
}

TEST_F(LiveCommand, FullDiskEndsTheRun) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const RunResult result = run({"beside.avi", "--calib", "calib.txt", "--loop", "--json", "/dev/full"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("/dev/full: cannot write"));
}

TEST_F(LiveCommand, DiskThatFillsUpInTheMiddleLeavesWhatIsWhole) {
  const Words endless = {"left", "right", "--calib", "calib.txt", "--every-pair", "--loop"};
  const auto run_into_limit = [&](const char* option, const char* file, const char* limit = "ulimit -f 2000;") {
    Words words = endless;
    words.insert(words.end(), {option, file, "--pairs", "300"});
    const RunResult result = run(words, limit);
    EXPECT_EQ(result.status, 2) << file;
    EXPECT_THAT(result.err, HasSubstr(std::string(file) + ": cannot"));
    return result;
  };
  run_into_limit("--json", "out.jsonl");
  const auto written = lines(read_text(folder.path() / "out.jsonl"));
  ASSERT_FALSE(written.empty());
  for (std::size_t i = 0; i < written.size(); ++i) EXPECT_EQ(json::parse(written[i]).at("frame"), i);

  run_into_limit("--record", "out.mcap");
  const RunResult track = run_flies(folder.path(), {"track", "out.mcap", "--json", "-"});
  EXPECT_EQ(track.status, 0) << track.err;
  EXPECT_FALSE(lines(track.out).empty());

  run_into_limit("--record", "short.mcap", "ulimit -f 100;");
  const RunResult none = run_flies(folder.path(), {"track", "short.mcap"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(
      none.err,
      HasSubstr("short.mcap: is cut off or damaged, and the intact part of it holds no "));  // pictures, or pair

  const RunResult film = run_into_limit("--video", "out.mp4", "ulimit -f 8;");
  EXPECT_THAT(film.err, Not(HasSubstr("moov"))) << "FFmpeg's own words";
  EXPECT_FALSE(fs::exists(folder.path() / "out.mp4"));
}

TEST(LiveModules, OtherCommandsDoNotLoadThem) {
  const TestFolder folder;
  const RunResult result = run_flies(folder.path(), {"--version"}, "LD_TRACE_LOADED_OBJECTS=1");
  EXPECT_THAT(result.out, HasSubstr("libopencv_core"));
  for (const char* library : {"avcodec", "libgst", "videoio", "httplib"})
    EXPECT_THAT(result.out, Not(HasSubstr(library)));
}

}  // namespace
}  // namespace flies::testing
