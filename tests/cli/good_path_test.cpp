#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "flies/classify/model_file.hpp"
#include "flies/classify/named_models.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

Words detect(const Words& more, const std::string& left = "left.png", const std::string& right = "right.png") {
  Words words = {
      "detect",         left,  right, "--calib", "calib.txt", "--camera-height", "1.65", "--camera-pitch", "0",
      "--evolve.flies", "2000"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// The JSON lines of a run that must succeed.
std::vector<json> found(const TestFolder& folder, const Words& command) {
  const RunResult result = run_flies(folder.path(), command);
  EXPECT_EQ(result.status, 0) << result.err;
  std::vector<json> records;
  for (const auto& line : lines(result.out)) records.push_back(json::parse(line));
  return records;
}

json without_times(json record) {
  record.erase("stage_ms");
  return record;
}

/// What was found, whatever the files are called.
json findings(const json& record) { return {record.at("obstacles"), record.at("pedestrians")}; }

Words split(const std::string& line, char separator) {
  Words fields;
  std::istringstream rest(line + separator);
  for (std::string field; std::getline(rest, field, separator);) fields.push_back(field);
  return fields;
}

struct Detect : ::testing::Test {
  Detect() { write_street(folder.path()); }
  TestFolder folder;
};

TEST_F(Detect, FindsTheBoxWhereItStands) {
  const auto records = found(folder, detect({"--json", "-"}));
  ASSERT_EQ(records.size(), 1u);
  constexpr double kRangeShare = 0.05;  // 0.7 px of disparity at 10 m with this short focal length
  constexpr double kLateral_m = 0.5;    // the face is 1.6 m wide; flies may hold to a part of it
  bool is_found = false;
  for (const auto& obstacle : records[0].at("obstacles"))
    is_found |= std::abs(obstacle.at("x_m").get<double>() - kBoxX_m) < kRangeShare * kBoxX_m &&
                std::abs(obstacle.at("y_m").get<double>() - kBoxY_m) < kLateral_m;
  EXPECT_TRUE(is_found) << records[0].dump();
}

TEST_F(Detect, WritesTheDocumentedJson) {
  const json record = found(folder, {"detect", "left.png", "right.png", "--calib", "calib.txt", "--json", "-", "--seed",
                                     "42", "--preset", "paper"})
                          .at(0);
  EXPECT_EQ(record.at("frame"), 0);
  EXPECT_EQ(record.at("left"), "left.png");
  EXPECT_EQ(record.at("right"), "right.png");
  EXPECT_EQ(record.at("seed"), 42);
  EXPECT_EQ(record.at("preset"), "paper");
  for (const char* stage : {"road", "evolve", "concentrate", "propose", "classify"})
    EXPECT_GE(record.at("stage_ms").at(stage).get<double>(), 0.0) << stage;
  ASSERT_FALSE(record.at("obstacles").empty());
  for (const auto& obstacle : record.at("obstacles")) {
    for (const char* key : {"x_m", "y_m", "range_m", "width_m", "height_m", "score"})
      EXPECT_TRUE(obstacle.at(key).is_number()) << key;
    for (const char* key : {"u_px", "v_px", "width_px", "height_px"})
      EXPECT_TRUE(obstacle.at("box").at(key).is_number()) << key;
  }
  EXPECT_TRUE(record.at("pedestrians").is_array());
}

TEST_F(Detect, NamesChangedOptionsCustom) {
  EXPECT_EQ(found(folder, detect({"--json", "-"})).at(0).at("preset"), "custom");
}

TEST_F(Detect, WritesEveryOutput) {
  const RunResult result = run_flies(
      folder.path(),
      detect({"--json", "a.jsonl", "--csv", "a.csv", "--scan", "s.csv", "--ply", "a.ply", "--overlay", "o.png",
              "--top-view", "t.png", "--flies", "f.png", "--histogram", "h.png", "--concentrating", "c.png"}));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "") << "the table is for runs without outputs";
  EXPECT_EQ(result.err, "");
  for (const char* name : {"o.png", "t.png", "f.png", "h.png", "c.png"})
    EXPECT_FALSE(cv::imread((folder.path() / name).string()).empty()) << name;
  EXPECT_EQ(read_text(folder.path() / "a.ply").rfind("ply\n", 0), 0u);
  const auto csv = lines(read_text(folder.path() / "a.csv"));
  ASSERT_GE(csv.size(), 2u);
  for (const char* column : {"frame", "kind", "x_m", "y_m", "range_m", "score"}) EXPECT_THAT(csv[0], HasSubstr(column));
  EXPECT_EQ(lines(read_text(folder.path() / "s.csv")).at(0),
            "frame,angle_rad,angle_deg,state,range_m,free_m,confidence,range_sd_m");
  EXPECT_EQ(folder.listing().size(), 3u + 9u) << "no temporary files may stay";
}

TEST_F(Detect, WritesTheSameScanAsJsonAndAsCsv) {
  const json record = found(folder, detect({"--json", "-", "--scan", "s.csv"})).at(0);
  const auto rows = lines(read_text(folder.path() / "s.csv"));
  if (!record.contains("scan")) {
    EXPECT_EQ(rows.size(), 1u);
    GTEST_SKIP() << "these options take no scan";
  }
  const json& scan = record.at("scan");
  const auto states = scan.at("states").get<std::string>();
  ASSERT_EQ(rows.size(), 1u + states.size());
  for (const char* key : {"ranges_m", "range_sd_m", "free_m", "confidence"})
    EXPECT_EQ(scan.at(key).size(), states.size()) << key;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto fields = split(rows[1 + i], ',');
    ASSERT_EQ(fields.size(), 8u) << rows[1 + i];
    EXPECT_EQ(fields[3].front(), states[i]);
    const json& range_m = scan.at("ranges_m")[i];
    EXPECT_EQ(fields[4].empty(), range_m.is_null());
    EXPECT_EQ(fields[7].empty(), range_m.is_null());
    EXPECT_EQ(scan.at("range_sd_m")[i].is_null(), range_m.is_null());
    if (!range_m.is_null()) {
      EXPECT_NEAR(std::stod(fields[4]), range_m.get<double>(), 1e-9);
    }
  }
}

