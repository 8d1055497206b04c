#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// A camera that stands before a street for three pairs.
struct TrackCommand : ::testing::Test {
  TrackCommand() {
    write_street(folder.path());
    for (const char* side : {"left", "right"}) {
      fs::create_directory(folder.path() / side);
      for (int i = 0; i < 3; ++i)
        fs::copy_file(folder.path() / (std::string(side) + ".png"),
                      folder.path() / side / (std::to_string(i) + ".png"));
    }
  }
  RunResult run(const Words& more) const {
    Words words = {"track", "left", "right", "--camera-height", "1.65", "--camera-pitch", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run_flies(folder.path(), words);
  }
  TestFolder folder;
};

TEST_F(TrackCommand, WritesALineAPairWithTimeEgoAndTracks) {
  const RunResult result = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto text = lines(result.out);
  ASSERT_EQ(text.size(), 3U);
  const json last = json::parse(text[2]);
  EXPECT_NEAR(last.at("time_s").get<double>(), 0.1, 1e-9);
  EXPECT_TRUE(last.at("ego").at("is_known").is_boolean());
  EXPECT_FALSE(json::parse(text[0]).at("ego").at("is_known").get<bool>());
  EXPECT_TRUE(last.at("obstacles").is_array());
  ASSERT_FALSE(last.at("tracks").empty());
  for (const auto& track : last.at("tracks")) {
    EXPECT_GE(track.at("id").get<int>(), 1);
    for (const char* key : {"probability", "x_m", "y_m", "range_m", "vx_mps", "vy_mps", "width_m", "height_m", "age_s"})
      EXPECT_TRUE(track.at(key).is_number()) << key;
    EXPECT_TRUE(track.at("class") == "person" || track.at("class") == "other");
    EXPECT_TRUE(track.at("box").at("u_px").is_number());
  }
}

TEST_F(TrackCommand, APairThatCannotBeUsedCostsNoOther) {
  for (const char* name : {"0.png", "1.png"}) {
    write_text(folder.path() / "right" / name, "damaged");
    const RunResult result = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(lines(result.err).back(), AllOf(HasSubstr("of 3 pairs: could not be used, the others were"),
                                                HasSubstr("right/0.png: is not an image")));
    const auto text = lines(result.out);
    ASSERT_EQ(text.size(), 3U);
    const json first = json::parse(text.front()), last = json::parse(text.back());
    EXPECT_THAT(first.at("error").get<std::string>(), HasSubstr("right/0.png"));
    EXPECT_TRUE(first.at("tracks").empty());
    EXPECT_FALSE(first.contains("stage_ms"));
    EXPECT_FALSE(first.contains("road"));
    EXPECT_FALSE(last.contains("error"));
    EXPECT_FALSE(last.at("obstacles").empty());
    EXPECT_NEAR(last.at("time_s").get<double>(), 0.1, 1e-9);
  }
  write_text(folder.path() / "left" / "2.png", "damaged");
  const RunResult none = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
  EXPECT_EQ(none.status, 2);
  EXPECT_TRUE(none.out.empty());
}

TEST_F(TrackCommand, TellsWhenNoPairCouldBeUsed) {
  // Left and right differ in a corner, which is cut off by rectifying: only then they are one picture twice.
  std::string camera =
      "  camera_model: pinhole\n  intrinsics: [300, 300, 160, 120]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [-0.2, 0, 0, 0]\n  resolution: [320, 240]\n";
  write_text(folder.path() / "raw.yaml",
             "cam0:\n" + camera + "cam1:\n" + camera +
                 "  T_cn_cnm1: [[1, 0, 0, -0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  cv::Mat other = street_pair().left.clone();
  other.at<std::uint8_t>(0, 0) ^= 0xFF;
  for (const char* name : {"0.png", "1.png", "2.png"}) cv::imwrite((folder.path() / "right" / name).string(), other);
  const RunResult result = run({"--calib", "raw.yaml", "--rate", "20", "--json", "t.jsonl"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err).back(), HasSubstr("left: no pair could be used; the first error: "));
}

TEST_F(TrackCommand, FeetOfKittiStandOnTheRoadThatWasFound) {
  // Told 0.1 m too low: the road then lies 0.1 m below the vehicle's ground.
  Words words = {"track",           "left", "right",          "--calib", "calib.txt", "--rate", "20",
                 "--camera-height", "1.55", "--camera-pitch", "0",       "--mount",   "given"};
  words.insert(words.end(), {"--kitti", "t.txt", "--json", "t.jsonl"});
  const RunResult result = run_flies(folder.path(), words);
  ASSERT_EQ(result.status, 0) << result.err;
  const json road = json::parse(lines(read_text(folder.path() / "t.jsonl")).back()).at("road");
  EXPECT_LT(road.at("height_m").get<double>(), -0.05) << road;
  std::istringstream line(lines(read_text(folder.path() / "t.txt")).back());
  const std::vector<std::string> fields{std::istream_iterator<std::string>(line), {}};
  const double bottom_px = std::stod(fields.at(9)), right_m = std::stod(fields.at(13));
  const double down_m = std::stod(fields.at(14)), ahead_m = std::stod(fields.at(15));
  const auto of_road = [&](const char* key) { return road.at(key).get<double>(); };
  constexpr double kRounding_m = 0.006;  // centimetres are written
  EXPECT_NEAR(down_m, 1.55 - of_road("height_m") - of_road("slope") * ahead_m + of_road("bank") * right_m, kRounding_m);
  const StereoCamera camera = street_camera();
  EXPECT_NEAR(camera.cy_px + camera.fy_px * down_m / ahead_m, bottom_px, 1.5);
}

TEST_F(TrackCommand, TellsThatTheRateOverrulesTimes) {
  const auto notes = [&](const Words& more) {
    const RunResult result = run(more);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  const Words words = {"--calib", "calib.txt", "--rate", "20", "--json", "-"};
  EXPECT_THAT(notes(words), ::testing::Not(HasSubstr("instead of")));
  for (const char* side : {"left", "right"})
    for (const char* number : {"0", "1", "2"})
      fs::rename(folder.path() / side / (std::string(number) + ".png"),
                 folder.path() / side / ("1403636579" + std::string(number) + "63555584.png"));
  EXPECT_THAT(notes(words),
              HasSubstr("times are evenly spaced, 20 pairs per second (--rate), instead of those in the names"));
}

TEST_F(TrackCommand, TellsThatTimesOverruleTheRate) {
  write_text(folder.path() / "times.txt", "0.0\n0.1\n0.2\n");
  Words words = {"--calib", "calib.txt", "--times", "times.txt", "--json", "-"};
  EXPECT_THAT(run(words).err, ::testing::Not(HasSubstr("instead of")));
  words.insert(words.end(), {"--rate", "20"});
  const RunResult both = run(words);
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.err, HasSubstr("times are those in times.txt (--times), instead of 20 pairs per second (--rate)"));
}

TEST_F(TrackCommand, DoubtsTimesBetweenWhichNothingCanBeFollowed) {
  const auto notes = [&](const char* times) {
    write_text(folder.path() / "times.txt", times);
    return run({"--calib", "calib.txt", "--times", "times.txt", "--json", "t.jsonl"}).err;
  };
  EXPECT_THAT(notes("0\n100\n200\n"), HasSubstr("times.txt: pairs are 100 s apart or more, too long to follow "
                                                "anything: are these milliseconds? expected seconds"));
  EXPECT_THAT(notes("0\n100000\n200000\n"), HasSubstr("are these microseconds?"));
  for (const char* good : {"0\n0.1\n0.2\n", "0\n4\n8\n", "0\n0.1\n100\n"})
    EXPECT_THAT(notes(good), ::testing::Not(HasSubstr("apart"))) << good;
  EXPECT_THAT(notes("0\n0.0001\n0.0002\n"), HasSubstr("times.txt: pairs are 0.1 ms apart (median), closer than stereo "
                                                      "cameras take them"));
  const auto at_rate = [&](const char* rate) {
    return run({"--calib", "calib.txt", "--rate", rate, "--json", "t.jsonl"}).err;
  };
  EXPECT_THAT(at_rate("10000"), HasSubstr("--rate: pairs are 0.1 ms apart"));
  EXPECT_THAT(at_rate("1000"), ::testing::Not(HasSubstr("apart")));
}

TEST_F(TrackCommand, RefusesTopicsOfImages) {
  const RunResult result = run({"--calib", "calib.txt", "--rate", "20", "--topics", "a,b", "--json", "t.jsonl"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--topics: are those of a recording"));
  EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
}

TEST_F(TrackCommand, FilmShowsEachPairUntilTheTimeOfTheNext) {
  // The second is awaited for two seconds, not for five.
  write_text(folder.path() / "times.txt", "0.0\n0.1\n5.1\n");
  const RunResult result = run({"--calib", "calib.txt", "--times", "times.txt", "--video", "t.mp4"});
  ASSERT_EQ(result.status, 0) << result.err;
  cv::VideoCapture film((folder.path() / "t.mp4").string());
  EXPECT_NEAR(film.get(cv::CAP_PROP_FPS), 30.0, 1e-6);
  int pictures = 0;
  for (cv::Mat picture; film.read(picture);) ++pictures;
  EXPECT_EQ(pictures, 3 + 60 + 1);
}

TEST_F(TrackCommand, TellsHowMuchIsLeftWhereNothingElseIsPrinted) {
  // A terminal of its own; without one a line comes every half minute.
  const auto on_terminal = [&](const std::string& more) {
    write_text(folder.path() / "go.sh", "exec '" + std::string(FLIES_BINARY) +
                                            "' track left right --calib calib.txt --rate 20 --json t.jsonl " + more);
    const RunResult result = run_flies(folder.path(), {"info"}, "script -qec 'sh go.sh' /dev/null;", "> /dev/null");
    return result.out;
  };
  EXPECT_THAT(on_terminal(""), HasSubstr("3 of 3 pairs, 0 s left"));
  EXPECT_THAT(on_terminal("--quiet"), ::testing::Not(HasSubstr("pairs")));
}

TEST_F(TrackCommand, TakesTimesFromAFile) {
  write_text(folder.path() / "times.txt", "5.0\n5.5\n7.25\n");
  const RunResult result = run({"--calib", "calib.txt", "--times", "times.txt", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NEAR(json::parse(lines(result.out)[2]).at("time_s").get<double>(), 2.25, 1e-9);
}

TEST_F(TrackCommand, TimesOfALostPairAreLeftOut) {
  for (const char* side : {"left", "right"}) fs::rename(folder.path() / side / "2.png", folder.path() / side / "4.png");
  write_text(folder.path() / "times.txt", "5.0\n5.5\n7.25\n8.0\n9.0\n9.5\n");
  const auto last_time_s = [&](const RunResult& result) {
    return result.status == 0 ? json::parse(lines(result.out).at(2)).at("time_s").get<double>() : -1.0;
  };
  const RunResult by_file = run({"--calib", "calib.txt", "--times", "times.txt", "--json", "-"});
  EXPECT_NEAR(last_time_s(by_file), 4.0, 1e-9) << by_file.err;
  EXPECT_THAT(by_file.err, HasSubstr("holds 6 times for 3 pairs"));
  EXPECT_THAT(by_file.err, HasSubstr("jump from 1.png to 4.png"));
  const RunResult by_rate = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
  EXPECT_NEAR(last_time_s(by_rate), 0.2, 1e-9) << by_rate.err;
  EXPECT_THAT(by_rate.err, HasSubstr("jump from 1.png to 4.png: pairs are missing"));
}

TEST_F(TrackCommand, TakesTimesFromNames) {
  for (const std::string side : {"left", "right"})
    for (int i = 0; i < 3; ++i)
      fs::rename(folder.path() / side / (std::to_string(i) + ".png"),
                 folder.path() / side / (side + "_169876543" + std::to_string(i) + ".500.png"));
  const RunResult result = run({"--calib", "calib.txt", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NEAR(json::parse(lines(result.out).at(2)).at("time_s").get<double>(), 2.0, 1e-6);
  EXPECT_THAT(result.err, HasSubstr("times are those in the names of the images: 1 pairs per second"));
}

TEST_F(TrackCommand, WritesKittisTrackingFormat) {
  const RunResult result = run({"--calib", "calib.txt", "--rate", "10", "--kitti", "tracks.txt"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto text = lines(read_text(folder.path() / "tracks.txt"));
  ASSERT_FALSE(text.empty());
  for (const auto& line : text) EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 17) << line;
}

TEST_F(TrackCommand, PlacesOfKittisFormatAreOnTheRoadThatIsSeen) {
  const auto first_down_m = [&](const std::string& pitch_deg) {
    const RunResult result =
        run_flies(folder.path(), {"track", "left", "right", "--calib", "calib.txt", "--rate", "10", "--kitti", "-",
                                  "--camera-height", "1.65", "--camera-pitch", pitch_deg, "--mount", "given"});
    EXPECT_EQ(result.status, 0) << result.err;
    std::istringstream words(lines(result.out).at(0));
    return std::stod(std::vector<std::string>{std::istream_iterator<std::string>(words), {}}.at(14));
  };
  // What stands there is 1.65 m below the camera, whatever is said of the pitch.
  for (const char* pitch_deg : {"0", "2"}) EXPECT_NEAR(first_down_m(pitch_deg), 1.65, 0.03) << pitch_deg;
}

TEST_F(TrackCommand, RefusesAFileThatAnotherRunWrites) {
  write_text(folder.path() / "t.jsonl", "a line of another run\n");
  const int other = ::open((folder.path() / "t.jsonl").c_str(), O_WRONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  const RunResult result = run({"--calib", "calib.txt", "--rate", "10", "--json", "t.jsonl"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err).back(), HasSubstr("t.jsonl: another run is writing it"));
  EXPECT_EQ(read_text(folder.path() / "t.jsonl"), "a line of another run\n");
  ::close(other);
  EXPECT_EQ(run({"--calib", "calib.txt", "--rate", "10", "--json", "t.jsonl"}).status, 0);
  EXPECT_EQ(lines(read_text(folder.path() / "t.jsonl")).size(), 3U) << "emptied first";
}

TEST_F(TrackCommand, FilmThatDidNotFitOnTheDiskIsAFault) {
  const Words words = {"track", "left", "right", "--calib", "calib.txt", "--rate", "10", "--video", "t.mp4"};
  const auto before = folder.listing();
  const RunResult result = run_flies(folder.path(), words, "ulimit -f 4;");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(lines(result.err).back(), HasSubstr("t.mp4: cannot be written: 0 of 7 pictures"));
  EXPECT_EQ(folder.listing(), before);
}

TEST_F(TrackCommand, NamesLoopsOfLinks) {
  fs::create_symlink("loop", folder.path() / "loop");
  const RunResult drive = run_flies(folder.path(), {"track", "loop"});
  EXPECT_EQ(drive.status, 2);
  EXPECT_THAT(drive.err, HasSubstr("loop"));
  EXPECT_EQ(lines(drive.err).size(), 1U) << drive.err;
}

TEST_F(TrackCommand, TellsWhatGoesWrongInTheMiddleOfARun) {
  cv::Mat noise = street_pair().left.clone();
  std::for_each(noise.begin<std::uint8_t>(), noise.end<std::uint8_t>(),
                [](std::uint8_t& level) { level = static_cast<std::uint8_t>(level % 3); });
  cv::imwrite((folder.path() / "left" / "1.png").string(), noise);
  cv::imwrite((folder.path() / "left" / "2.png").string(), street_pair().right);
  cv::imwrite((folder.path() / "right" / "2.png").string(), street_pair().left);
  const RunResult result = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
  EXPECT_EQ(result.status, 2) << "of the swapped pair";
  EXPECT_THAT(result.err, HasSubstr("left/1.png: there is nothing to match in the left image"));
  EXPECT_THAT(result.err, HasSubstr("1 of 3 pairs: nothing to match in the left image; the first: left/1.png"));
  EXPECT_THAT(result.err, HasSubstr("left/1.png: the right image is identical to that of the previous pair"));
  EXPECT_THAT(result.err, HasSubstr("1 of 3 pairs: left and right swapped; the first: left/2.png"));
}

TEST_F(TrackCommand, PassesOverPairsThatAreNone) {
  const fs::path left = folder.path() / "left", right = folder.path() / "right";
  cv::imwrite((left / "1.png").string(), street_pair().right);
  cv::imwrite((right / "1.png").string(), street_pair().left);
  const auto records = [&](const char* fault) {
    const RunResult result = run({"--calib", "calib.txt", "--rate", "20", "--json", "-"});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(lines(result.err).back(), HasSubstr("1 of 3 pairs: could not be used, the others were"));
    EXPECT_EQ(lines(result.out).size(), 3U);
    const json passed_over = json::parse(lines(result.out).at(1));
    EXPECT_THAT(passed_over.at("error").get<std::string>(), HasSubstr(fault));
    EXPECT_TRUE(passed_over.at("obstacles").empty());
    EXPECT_TRUE(passed_over.at("tracks").empty());
    const json after = json::parse(lines(result.out).at(2));
    EXPECT_FALSE(after.at("obstacles").empty());
    EXPECT_TRUE(after.at("ego").at("is_known").get<bool>()) << "since the pair before";
  };
  records("left and right seem to be swapped");
  cv::imwrite((left / "1.png").string(), street_pair().left);
  cv::imwrite((right / "1.png").string(), unrelated_picture());
  records("not a pair with left/1.png");
}

TEST(TrackADrawnSequence, FollowsAndMeasuresIt) {
  const TestFolder folder;
  const Words small = {"--width_px",         "414", "--height_px", "125", "--focal_px", "240.5",
                       "--samples_per_side", "1",   "--people",    "2"};
  Words synth = {"synth", "drive", "--sequence", "--frames", "4", "--rate", "5"};
  synth.insert(synth.end(), small.begin(), small.end());
  ASSERT_EQ(run_flies(folder.path(), synth).status, 0);
  EXPECT_EQ(read_text(folder.path() / "drive" / "times.txt"), "0.000000\n0.200000\n0.400000\n0.600000\n");
  const RunResult tracks = run_flies(folder.path(), {"track", "drive", "--json", "-"});
  ASSERT_EQ(tracks.status, 0) << tracks.err;
  EXPECT_NEAR(json::parse(lines(tracks.out).at(3)).at("time_s").get<double>(), 0.6, 1e-9);
  const RunResult film = run_flies(folder.path(), {"track", "drive", "--video", "drive.mp4"});
  ASSERT_EQ(film.status, 0) << film.err;
  EXPECT_GT(fs::file_size(folder.path() / "drive.mp4"), 1000U);
  const RunResult wrong = run_flies(folder.path(), {"track", "drive", "--video", "drive.avi"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("drive.avi: has another ending, expected .mp4"));
  const RunResult measured = run_flies(folder.path(), {"evaluate", "drive", "--json", "-"});
  ASSERT_EQ(measured.status, 0) << measured.err;
  EXPECT_EQ(json::parse(measured.out).at("sequence").at("pairs"), 4);
}

TEST(TrackADrawnSequence, IsRefusedWhenItIsTooLong) {
  const TestFolder folder;
  const RunResult result = run_flies(folder.path(), {"synth", "drive", "--sequence", "--frames", "200"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--frames: 200 pairs at 10 Hz last 19.9 s, expected 9 s at most"));
  EXPECT_FALSE(fs::exists(folder.path() / "drive"));
}

TEST_F(TrackCommand, NamesWhatIsMissing) {
  EXPECT_THAT(run({"--rate", "10"}).err, HasSubstr("--calib"));
  write_text(folder.path() / "times.txt", "0\n1\n");
  const RunResult few = run({"--calib", "calib.txt", "--times", "times.txt"});
  EXPECT_EQ(few.status, 2);
  EXPECT_THAT(few.err, HasSubstr("holds 2 times, expected 3"));
  const RunResult no_drive = run_flies(folder.path(), {"track", "left"});
  EXPECT_EQ(no_drive.status, 2);
  EXPECT_THAT(no_drive.err, HasSubstr("neither a KITTI raw drive"));
}

TEST_F(TrackCommand, ChecksOutputsBeforeTheWork) {
  write_text(folder.path() / "drive.mcap", "a recording");
  const auto before = folder.listing();
  // The calibration, which is read after them, does not exist.
  const Words absent = {"--calib", "absent.txt", "--rate", "10"};
  const auto fault = [&](const Words& outputs) {
    Words words = absent;
    words.insert(words.end(), outputs.begin(), outputs.end());
    const RunResult result = run(words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
    EXPECT_EQ(folder.listing(), before) << "nothing may be left behind";
    return result.err;
  };
  EXPECT_THAT(fault({"--json", "no/t.jsonl"}), HasSubstr("no/t.jsonl: cannot be written"));
  EXPECT_THAT(fault({"--kitti", "no/t.txt"}), HasSubstr("no/t.txt: cannot be written"));
  EXPECT_THAT(fault({"--video", "no/t.mp4"}), HasSubstr("no/t.mp4: cannot be written"));
  EXPECT_THAT(fault({"--json", "t", "--kitti", "t"}),
              HasSubstr("t: --kitti: this file is already the output of --json"));
  EXPECT_THAT(fault({"--json", "-", "--kitti", "-"}), HasSubstr("standard output"));
  EXPECT_THAT(fault({"--json", "t.jsonl"}), HasSubstr("absent.txt"));
  EXPECT_THAT(run_flies(folder.path(), {"track", "drive.mcap", "--json", "./drive.mcap"}).err,
              HasSubstr("--json: this file is already an input"));
  EXPECT_EQ(read_text(folder.path() / "drive.mcap"), "a recording");
}

}  // namespace
}  // namespace flies::testing
