#include "flies/eval/detections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/io/temporary_folder.hpp"
#include "flies/io/writers.hpp"

namespace flies {
namespace {

using ::testing::HasSubstr;

std::string complaint(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

std::string parse_complaint(const std::string& text) {
  return complaint([&] { parse_detections(text, "d.jsonl"); });
}

const std::vector<PairPaths> kTwoPairs = {{"l/a.png", "r/a.png"}, {"l/b.png", "r/b.png"}};

std::string match_complaint(const std::string& text) {
  return complaint([&] { match_detections(parse_detections(text, "d.jsonl"), kTwoPairs, "d.jsonl"); });
}

TEST(ParseDetections, RefusesLinesThatAreNoResultOfAPair) {
  const std::string line = "{\"obstacles\": []}\n" + std::string((16U << 20) + 1, '[') + "\n";
  EXPECT_EQ(parse_complaint(line), "d.jsonl: line 2: has more than 16 MB, expected the result of one pair");
}

/// A line with one person.
std::string person_line(const std::string& probability, const std::string& width_px, const std::string& more = "") {
  return R"({"obstacles": [], "pedestrians": [{"x_m": 8, "y_m": 1, "probability": )" + probability + more +
         R"(, "box": {"u_px": 1, "v_px": 2, "height_px": 6, "width_px": )" + width_px + "}}]}\n";
}

TEST(ParseDetections, RefusesSizesAndProbabilitiesThatNothingHas) {
  EXPECT_EQ(parse_complaint(person_line("0.5", "3")), "no complaint");
  EXPECT_THAT(parse_complaint(person_line("0.5", "-5")),
              HasSubstr("pedestrians[0].box.width_px: found -5, expected a number above 0"));
  EXPECT_THAT(parse_complaint(person_line("0.5", "0")), HasSubstr("box.width_px"));
  EXPECT_THAT(parse_complaint(person_line("7", "3")),
              HasSubstr("pedestrians[0].probability: found 7, expected 0 to 1"));
  EXPECT_THAT(parse_complaint(person_line("-0.1", "3")), HasSubstr("probability: found -0.1"));
  EXPECT_THAT(parse_complaint(person_line("0.5", "3", R"(, "height_m": -1)")), HasSubstr("height_m: found -1"));
  EXPECT_THAT(parse_complaint(R"({"obstacles": [{"x_m": 8, "y_m": 1, "width_m": -2}]})"),
              HasSubstr("obstacles[0].width_m: found -2, expected a number from 0"));
}

TEST(ParseDetections, RefusesPeopleOrScansInSomeLinesOnly) {
  const std::string none = "{\"obstacles\": []}\n", failed = "{\"obstacles\": [], \"error\": \"a.png: is empty\"}\n";
  EXPECT_THAT(parse_complaint(person_line("0.5", "3") + none), HasSubstr("d.jsonl: line 2: pedestrians: found none"));
  EXPECT_EQ(parse_complaint(none + none), "no complaint");
  const auto frames = parse_detections(failed + person_line("0.5", "3"), "d.jsonl");
  ASSERT_TRUE(frames[0].pedestrians);
  EXPECT_TRUE(frames[0].pedestrians->empty());

  const std::string scan =
      R"({"obstacles": [], "scan": {"angle_min_rad": 0, "angle_increment_rad": 1, "states": "o", "ranges_m": [3]}})"
      "\n";
  EXPECT_THAT(parse_complaint(scan + none), HasSubstr("d.jsonl: line 2: scan: found none, but line 1 has one"));
  const auto scans = parse_detections(failed + scan, "d.jsonl");
  ASSERT_TRUE(scans[0].scan);
  EXPECT_THAT(scans[0].scan->states, ::testing::ElementsAre(SectorState::unknown));
}

TEST(NoteOnUnusable, CountsLinesThatSayThatThePairCouldNotBeUsed) {
  const std::string found = "{\"obstacles\": []}\n", failed = "{\"obstacles\": [], \"error\": \"a.png: is empty\"}\n";
  const auto note = [](const std::string& text) {
    return note_on_unusable(parse_detections(text, "d.jsonl"), "d.jsonl");
  };
  EXPECT_EQ(note(found + failed + failed),
            "d.jsonl: 2 of 3 lines say that the pair could not be used; they count as nothing found");
  EXPECT_EQ(note(found + failed),
            "d.jsonl: 1 of 2 lines says that the pair could not be used; it counts as nothing found");
  EXPECT_EQ(note(found + "{\"obstacles\": [], \"error\": null}\n"), std::nullopt);
}

TEST(NotesOnPositions, DoubtsWhatIsNoMetres) {
  const auto notes = [](const std::string& obstacle) {
    return notes_on_positions(parse_detections("{\"obstacles\": [" + obstacle + "]}\n", "d.jsonl"), "d.jsonl");
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(notes(R"({"x_m": 80, "y_m": 1})"), ::testing::IsEmpty());
  EXPECT_THAT(notes(R"({"x_m": 8, "y_m": 1, "range_m": 6.5})"), ::testing::IsEmpty());
  EXPECT_THAT(notes(""), ::testing::IsEmpty());
  EXPECT_THAT(notes(R"({"x_m": 8000, "y_m": 1000})"), ElementsAre(HasSubstr("d.jsonl: half of the positions")));
  EXPECT_THAT(notes(R"({"x_m": 8, "y_m": 1}, {"x_m": 8, "y_m": 1, "range_m": 99})"),
              ElementsAre(HasSubstr("d.jsonl: line 1: range_m is not the distance of x_m and y_m, as in 1 of 2")));
}

TEST(ParseDetections, TakesNothingAsFoundInAPairThatCouldNotBeUsed) {
  const std::string found =
      R"("obstacles": [{"x_m": 8, "y_m": 1}], "pedestrians": [{"x_m": 8, "y_m": 1, "probability": 0.9, "box": )"
      R"({"u_px": 1, "v_px": 2, "width_px": 3, "height_px": 6}}], "scan": {"angle_min_rad": 0, )"
      R"("angle_increment_rad": 0.1, "ranges_m": [8, null], "states": "of"}})";
  const auto frames = parse_detections("{" + found + "\n{\"error\": \"a.png: is empty\", " + found + "\n", "d.jsonl");
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].obstacles.size(), 1U);
  EXPECT_EQ(frames[0].pedestrians.value().size(), 1U);
  EXPECT_EQ(frames[0].scan.value().states.front(), SectorState::obstacle);
  EXPECT_TRUE(frames[1].is_unusable);
  EXPECT_TRUE(frames[1].obstacles.empty());
  EXPECT_TRUE(frames[1].pedestrians.value().empty()) << "it looked for people";
  EXPECT_THAT(frames[1].scan.value().states, ::testing::Each(SectorState::unknown));
}

TEST(ParseDetections, ReadsWhatFliesDetectWrites) {
  FrameRecord record;
  record.frame = 3;
  record.left = "left/07.png";
  Obstacle obstacle;
  obstacle.x_m = 8;
  obstacle.y_m = 6;
  obstacle.range_m = 10;
  obstacle.width_m = 1.5;
  obstacle.height_m = 1.75;
  obstacle.score = 0.5;
  record.obstacles = {obstacle};
  Pedestrian person;
  person.x_m = 12;
  person.y_m = 5;
  person.range_m = 13;
  person.height_m = 1.8;
  person.probability = 0.75;
  person.box = {1, 2, 30, 60};
  record.pedestrians = {person};
  record.stage_ms = {1.0, 20.0, 2.0, 3.0, 100.0, 100.0};
  const auto frames = parse_detections(json_line(record) + "\n" + json_line(record), "d.jsonl");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].line, 3);  // an empty line lies between
  EXPECT_EQ(frames[0].frame, 3);
  EXPECT_EQ(frames[0].left, "left/07.png");
  EXPECT_EQ(frames[0].time_ms, 26.0);  // without proposing and classifying
  ASSERT_EQ(frames[0].obstacles.size(), 1u);
  EXPECT_EQ(frames[0].obstacles[0].x_m, 8);
  EXPECT_EQ(frames[0].obstacles[0].y_m, 6);
  EXPECT_EQ(frames[0].obstacles[0].range_m, 10);
  EXPECT_EQ(frames[0].obstacles[0].width_m, 1.5);
  EXPECT_EQ(frames[0].obstacles[0].height_m, 1.75);
  EXPECT_EQ(frames[0].people_time_ms, 226.0);
  ASSERT_TRUE(frames[0].pedestrians && frames[0].pedestrians->size() == 1);
  const Pedestrian& read = frames[0].pedestrians->front();
  EXPECT_EQ(read.range_m, 13);
  EXPECT_EQ(read.height_m, 1.8);
  EXPECT_EQ(read.probability, 0.75);
  EXPECT_EQ(read.box.v_px, 2);
  EXPECT_EQ(read.box.height_px, 60);
}

