#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "flies/io/calibration.hpp"
#include "run_flies.hpp"
#include "street_pair.hpp"

namespace fs = std::filesystem;

namespace flies::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// The street twice as a folder of scenes, with its box as the only object.
void write_scenes(const fs::path& folder) {
  for (const char* name : {"left", "right", "truth"}) fs::create_directories(folder / "scenes" / name);
  for (const std::string name : {"a", "b"}) {
    cv::imwrite((folder / "scenes/left" / (name + ".png")).string(), street_pair().left);
    cv::imwrite((folder / "scenes/right" / (name + ".png")).string(), street_pair().right);
    write_text(folder / "scenes/truth" / (name + ".json"),
               R"({"objects": [{"class": "box", "x_m": 10.4, "y_m": 1, "length_m": 0.8, "width_m": 1.6,
                                "height_m": 1.8}]})");
  }
  write_text(folder / "scenes/calib.yaml", calibration_yaml(street_camera()));
}

/// `flies evaluate` on these scenes, quick.
Words evaluate(const Words& more = {}) {
  Words words = {"evaluate", "scenes", "--evolve.flies", "1000", "--seeds", "2", "--estimate.resamples", "20"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

struct Evaluate : ::testing::Test {
  Evaluate() { write_scenes(folder.path()); }
  TestFolder folder;
};

const json& method(const json& evaluation, std::size_t index) { return evaluation.at("methods").at(index); }

TEST_F(Evaluate, WritesTheDocumentedJson) {
  const RunResult result = run_flies(folder.path(), evaluate({"--json", "-", "--yardstick", "sgbm,sgbm-3way,paper"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json evaluation = json::parse(result.out);
  EXPECT_EQ(evaluation.at("pairs"), 2);
  EXPECT_EQ(evaluation.at("pairs_with_lidar"), 0);
  EXPECT_EQ(evaluation.at("objects"), 2);
  EXPECT_EQ(evaluation.at("seed"), 1);
  EXPECT_EQ(evaluation.at("preset"), "default");
  EXPECT_EQ(evaluation.at("options").at("evolve.flies"), 1000);
  EXPECT_EQ(evaluation.at("options").at("road.estimate"), true);
  EXPECT_EQ(evaluation.at("options").at("fitness.sampling"), "subpixel");
  EXPECT_TRUE(evaluation.at("match").contains("radius_m"));
  ASSERT_EQ(evaluation.at("methods").size(), 4u);
  const char* const names[] = {"default", "sgbm", "sgbm-3way", "paper"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(method(evaluation, i).at("name"), names[i]);
    EXPECT_GT(method(evaluation, i).at("time_ms").get<double>(), 0.0);
  }
  for (const std::size_t found : {0U, 1U, 2U}) {
    const json& recall = method(evaluation, found).at("all").at("recall");
    EXPECT_EQ(recall.at("median"), 1.0) << names[found];
    for (const char* key : {"spread", "low", "high"}) EXPECT_TRUE(recall.at(key).is_number()) << key;
  }
  EXPECT_EQ(method(evaluation, 0).at("runs"), 2);
  EXPECT_EQ(method(evaluation, 1).at("runs"), 1);
  EXPECT_GE(method(evaluation, 0).at("evaluations").get<double>(), 1000.0);
  EXPECT_TRUE(method(evaluation, 1).at("evaluations").is_null());
  EXPECT_EQ(method(evaluation, 0).at("by_class").at("Box").at("objects"), 2);
  EXPECT_EQ(method(evaluation, 0).at("by_range").at("5-10 m").at("objects"), 0);
  EXPECT_EQ(method(evaluation, 0).at("by_range").at("10-20 m").at("objects"), 2);
}

TEST_F(Evaluate, MakesUpForRowsThatLieApartAndTells) {
  for (const char* name : {"a", "b"}) {
    const cv::Mat right = street_pair().right;
    cv::Mat lower = right.clone();
    constexpr int kRows_px = 3;
    right.rowRange(0, right.rows - kRows_px).copyTo(lower.rowRange(kRows_px, right.rows));
    cv::imwrite((folder.path() / "scenes/right" / (std::string(name) + ".png")).string(), lower);
  }
  const RunResult result = run_flies(folder.path(), evaluate({"--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("this is corrected"));
  EXPECT_THAT(json::parse(result.out).at("notes").dump(), HasSubstr("this is corrected"));
  const RunResult as_it_is = run_flies(folder.path(), evaluate({"--json", "-", "--self-rectify", "off"}));
  EXPECT_THAT(as_it_is.err, HasSubstr("not quite rectified"));
}

TEST_F(Evaluate, RefusesAnyPairThatIsNone) {
  cv::Mat noise(street_pair().right.size(), street_pair().right.type());
  cv::randu(noise, 0, 255);
  cv::imwrite((folder.path() / "scenes/right/b.png").string(), noise);
  const RunResult result = run_flies(folder.path(), evaluate());
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("scenes/right/b.png: not a pair with scenes/left/b.png"));
}

TEST_F(Evaluate, FollowsOnlyWhatIsASequence) {
  const RunResult result = run_flies(folder.path(), evaluate({"--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(json::parse(result.out).at("sequence").is_null());
  const RunResult asked = run_flies(folder.path(), evaluate({"--sequence"}));
  EXPECT_EQ(asked.status, 2);
  EXPECT_EQ(asked.out, "");
  EXPECT_THAT(asked.err,
              ::testing::AllOf(HasSubstr("times and motion of the pairs are not known"), HasSubstr("flies synth")));
}

TEST_F(Evaluate, PrintsATableAndTheMissedObjects) {
  write_text(folder.path() / "d.jsonl", "{\"obstacles\": [{\"x_m\": 10, \"y_m\": 1}]}\n{\"obstacles\": []}\n");
  const RunResult result = run_flies(folder.path(), evaluate({"--detections", "d.jsonl", "--missed"}));
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* word : {"folder of scenes, 2 pairs", "reported, 1 run", "recall, labelled objects", "0.500",
                           "Box, 2", "10-20 m", "missed by reported:", "b ", "in 1 of 1 runs"})
    EXPECT_THAT(result.out, HasSubstr(word));
}

TEST_F(Evaluate, MeasuresReportedPeopleBesideASearchOfTheWholeImage) {
  write_text(folder.path() / "scenes/truth/a.json",
             R"({"objects": [{"class": "pedestrian", "x_m": 10, "y_m": 0, "length_m": 0.5, "width_m": 0.5,
                              "height_m": 1.8}]})");
  const auto camera = street_camera();
  // Head to feet of the labelled person, and a false alarm elsewhere.
  const double height_px = camera.fy_px * 1.8 / 10.0,
               foot_v_px = camera.cy_px + camera.fy_px * camera.mount.height_m / 10.0;
  const std::string box =
      fmt::format(R"({{"u_px": {}, "v_px": {}, "width_px": {}, "height_px": {}}})", camera.cx_px - 0.2 * height_px,
                  foot_v_px - height_px, 0.4 * height_px, height_px);
  write_text(folder.path() / "d.jsonl",
             fmt::format("{{\"obstacles\": [], \"pedestrians\": [{{\"x_m\": 10.1, \"y_m\": 0, \"probability\": 0.9, "
                         "\"box\": {0}}}]}}\n{{\"obstacles\": [], \"pedestrians\": [{{\"x_m\": 7, \"y_m\": 0, "
                         "\"probability\": 0.4, \"box\": {0}}}]}}\n",
                         box));
  const Words words = evaluate({"--detections", "d.jsonl", "--yardstick", "hog-48x96,hog-64x128,sgbm"});
  const auto with = [&](const Words& more) {
    Words all = words;
    all.insert(all.end(), more.begin(), more.end());
    return run_flies(folder.path(), all);
  };
  const RunResult as_json = with({"--json", "-"});
  ASSERT_EQ(as_json.status, 0) << as_json.err;
  const json evaluation = json::parse(as_json.out);
  EXPECT_EQ(evaluation.at("people"), 1);
  const json& people = method(evaluation, 0).at("people");
  EXPECT_EQ(people.at("all").at("miss_rate").at("median"), 0.0);
  EXPECT_EQ(people.at("all").at("false_alarms_per_frame").at("median"), 0.5);
  EXPECT_EQ(people.at("by_range").at("0-10 m").at("people"), 1);
  EXPECT_EQ(people.at("operating_point").at("miss_rate"), 0.0);
  ASSERT_EQ(people.at("curve").size(), 1u);
  EXPECT_EQ(people.at("curve").at(0).at("false_alarms_per_frame"), 0.0);
  ASSERT_EQ(people.at("false_alarms").size(), 1u);
  EXPECT_EQ(people.at("false_alarms").at(0).at("name"), "b");
  for (const std::size_t search : {1U, 2U}) {
    EXPECT_GT(method(evaluation, search).at("people").at("time_ms").get<double>(), 0.0);
    EXPECT_TRUE(method(evaluation, search).at("all").empty()) << "it finds no obstacles";
  }
  EXPECT_TRUE(method(evaluation, 3).at("people").is_null()) << "dense matching does not look for people";

  const RunResult as_table = with({"--missed", "--plot", "people.png"});
  for (const char* word :
       {"people: 1 to be found", "log-average miss rate", "false alarms a pair", "people missed by reported: nothing",
        "false alarms on people of reported:", "probability 0.4000"})
    EXPECT_THAT(as_table.out, HasSubstr(word));
  EXPECT_FALSE(cv::imread((folder.path() / "people.png").string()).empty());
}

TEST_F(Evaluate, TakesSeveralFilesAsRunsAndTheFolderLast) {
  write_text(folder.path() / "1.jsonl", "{\"obstacles\": [{\"x_m\": 10, \"y_m\": 1}]}\n{\"obstacles\": []}\n");
  write_text(folder.path() / "2.jsonl", "{\"obstacles\": []}\n{\"obstacles\": []}\n");
  const RunResult result =
      run_flies(folder.path(), {"evaluate", "--detections", "1.jsonl", "--json", "-", "--yardstick", "sgbm",
                                "--detections", "2.jsonl", "--yardstick", "sgbm-3way", "scenes"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json evaluation = json::parse(result.out);
  EXPECT_EQ(evaluation.at("methods").size(), 3u);
  EXPECT_EQ(method(evaluation, 0).at("runs"), 2);
  EXPECT_EQ(method(evaluation, 0).at("all").at("recall").at("median"), 0.25);
  EXPECT_EQ(method(evaluation, 0).at("all").at("recall").at("spread"), 0.5);
}

TEST_F(Evaluate, MeasuresScansOfASyntheticStreet) {
  ASSERT_EQ(run_flies(folder.path(), {"synth", "street", "--frames", "2", "--seed", "5"}).status, 0);
  // Says that something stands 12 m away in every direction.
  std::string states(400, 'o'), ranges = "12";
  for (int i = 1; i < 400; ++i) ranges += ", 12";
  const std::string line = fmt::format(
      R"({{"obstacles": [], "scan": {{"angle_min_rad": -1.74, "angle_increment_rad": 0.00873, "states": "{}", )"
      R"("ranges_m": [{}]}}}})",
      states, ranges);
  write_text(folder.path() / "d.jsonl", line + "\n" + line + "\n");
  const Words words = {"evaluate", "street", "--detections", "d.jsonl", "--yardstick", "sgbm-3way"};
  const auto with = [&](const Words& more) {
    Words all = words;
    all.insert(all.end(), more.begin(), more.end());
    return run_flies(folder.path(), all);
  };
  const RunResult as_json = with({"--json", "-"});
  ASSERT_EQ(as_json.status, 0) << as_json.err;
  const json evaluation = json::parse(as_json.out);
  EXPECT_GT(evaluation.at("sectors").get<int>(), 50);
  EXPECT_EQ(evaluation.at("sector_options").at("increment_deg"), 0.5);
  const auto share = [&](std::size_t m, const char* name) {
    return method(evaluation, m).at("scan").at("all").at(name).at("median").get<double>();
  };
  for (const std::size_t m : {0U, 1U})
    EXPECT_NEAR(share(m, "right") + share(m, "blind") + share(m, "ghost") + share(m, "unknown"), 1.0, 1e-3);
  EXPECT_EQ(share(0, "unknown"), 0.0);
  EXPECT_LT(share(0, "right"), 0.5);
  EXPECT_GT(share(1, "right"), 0.6) << "dense matching sees most of a textured street";
  const json& curve = method(evaluation, 1).at("scan").at("curve");
  ASSERT_EQ(curve.size(), 5u);
  EXPECT_EQ(curve.at(0).at("scan_points"), 5);
  EXPECT_LE(curve.at(0).at("blind").get<double>(), curve.at(4).at("blind").get<double>());
  EXPECT_EQ(method(evaluation, 0).at("scan").at("curve").at(0).at("min_confidence"), 0);

  const RunResult as_table = with({"--end", "1"});
  for (const char* word :
       {"street: folder of scenes, 1 pairs", "scan: ", "right", "blind, nearer than 15 m", "ghosts in open sectors"})
    EXPECT_THAT(as_table.out, HasSubstr(word));
}

TEST_F(Evaluate, MeasuresARoomAsItsOwnCameraSeesIt) {
  const auto calibration = [&](const Words& more) {
    Words words = {"synth", "room", "--force", "--width_px", "320", "--height_px", "240", "--focal_px", "225"};
    words.insert(words.end(), more.begin(), more.end());
    const RunResult result = run_flies(folder.path(), words);
    EXPECT_EQ(result.status, 0) << result.err;
    return read_text(folder.path() / "room/calib.yaml");
  };
  EXPECT_THAT(calibration({"--camera_height_m", "1.3", "--scene", "room"}), HasSubstr("height_m: 1.3"))
      << "what is given counts, before or after the place";
  EXPECT_THAT(calibration({"--scene", "pavement"}), HasSubstr("height_m: 0.3"));
  EXPECT_THAT(calibration({"--scene", "room"}), HasSubstr("baseline_m: 0.12"));
  const std::string left = read_text(folder.path() / "room/left/000000.png");
  calibration({"--options", "room/scene.yaml"});
  EXPECT_EQ(read_text(folder.path() / "room/left/000000.png"), left) << "scene.yaml repeats it";

  const RunResult result =
      run_flies(folder.path(), {"evaluate", "room", "--preset", "robot", "--match.min_range_m", "1",
                                "--match.max_range_m", "8", "--sectors.min_range_m", "1", "--json", "-"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json evaluation = json::parse(result.out);
  EXPECT_GE(evaluation.at("objects").get<int>(), 3);
  EXPECT_GT(evaluation.at("sectors").get<int>(), 20);
  EXPECT_GT(method(evaluation, 0).at("all").at("recall").at("median").get<double>(), 0.3);
}

TEST_F(Evaluate, ReadsWhatDetectWrote) {
  ASSERT_EQ(run_flies(folder.path(), {"detect", "scenes/left", "scenes/right", "--calib", "scenes/calib.yaml", "--json",
                                      "d.jsonl", "--evolve.flies", "1000"})
                .status,
            0);
  const RunResult result = run_flies(folder.path(), evaluate({"--detections", "d.jsonl", "--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(method(json::parse(result.out), 0).at("all").at("recall").at("median"), 1.0);
}

TEST_F(Evaluate, SaysThatLinesWithAnErrorCountAsNothingFound) {
  write_text(folder.path() / "d.jsonl",
             "{\"obstacles\": [{\"x_m\": 10.4, \"y_m\": 1}]}\n{\"obstacles\": [], \"error\": \"b.png: is empty\"}\n");
  const RunResult result = run_flies(folder.path(), evaluate({"--detections", "d.jsonl", "--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string note = "d.jsonl: 1 of 2 lines says that the pair could not be used; it counts as nothing found";
  EXPECT_THAT(result.err, HasSubstr(note));
  EXPECT_THAT(json::parse(result.out).at("notes").dump(), HasSubstr(note));
}

TEST_F(Evaluate, RepeatsItselfButForTheTimes) {
  const auto measures = [&] {
    json evaluation = json::parse(run_flies(folder.path(), evaluate({"--json", "-"})).out);
    evaluation.at("methods").at(0).erase("time_ms");
    evaluation.at("methods").at(0).at("people").erase("time_ms");
    return evaluation;
  };
  EXPECT_EQ(measures(), measures());
}

TEST_F(Evaluate, TakesEverySoManyPairs) {
  const RunResult result = run_flies(folder.path(), evaluate({"--start", "1", "--step", "2", "--json", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(json::parse(result.out).at("pairs"), 1);
}

/// Spoils the folder of scenes and gives the command that meets the fault.
struct BadTruth {
  const char* name;
  std::function<Words(const fs::path&)> prepare;
  Words named;  ///< what the message must name
};

std::ostream& operator<<(std::ostream& stream, const BadTruth& input) { return stream << input.name; }

std::vector<BadTruth> bad_truths() {
  const auto with_words = [](const Words& more) { return [more](const fs::path&) { return evaluate(more); }; };
  const auto with_detections = [](const std::string& text) {
    return [text](const fs::path& f) {
      write_text(f / "d.jsonl", text);
      return evaluate({"--detections", "d.jsonl"});
    };
  };
  return {
      {"FolderWithoutTruth",
       [](const fs::path&) {
         return Words{"evaluate", "."};
       },
       {".: holds no truth"}},
      {"MissingFolder",
       [](const fs::path&) {
         return Words{"evaluate", "gone"};
       },
       {"gone: is not a folder"}},
      {"TruthMissingForAPair",
       [](const fs::path& f) {
         fs::remove(f / "scenes/truth/b.json");
         return evaluate();
       },
       {"scenes/truth", "found 1", "expected 2"}},
      {"MalformedTruth",
       [](const fs::path& f) {
         write_text(f / "scenes/truth/b.json", "{\"objects\": [{\"class\": \"car\", \"x_m\": 4}]}");
         return evaluate();
       },
       {"b.json", "objects[0].y_m"}},
      {"MissingCalibration",
       [](const fs::path& f) {
         fs::remove(f / "scenes/calib.yaml");
         return evaluate();
       },
       {"scenes: calib.yaml"}},
      {"MalformedDetections",
       with_detections("{\"obstacles\": []}\n{\"obstacles\": [\n"),
       {"d.jsonl: line 2: not JSON"}},
      {"DetectionWithoutPosition",
       with_detections("{\"obstacles\": [{\"x_m\": 3}]}\n{\"obstacles\": []}\n"),
       {"d.jsonl: line 1: obstacles[0].y_m"}},
      {"FewerDetectionsThanPairs", with_detections("{\"obstacles\": []}\n"), {"d.jsonl: found 1", "expected 2"}},
      {"DetectionsOfOtherPairs",
       with_detections("{\"left\": \"a.png\", \"obstacles\": []}\n{\"left\": \"z.png\", \"obstacles\": []}\n"),
       {"d.jsonl: left", "pair b"}},
      {"PedestrianWithoutBox",
       with_detections(
           "{\"obstacles\": [], \"pedestrians\": [{\"x_m\": 3, \"y_m\": 0, \"score\": 1}]}\n{\"obstacles\": []}\n"),
       {"d.jsonl: line 1: pedestrians[0].box"}},
      {"StrideThatDoesNotFit", with_words({"--yardstick", "hog-48x96", "--hog.stride_px", "12"}), {"stride_px", "12"}},
      {"MissingDetections", with_words({"--detections", "gone.jsonl"}), {"gone.jsonl"}},
      {"UnknownYardstick", with_words({"--yardstick", "sgbm,lidar"}), {"--yardstick", "lidar", "sgbm-3way"}},
      {"StartBehindTheEnd", with_words({"--start", "2"}), {"--start", "2"}},
      {"EndBeforeTheStart", with_words({"--start", "1", "--end", "1"}), {"--end", "found 1"}},
      {"SectorOptionOutOfRange", with_words({"--sectors.increment_deg", "0"}), {"increment_deg", "0"}},
      {"MalformedScan",
       with_detections("{\"obstacles\": [], \"scan\": {}}\n{\"obstacles\": []}\n"),
       {"d.jsonl: line 1: scan.angle_min_rad"}},
      {"DamagedDisparities",
       [](const fs::path& f) {
         fs::create_directories(f / "scenes/disparity");
         write_text(f / "scenes/disparity/a.png", "no picture");
         return evaluate();
       },
       {"scenes/disparity/a.png"}},
      {"NegativeStep", with_words({"--step", "-1"}), {"--step: found -1, expected a whole number in 1..1000000000;"}},
      {"NegativeStart",
       with_words({"--start", "-1"}),
       {"--start: found -1, expected a whole number in 0..1000000000;"}},
      {"NoEnd", with_words({"--end", "0"}), {"--end: found 0, expected a whole number in 1..1000000000;"}},
      {"NoBaseline", with_words({"--baseline", "0"}), {"--baseline: found 0, expected a number in 0.0001..10000;"}},
      {"NoSeeds", with_words({"--seeds", "0"}), {"--seeds"}},
      {"MatchOptionOutOfRange", with_words({"--match.radius_m", "-1"}), {"radius_m", "-1"}},
      {"MethodOptionOutOfRange", with_words({"--evolve.generations", "-1"}), {"evolve.generations", "-1"}},
      {"OneCamera", with_words({"--cameras", "1"}), {"--cameras"}},
      {"CamerasOfScenes", with_words({"--cameras", "0,1"}), {"scenes", "cameras"}},
      {"PlotFolderMissing", with_words({"--plot", "gone/e.png"}), {"gone/e.png"}},
      {"ScanPlotFolderMissing", with_words({"--scan-plot", "gone/e.png"}), {"gone/e.png"}},
      {"OneFileForTwo", with_words({"--plot", "e.png", "--json", "e.png"}), {"e.png: --plot: this file is already"}},
      {"OutputFolderMissing", with_words({"--json", "gone/e.json"}), {"gone/e.json"}},
  };
}

class BadTruths : public ::testing::TestWithParam<BadTruth> {};

TEST_P(BadTruths, EndWithOneLineAndStatus2) {
  const TestFolder folder;
  write_scenes(folder.path());
  const Words command = GetParam().prepare(folder.path());
  const auto before = folder.listing();

  const RunResult result = run_flies(folder.path(), command);

  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(lines(result.err).size(), 1u) << result.err;
  EXPECT_THAT(result.err, ::testing::StartsWith("flies: "));
  for (const auto& word : GetParam().named) EXPECT_THAT(result.err, HasSubstr(word));
  EXPECT_EQ(folder.listing(), before) << "nothing may be left behind";
}

INSTANTIATE_TEST_SUITE_P(Table, BadTruths, ::testing::ValuesIn(bad_truths()),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace flies::testing
