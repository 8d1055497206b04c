#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "flies/io/temporary_folder.hpp"
#include "run_flies.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

/// A folder with two small drawn streets, and a crop of a striped figure with its mask.
struct Paste : ::testing::Test {
  Paste() {
    const RunResult drawn =
        run("synth streets --frames 2 --seed 3 --people 0 --width_px 620 --height_px 188 "
            "--focal_px 360 --samples_per_side 1");
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    fs::create_directory(folder.path() / "people");
    cv::Mat crop(128, 64, CV_8UC1, cv::Scalar(120)), mask(128, 64, CV_8UC1, cv::Scalar(0));
    for (int v = 16; v < 112; ++v) crop.row(v).colRange(20, 44).setTo(v / 6 % 2 == 0 ? 40 : 200);
    mask(cv::Rect(20, 16, 24, 96)).setTo(255);
    cv::imwrite((folder.path() / "people/a.png").string(), crop);
    cv::imwrite((folder.path() / "people/a_mask.png").string(), mask);
  }

  RunResult run(const std::string& line) const {
    std::istringstream stream(line);
    return run_flies(folder.path(), {std::istream_iterator<std::string>(stream), {}});
  }

  TestFolder folder;
};

TEST_F(Paste, WritesPairsThatEvaluateMeasures) {
  const RunResult result = run("synth out --paste people --onto streets --frames 3 --people 2 --seed 5");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("people pasted, of 1 who could be cut out of 1 pictures"));
  EXPECT_THAT(folder.listing(),
              IsSupersetOf({"out/left/000002.png", "out/right/000002.png", "out/truth/000002.json",
                            "out/label_2/000002.txt", "out/disparity/000002.png", "out/calib.yaml", "out/scene.yaml"}));
  const json truth = json::parse(read_text(folder.path() / "out/truth/000000.json"));
  const auto is_person = [](const json& object) { return object.at("class") == "pedestrian"; };
  const json& objects = truth.at("objects");
  EXPECT_EQ(std::count_if(objects.begin(), objects.end(), is_person), 2);
  EXPECT_GT(objects.size(), 2U) << "the street's own things are still there";
  const RunResult measured = run("evaluate out --seeds 1 --json -");
  ASSERT_EQ(measured.status, 0) << measured.err;
  const json evaluation = json::parse(measured.out);
  EXPECT_EQ(evaluation.at("pairs"), 3);
  EXPECT_GT(evaluation.at("sectors").get<int>(), 50) << "the disparity maps are read";
}

TEST_F(Paste, RefusesOptionsOfDrawnScenes) {
  for (const std::string option : {"--scene", "--cars"}) {
    const RunResult result =
        run("synth out --paste people --onto streets " + option + (option == "--cars" ? " 3" : " room"));
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr("command line: " + option + ": is for scenes that are drawn"));
  }
}