TEST(ParseDetections, NeedsNoMoreThanPositions) {
  const auto frames = parse_detections(R"({"obstacles": [{"x_m": 3, "y_m": -4}]})", "d.jsonl");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].obstacles[0].range_m, 5.0);
  EXPECT_FALSE(frames[0].frame.has_value());
  EXPECT_FALSE(frames[0].time_ms.has_value());
  EXPECT_FALSE(frames[0].pedestrians.has_value()) << "it did not look for people";
}

TEST(ParseDetections, TakesAScoreForAProbability) {
  const auto frames = parse_detections(R"({"obstacles": [], "pedestrians": [{"x_m": 3, "y_m": -4, "score": 17, )"
                                       R"("box": {"u_px": 1, "v_px": 2, "width_px": 3, "height_px": 4}}]})",
                                       "d.jsonl");
  EXPECT_EQ(frames.at(0).pedestrians->at(0).probability, 17.0);
}

TEST(ParseDetections, NamesLineAndField) {
  EXPECT_EQ(parse_complaint("{\"obstacles\": []}\n{\"obsta"), "d.jsonl: line 2: not JSON");
  EXPECT_THAT(parse_complaint("[1]"), HasSubstr("line 1: found no object"));
  EXPECT_THAT(parse_complaint("{}"), HasSubstr("line 1: obstacles: found none"));
  EXPECT_THAT(parse_complaint(R"({"obstacles": [7]})"), HasSubstr("line 1: obstacles[0]: found number"));
  EXPECT_THAT(parse_complaint(R"({"obstacles": [{"x_m": 1}]})"), HasSubstr("line 1: obstacles[0].y_m: found none"));
  EXPECT_THAT(parse_complaint(R"({"obstacles": [{"x_m": null, "y_m": 1}]})"), HasSubstr("obstacles[0].x_m"));
  EXPECT_THAT(parse_complaint(R"({"obstacles": [{"x_m": "far", "y_m": 1}]})"), HasSubstr("found string"));
  EXPECT_THAT(parse_complaint(R"({"frame": 1.5, "obstacles": []})"), HasSubstr("frame: found 1.5"));
  EXPECT_THAT(parse_complaint(R"({"frame": 99999999999999, "obstacles": []})"), HasSubstr("frame: found 9999"));
  EXPECT_THAT(parse_complaint(R"({"left": 5, "obstacles": []})"), HasSubstr("left: found number"));
  const auto of_person = [](const std::string& entry) {
    return parse_complaint("{\"obstacles\": [], \"pedestrians\": " + entry + "}");
  };
  EXPECT_THAT(of_person("3"), HasSubstr("pedestrians: found number, expected a list"));
  EXPECT_THAT(of_person(R"([{"x_m": 1, "y_m": 2}])"), HasSubstr("pedestrians[0].score: found none"));
  EXPECT_THAT(of_person(R"([{"x_m": 1, "y_m": 2, "score": 1}])"), HasSubstr("pedestrians[0].box: found none"));
  EXPECT_THAT(of_person(R"([{"x_m": 1, "y_m": 2, "score": 1, "box": {"u_px": 1}}])"),
              HasSubstr("pedestrians[0].box.v_px: found none"));
}