TEST_F(Detect, PrintsATableWithoutOutputs) {
  const RunResult result = run_flies(folder.path(), detect({}));
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  for (const char* word : {"left.png", "range [m]", "obstacle", "evolve"}) EXPECT_THAT(result.out, HasSubstr(word));
}

TEST_F(Detect, SaysTheAssumedCameraHeightOnce) {
  const RunResult result = run_flies(folder.path(), {"detect", "left.png", "right.png", "--calib", "calib.txt",
                                                     "--json", "-", "--evolve.flies", "300"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
  EXPECT_THAT(result.err, HasSubstr("1.65 m and 0 degrees"));
}

TEST_F(Detect, RepeatsItselfForASeedWhateverTheThreads) {
  const json first = without_times(found(folder, detect({"--json", "-", "--seed", "3"})).at(0));
  EXPECT_EQ(without_times(found(folder, detect({"--json", "-", "--seed", "3"})).at(0)), first);
  EXPECT_EQ(without_times(found(folder, detect({"--json", "-", "--seed", "3", "--threads", "2"})).at(0)), first);
  EXPECT_NE(findings(found(folder, detect({"--json", "-", "--seed", "4"})).at(0)), findings(first));
}

TEST_F(Detect, ReadsTheSamePairFromEveryFormat) {
  const json expected = findings(found(folder, detect({"--json", "-"})).at(0));
  const auto agrees = [&](const std::string& extension, const auto& convert) {
    for (const auto& [name, image] :
         {std::pair("l" + extension, street_pair().left), std::pair("r" + extension, street_pair().right)})
      ASSERT_TRUE(cv::imwrite((folder.path() / name).string(), convert(image)));
    const auto records = found(folder, detect({"--json", "-"}, "l" + extension, "r" + extension));
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(findings(records[0]), expected) << extension;
  };
  const auto same = [](const cv::Mat& image) { return image; };
  agrees(".pgm", same);
  agrees(".tiff", same);
  agrees("_color.png", [](const cv::Mat& image) {
    cv::Mat color;
    cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
    return color;
  });
  agrees("_16bit.png", [](const cv::Mat& image) {
    cv::Mat deep;
    image.convertTo(deep, CV_16U, 256.0);
    return deep;
  });
}

TEST_F(Detect, PairsFoldersInNameOrderAndNamesTheFilesOfEachFrame) {
  fs::create_directory(folder.path() / "l");
  fs::create_directory(folder.path() / "r");
  for (const char* name : {"f9.png", "f10.png"}) {
    fs::copy_file(folder.path() / "left.png", folder.path() / "l" / name);
    fs::copy_file(folder.path() / "right.png", folder.path() / "r" / name);
  }
  const auto records = found(folder, detect({"--json", "-", "--overlay", "o.png", "--ply", "p.ply"}, "l", "r"));
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].at("left"), "l/f9.png");
  EXPECT_EQ(records[1].at("left"), "l/f10.png");
  EXPECT_EQ(records[1].at("frame"), 1);
  for (const char* name : {"o_f9.png", "o_f10.png", "p_f9.ply", "p_f10.ply"})
    EXPECT_TRUE(fs::exists(folder.path() / name)) << name;
}