TEST_F(Paste, DrawnScenesAreNamedAsTheHelpNamesThem) {
  const auto fault = [&](const std::string& line) {
    const RunResult result = run(line);
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_THAT(fault("synth out --scene streeet"), HasSubstr("command line: --scene: found 'streeet'"));
  EXPECT_THAT(fault("synth out --scene room --sequence"),
              HasSubstr("command line: --sequence: takes place in a street, found --scene room"));
  EXPECT_THAT(fault("synth out --paste people --onto streets --step 0"),
              HasSubstr("--step: found 0, expected a whole number in 1..1000000000;"));
  EXPECT_THAT(fault("synth out --paste people --onto streets --start -1"),
              HasSubstr("--start: found -1, expected a whole number in 0..1000000000;"));
}

TEST_F(Paste, RepeatsItselfFromItsSceneFile) {
  ASSERT_EQ(run("synth one --paste people --onto streets --seed 7 --people 2 --noise_gray 3").status, 0);
  ASSERT_EQ(run("synth two --paste people --onto streets --options one/scene.yaml").status, 0);
  ASSERT_EQ(run("synth other --paste people --onto streets --people 2 --noise_gray 3").status, 0);
  const auto right = [&](const std::string& name) { return read_text(folder.path() / name / "right/000001.png"); };
  EXPECT_EQ(right("one"), right("two"));
  EXPECT_NE(right("one"), right("other"));
}

TEST_F(Paste, LeavesNothingOfAnotherKindOfScene) {
  ASSERT_EQ(run("synth out --sequence --frames 2 --people 0 --width_px 320 --height_px 96 --focal_px 180 "
                "--samples_per_side 1")
                .status,
            0);
  ASSERT_TRUE(fs::exists(folder.path() / "out/times.txt"));
  ASSERT_EQ(run("synth out --paste people --onto streets --force").status, 0);
  EXPECT_FALSE(fs::exists(folder.path() / "out/times.txt"));
  fs::create_directory(folder.path() / "out/calib");
  ASSERT_EQ(
      run("synth out --force --people 0 --width_px 320 --height_px 96 --focal_px 180 --samples_per_side 1").status, 0);
  EXPECT_FALSE(fs::exists(folder.path() / "out/calib"));
}

TEST_F(Paste, RefusesWhatItCannotDoInOneLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--paste people", "--onto"},
      {"--onto streets", "--paste"},
      {"--paste none --onto streets", "none"},
      {"--paste people --onto none", "none"},
      {"--paste people --onto people", "holds no truth"},
      {"--paste streets/truth --onto streets", "nobody could be cut out of 0 pictures"},
      {"--paste people --onto streets --sequence", "--sequence"},
      {"--paste people --onto streets --cars 3", "cars"},
      {"--paste people --onto streets --start 2", "found 2, but there are 2 pairs"},
      {"--paste people --onto streets --people_max_range_m 5", "people_max_range_m"},
  };
  for (const auto& [words, named] : cases) {
    const RunResult result = run("synth out " + words);
    EXPECT_EQ(result.status, 2) << words;
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
    EXPECT_THAT(result.err, HasSubstr(named)) << words;
    EXPECT_FALSE(fs::exists(folder.path() / "out")) << words;
  }
}

/// Draws a small scene into the folder `out`.
RunResult synth_out(const TestFolder& folder, const std::string& more = "", const std::string& prefix = "") {
  std::istringstream line("synth out --people 0 --width_px 320 --height_px 96 --focal_px 180 --samples_per_side 1 " +
                          more);
  return run_flies(folder.path(), {std::istream_iterator<std::string>(line), {}}, prefix);
}

TEST(SynthFolder, MayBeALinkToAnotherDisk) {
  const TestFolder folder;
  std::string disk = "/dev/shm/flies-synth-XXXXXX";
  if (::mkdtemp(disk.data()) == nullptr) GTEST_SKIP() << "this system has no /dev/shm";
  fs::create_directory_symlink(disk, folder.path() / "out");
  EXPECT_EQ(synth_out(folder, "--seed 1").status, 0);
  const std::string image = disk + "/left/000000.png", first = read_text(image);
  const RunResult again = synth_out(folder, "--seed 2 --force");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(read_text(image), first);
  for (const fs::path& parent : {folder.path(), fs::path(disk)})
    for (const auto& entry : fs::directory_iterator(parent))
      EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr(".part-")));
  fs::remove_all(disk);
  EXPECT_THAT(synth_out(folder).err, HasSubstr("out: found a link to nothing"));
}

TEST(SynthFolder, IsAsItWasWhereItCannotBeReplaced) {
  const OrdinaryUser user;
  const TestFolder folder;
  fs::create_directories(folder.path() / "out/left");
  write_text(folder.path() / "out/left/old.png", "old");
  fs::create_directory(folder.path() / "out/right");
  fs::permissions(folder.path() / "out/right", fs::perms::owner_read | fs::perms::owner_exec);  // it cannot be moved
  const bool is_root = ::getuid() == 0;
  const RunResult result = synth_out(folder, "--force", is_root ? "setpriv --reuid=65534 --clear-groups" : "");
  constexpr int kNotStarted = 126;
  if (result.status >= kNotStarted) GTEST_SKIP() << "the command lies where only the super-user may look";
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("out: cannot replace its content"));
  EXPECT_THAT(folder.listing(), ElementsAre("out", "out/left", "out/left/old.png", "out/right"));
}

TEST(SynthFolder, HasNothingOfARunThatWasKilled) {
  const TestFolder folder;
  const pid_t killed = ::fork();
  if (killed == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(killed, nullptr, 0), killed);
  fs::create_directories(folder.path() / "out" / (".flies.part-" + std::to_string(killed)) / "left");
  const RunResult result = synth_out(folder);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(folder.listing(), Not(Contains(HasSubstr(".part-"))));
}

}  // namespace
}  // namespace flies::testing