TEST(ParseDetections, ReadsAScan) {
  const auto frames = parse_detections(
      R"({"obstacles": [], "scan": {"angle_min_rad": -0.5, "angle_increment_rad": 0.25, "states": "ofu", )"
      R"("ranges_m": [7.5, null, null], "free_m": [7, 20, 0], "confidence": [0.9, 0.8, 0]}})"
      "\n"
      R"({"obstacles": [], "scan": {"angle_min_rad": 0, "angle_increment_rad": 1, "states": "o", "ranges_m": [3]}})",
      "d.jsonl");
  ASSERT_EQ(frames.size(), 2u);
  const Scan& scan = frames[0].scan.value();
  EXPECT_EQ(scan.angle_min_rad, -0.5);
  EXPECT_EQ(scan.angle_increment_rad, 0.25);
  EXPECT_EQ(scan.states, (std::vector{SectorState::obstacle, SectorState::free, SectorState::unknown}));
  EXPECT_EQ(scan.ranges_m[0], 7.5);
  EXPECT_TRUE(std::isnan(scan.ranges_m[1]));
  EXPECT_EQ(scan.free_m, (std::vector{7.0, 20.0, 0.0}));
  EXPECT_EQ(scan.confidence, (std::vector{0.9, 0.8, 0.0}));
  EXPECT_EQ(frames[1].scan.value().confidence, std::vector{1.0});
  EXPECT_EQ(frames[1].scan.value().free_m, std::vector{0.0});
  EXPECT_FALSE(parse_detections("{\"obstacles\": []}", "d.jsonl")[0].scan.has_value());
}