TEST(Config, FeedsBackToItself) {
  const TestFolder folder;
  const RunResult first = run_flies(folder.path(), {"config", "--preset", "paper", "--evolve.flies", "1234",
                                                    "--fitness.noise_gray", "0.1", "--ego.corners", "123"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("flies: 1234"));
  EXPECT_THAT(first.out, HasSubstr("corners: 123"));
  write_text(folder.path() / "options.yaml", first.out);
  const RunResult second = run_flies(folder.path(), {"config", "--options", "options.yaml"});
  EXPECT_EQ(second.out, first.out);
}

TEST(Config, WritesTheNameOfAModelThatIsNotUtf8) {
  const TestFolder folder;
  write_people_model((folder.path() / "M\xFCller.json").string(), opencv_48x96());
  const RunResult result = run_flies(folder.path(), {"config", "--model", "M\xFCller.json"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("people_model: \"M\xEF\xBF\xBDller.json\""));
}

TEST(Config, RefusesAModelThatIsNotThere) {
  const TestFolder folder;
  write_text(folder.path() / "options.yaml", "people_model: hog\n");
  for (const Words& words : {Words{"config", "--model", "hog"}, Words{"config", "--options", "options.yaml"},
                             Words{"config", "--list", "--model", "hog"}}) {
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("hog"));
    EXPECT_EQ(lines(result.err).size(), 1U) << result.err;
  }
}

TEST(Config, PaperMeansTheSameWrittenAndRead) {
  const TestFolder folder;
  write_street(folder.path());
  write_text(folder.path() / "paper.yaml", run_flies(folder.path(), {"config", "--preset", "paper"}).out);
  auto by_name = found(folder, detect({"--json", "-", "--preset", "paper"})).at(0);
  auto by_file = found(folder, detect({"--json", "-", "--options", "paper.yaml"})).at(0);
  EXPECT_EQ(by_file.at("run").at("people_model"), "flies-48x96-linear");
  EXPECT_EQ(by_file.at("pedestrians"), by_name.at("pedestrians"));
  EXPECT_EQ(by_file.at("obstacles"), by_name.at("obstacles"));
  const auto overruled =
      found(folder, detect({"--json", "-", "--options", "paper.yaml", "--model", "flies-48x96"})).at(0);
  EXPECT_EQ(overruled.at("run").at("people_model"), "flies-48x96");
}

TEST(Config, CommandLineOverrulesFileOverrulesPreset) {
  const TestFolder folder;
  write_text(folder.path() / "options.yaml", "evolve: {flies: 111, generations: 7}\n");
  const RunResult result =
      run_flies(folder.path(), {"config", "--evolve.flies", "222", "--options", "options.yaml", "--preset", "paper"});
  EXPECT_THAT(result.out, HasSubstr("flies: 222"));
  EXPECT_THAT(result.out, HasSubstr("generations: 7"));
  EXPECT_THAT(result.out, HasSubstr("function: covariance"));
}

TEST(Config, OptionsOfFollowingAreForWhoFollows) {
  const TestFolder folder;
  write_street(folder.path());
  write_text(folder.path() / "options.yaml", "ego: {corners: 123}\ntrack.min_probability: 0.7\n");
  for (const char* side : {"left", "right"}) {
    fs::create_directory(folder.path() / side);
    fs::copy_file(folder.path() / (std::string(side) + ".png"), folder.path() / side / "0.png");
  }
  const auto of_track = [&](const Words& more) {
    Words words = {"track", "left", "right", "--calib", "calib.txt", "--options", "options.yaml", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    return found(folder, words).at(0).at("run").at("options");
  };
  EXPECT_EQ(of_track({}).at("ego.corners"), 123);
  EXPECT_EQ(of_track({"--ego.corners", "150"}).at("ego.corners"), 150);
  EXPECT_EQ(of_track({}).at("track.min_probability"), 0.7);
  EXPECT_FALSE(found(folder, detect({"--json", "-", "--options", "options.yaml"})).at(0).at("obstacles").empty());
  write_text(folder.path() / "options.yaml", "ego: {corner: 123}\n");
  const RunResult wrong = run_flies(folder.path(), detect({"--options", "options.yaml"}));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("ego.corner: unknown option; the nearest known one is 'ego.corners'"));
}

TEST(Config, ListsEveryOptionOnALine) {
  const TestFolder folder;
  const RunResult result = run_flies(folder.path(), {"config", "--list"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("evolve.flies "));
  EXPECT_THAT(result.out, HasSubstr("track.min_probability "));
  EXPECT_THAT(result.out, HasSubstr("louchet|covariance|correlation"));
  for (const auto& line : lines(result.out)) EXPECT_THAT(line, ::testing::ContainsRegex("^[a-z][a-z_0-9.]*  "));
}

TEST(Flies, HelpsWithStatus0) {
  const TestFolder folder;
  const RunResult bare = run_flies(folder.path(), {});
  EXPECT_EQ(bare.status, 0);
  EXPECT_EQ(run_flies(folder.path(), {"--help"}).out, bare.out);
  for (const char* command : {"detect", "calib", "synth", "config", "info"}) {
    EXPECT_THAT(bare.out, HasSubstr(command));
    const RunResult help = run_flies(folder.path(), {command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr("flies " + std::string(command))) << "an example teaches more than a list";
    EXPECT_THAT(help.out, HasSubstr("xit status"));
  }
}

TEST(Flies, NamesItsVersionAndLibraries) {
  const TestFolder folder;
  EXPECT_THAT(run_flies(folder.path(), {"--version"}).out, ::testing::MatchesRegex("flies [0-9.]+\n"));
  EXPECT_EQ(run_flies(folder.path(), {"-V"}).out, run_flies(folder.path(), {"--version"}).out);
  const RunResult misspelt = run_flies(folder.path(), {"detct", "a", "b"});
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_THAT(misspelt.err, ::testing::HasSubstr("unknown command 'detct'; did you mean detect?"));
  const RunResult info = run_flies(folder.path(), {"info"});
  EXPECT_EQ(info.status, 0);
  for (const char* word : {"opencv", "tbb", "compiler", "default paper", "opencv-48x96"})
    EXPECT_THAT(info.out, HasSubstr(word));
}

}  // namespace
}  // namespace flies::testing