TEST(ParseDetections, NamesWhatIsWrongWithAScan) {
  const auto complaint_of = [](const std::string& scan) {
    return parse_complaint(R"({"obstacles": [], "scan": )" + scan + "}");
  };
  EXPECT_THAT(complaint_of("[]"), HasSubstr("d.jsonl: line 1: scan: found array, expected an object"));
  EXPECT_THAT(complaint_of("{}"), HasSubstr("scan.angle_min_rad"));
  const auto of_sectors = [&](double increment) {
    return complaint_of(R"({"angle_min_rad": 0, "ranges_m": [null, null, null, null], "states": "uuuu", )"
                        R"("angle_increment_rad": )" +
                        std::to_string(increment) + "}");
  };
  EXPECT_EQ(of_sectors(1.5708), "no complaint") << "a whole turn";
  EXPECT_THAT(of_sectors(1.6), HasSubstr("scan.states: found 4 sectors of 1.6 rad, which are 1.02 turns"));
  const std::string start = R"({"angle_min_rad": 0, "angle_increment_rad": )";
  EXPECT_THAT(complaint_of(start + "0}"), HasSubstr("scan.angle_increment_rad: expected a number above 0"));
  EXPECT_THAT(complaint_of(start + "1}"), HasSubstr("scan.states"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "ox"})"), HasSubstr("scan.states[1]"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "of"})"), HasSubstr("scan.ranges_m: found none"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "of", "ranges_m": [4]})"), HasSubstr("a list of 2 numbers"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "of", "ranges_m": [4, "5"]})"), HasSubstr("scan.ranges_m[1]"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "of", "ranges_m": [null, 5]})"), HasSubstr("scan.ranges_m[0]"));
  EXPECT_THAT(complaint_of(start + R"(1, "states": "o", "ranges_m": [4], "confidence": [-1]})"),
              HasSubstr("scan.confidence[0]"));
}

TEST(MatchDetections, GoesByTheNameOfTheLeftImage) {
  const auto reported = parse_detections(
      "{\"frame\": 0, \"left\": \"elsewhere/b.png\", \"obstacles\": []}\n"
      "{\"frame\": 1, \"left\": \"a.jpg\", \"obstacles\": []}\n",
      "d.jsonl");
  const auto matched = match_detections(reported, kTwoPairs, "d.jsonl");
  EXPECT_EQ(matched[0].line, 2);
  EXPECT_EQ(matched[1].line, 1);
}

TEST(MatchDetections, GoesByNumberAndThenByOrder) {
  const std::string numbered = "{\"frame\": 1, \"obstacles\": []}\n{\"frame\": 0, \"obstacles\": []}\n";
  EXPECT_EQ(match_detections(parse_detections(numbered, "d"), kTwoPairs, "d")[0].line, 2);
  const std::string plain = "{\"obstacles\": []}\n{\"obstacles\": []}\n";
  EXPECT_EQ(match_detections(parse_detections(plain, "d"), kTwoPairs, "d")[0].line, 1);
}

TEST(MatchDetections, AsksForOneLineAPair) {
  EXPECT_EQ(match_complaint("{\"obstacles\": []}\n"), "d.jsonl: found 1 lines, expected 2, one per pair");
  EXPECT_THAT(match_complaint("{\"frame\": 1, \"obstacles\": []}\n{\"frame\": 1, \"obstacles\": []}\n"),
              HasSubstr("d.jsonl: line 2: found a second line for pair 1"));
  EXPECT_THAT(match_complaint("{\"left\": \"a.png\", \"obstacles\": []}\n{\"left\": \"c.png\", \"obstacles\": []}\n"),
              HasSubstr("d.jsonl: left: found no line for pair b"));
}

TEST(ParseDetections, RefusesNumbersThatOverflowAndNestingWithoutEnd) {
  const auto error_with = [](const std::string& frame, const std::string& x_m) {
    return flies::testing::error_of([&] {
      parse_detections("{\"frame\": " + frame + ", \"obstacles\": [{\"x_m\": " + x_m + ", \"y_m\": 1}]}", "d.jsonl");
    });
  };
  EXPECT_EQ(error_with("3", "8"), "no error");
  for (const char* frame : {"1e30", "2147483648", "-1", "0.5"})
    EXPECT_THAT(error_with(frame, "8"), ::testing::HasSubstr("expected a whole number")) << frame;
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THAT(error_with(deep, "8"), ::testing::HasSubstr("frame: found array"));
  EXPECT_THAT(error_with("3", "1e300"), ::testing::HasSubstr("obstacles[0].x_m: found 1e+300"));
}

TEST(ParseDetections, NamesTheKindOfWhatIsNestedInAScan) {
  constexpr int kDeep = 1'000'000;
  const std::string nest = std::string(kDeep, '[') + std::string(kDeep, ']');
  EXPECT_THAT(
      [&] {
        parse_detections(
            R"({"obstacles":[],"scan":{"angle_min_rad":0,"angle_increment_rad":0.1,"states":"o","ranges_m":[)" + nest +
                "]}}",
            "found.jsonl");
      },
      ThrowsMessage<InputError>(HasSubstr("found array, expected a number")));
}

TEST(ParseDetections, BearsMarksBlanksAndComments) {
  const std::string line = R"({"frame": 3, "obstacles": []})";
  EXPECT_EQ(parse_detections("\xEF\xBB\xBF" + line + "\r\n\r\n# more\r\n" + line + "\r\n", "d").size(), 2U);
}

}  // namespace
}  // namespace flies
