#include "flies/io/writers.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "flies/io/fitness_color.hpp"

namespace flies {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

FrameRecord example() {
  FrameRecord record;
  record.frame = 7;
  record.left = "l/7.png";
  record.right = "r/7.png";
  record.seed = 18446744073709551615ULL;
  record.preset = "default";
  record.obstacles.push_back({.x_m = 12.34567,
                              .y_m = -1.10049,
                              .range_m = 12.3949,
                              .width_m = 0.5,
                              .middle_offset_m = -0.125,
                              .depth_m = 0.25,
                              .height_m = 1.75,
                              .ground_z_m = 0.1,
                              .score = 0.0123456789,
                              .box = {100.126, 50, 20, 60.5},
                              .range_sd_m = 0.2345});
  record.pedestrians.push_back({12.3, -0.0, 12.3, 1.71, 0.75, {101, 52, 18, 58}, 0.25});
  record.stage_ms = {1.23456, 2, 3, 4, 5};
  return record;
}

/// An obstacle to the right, free ground ahead, nothing known to the left.
Scan three_sectors() {
  Scan scan;
  scan.angle_min_rad = -0.0087266463;
  scan.angle_increment_rad = 0.0087266463;
  scan.ranges_m = {12.34567, kNan, kNan};
  scan.free_m = {11.5, 30.0004, 0};
  scan.confidence = {0.87654321, 0.5, 0};
  scan.states = {SectorState::obstacle, SectorState::free, SectorState::unknown};
  return scan;
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

TEST(JsonLine, SaysWhatTheRunWasMadeOf) {
  FrameRecord record = example();
  RunRecord run;
  run.version = "1.2.3";
  run.calibration = "calib.txt";
  run.camera.fx_px = 700.125;
  run.camera.width_px = 640;
  run.people_model = "none";
  run.preset = "robot";
  run.options = {{"evolve.flies", "5000"}, {"evolve.initial", "image"}};
  record.run = std::make_shared<const RunRecord>(run);
  record.road = {.height_m = 0.1, .slope = -0.01, .bank = 0.002};
  const auto json = Json::parse(json_line(record));
  EXPECT_EQ(json["run"]["version"], "1.2.3");
  EXPECT_EQ(json["run"]["camera"]["fx_px"], 700.125);
  EXPECT_EQ(json["run"]["camera"]["width_px"], 640);
  EXPECT_EQ(json["run"]["people_model"], "none");
  EXPECT_EQ(json["run"]["options"]["evolve.flies"], 5000);
  EXPECT_EQ(json["run"]["options"]["evolve.initial"], "image");
  EXPECT_EQ(json["road"]["slope"], -0.01);
  EXPECT_EQ(json["road"]["found"], true);
  record.road_found = false;
  EXPECT_EQ(Json::parse(json_line(record))["road"]["found"], false);
}

TEST(JsonLine, HasTheSchemaInOrder) {
  const std::string line = json_line(example());
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const Json json = Json::parse(line);
  EXPECT_THAT(keys_of(json),
              ElementsAre("frame", "left", "right", "seed", "preset", "obstacles", "pedestrians", "stage_ms"));
  EXPECT_THAT(keys_of(json["obstacles"][0]), ElementsAre("x_m", "y_m", "range_m", "range_sd_m", "width_m",
                                                         "middle_offset_m", "depth_m", "height_m", "score", "box"));
  EXPECT_THAT(keys_of(json["pedestrians"][0]),
              ElementsAre("x_m", "y_m", "range_m", "range_sd_m", "height_m", "probability", "box", "obstacle"));
  EXPECT_THAT(keys_of(json["obstacles"][0]["box"]), ElementsAre("u_px", "v_px", "width_px", "height_px"));
  EXPECT_THAT(keys_of(json["stage_ms"]), ElementsAreArray(kStageNames));
}

TEST(JsonLine, RoundsNumbers) {
  const std::string line = json_line(example());
  EXPECT_THAT(line, HasSubstr("\"x_m\":12.346,\"y_m\":-1.1,"));
  EXPECT_THAT(line, HasSubstr("\"score\":0.0123457,"));
  EXPECT_THAT(line, HasSubstr("\"u_px\":100.13,"));
  EXPECT_THAT(line, HasSubstr("\"" + std::string(kStageNames[0]) + "\":1.235,"));
  EXPECT_THAT(line, HasSubstr("\"seed\":18446744073709551615,"));
  EXPECT_THAT(line, Not(HasSubstr("-0.0")));
}

TEST(JsonLine, HoldsTheScanBeforeTheTimes) {
  auto record = example();
  record.scan = three_sectors();
  const Json json = Json::parse(json_line(record));
  EXPECT_THAT(keys_of(json), ElementsAre("frame", "left", "right", "seed", "preset", "obstacles", "pedestrians", "scan",
                                         "free_space", "stage_ms"));
  EXPECT_EQ(json["scan"].dump(),
            "{\"angle_min_rad\":-0.008727,\"angle_increment_rad\":0.008727,\"ranges_m\":[12.346,null,null],"
            "\"free_m\":[11.5,30.0,0.0],\"confidence\":[0.876543,0.5,0.0],\"states\":\"ofu\"}");
  EXPECT_EQ(json["free_space"].dump(), "[[0.0,0.0],[11.499,-0.151],[11.5,-0.05],[30.0,-0.131],[30.0,0.131]]");
}

TEST(JsonLine, SaysHowSureTheRangesOfAScanAreWhereItKnowsTheCamera) {
  auto record = example();
  record.scan = three_sectors();
  RunRecord run;
  run.camera = {
      .fx_px = 700, .fy_px = 700, .cx_px = 600, .cx_right_px = 600, .cy_px = 170, .baseline_m = 0.5, .mount = {}};
  record.run = std::make_shared<RunRecord>(run);
  const double sd_m = range_deviation_m(run.camera, 12.34567);
  const Json sd = Json::parse(json_line(record)).at("scan").at("range_sd_m");
  ASSERT_EQ(sd.size(), 3U);
  EXPECT_NEAR(sd[0].get<double>(), sd_m, 5e-4);
  EXPECT_TRUE(sd[1].is_null());
  EXPECT_THAT(scan_csv_rows(record), HasSubstr(fmt::format("0.876543,{:.3f}\n", sd_m)));
}

TEST(JsonLine, LeavesAnEmptyScanOut) {
  const Json json = Json::parse(json_line(example()));  // a stage is called scan, too
  EXPECT_FALSE(json.contains("scan"));
  EXPECT_FALSE(json.contains("free_space"));
}

TEST(JsonLine, HoldsEmptyListsWhenNothingWasFound) {
  EXPECT_THAT(json_line({}), HasSubstr("\"obstacles\":[],\"pedestrians\":[]"));
}

TEST(JsonLine, NeverHoldsNumbersThatAreNotFinite) {
  auto record = example();
  record.obstacles[0].x_m = kNan;
  record.obstacles[0].score = kInfinity;
  record.stage_ms[0] = -kInfinity;
  record.obstacles[0].range_m = 1e307;  // overflows when it is scaled for rounding
  const Json json = Json::parse(json_line(record));
  EXPECT_TRUE(json["obstacles"][0]["x_m"].is_null());
  EXPECT_TRUE(json["obstacles"][0]["score"].is_null());
  EXPECT_TRUE(json["stage_ms"][std::string(kStageNames[0])].is_null());
  EXPECT_EQ(json["obstacles"][0]["range_m"], 1e307);
}

TEST(JsonLine, SurvivesFileNamesThatAreNotUtf8) {
  auto record = example();
  record.left = "caf\xE9 \"1\"\n.png";
  EXPECT_EQ(Json::parse(json_line(record))["left"], "caf\xEF\xBF\xBD \"1\"\n.png");
}

TEST(CsvRows, MatchTheHeader) {
  auto record = example();
  record.obstacles[0].score = kNan;
  EXPECT_EQ(
      csv_header() + csv_rows(record),
      "frame,left,right,kind,x_m,y_m,range_m,width_m,depth_m,height_m,score,probability,u_px,v_px,width_px,height_px,"
      "range_sd_m\n"
      "7,l/7.png,r/7.png,obstacle,12.346,-1.100,12.395,0.500,0.250,1.750,,,100.13,50.00,20.00,60.50,0.234\n"
      "7,l/7.png,r/7.png,pedestrian,12.300,-0.000,12.300,,,1.710,,0.75,101.00,52.00,18.00,58.00,0.250\n");
}

TEST(CsvRows, QuoteNamesAsRfc4180Says) {
  auto record = example();
  record.left = "a, \"b\".png";
  EXPECT_THAT(csv_rows(record), StartsWith("7,\"a, \"\"b\"\".png\",r/7.png,"));
  EXPECT_EQ(csv_rows({}), "");
}

TEST(ScanCsvRows, MatchTheHeader) {
  auto record = example();
  record.scan = three_sectors();
  EXPECT_EQ(scan_csv_header() + scan_csv_rows(record),
            "frame,angle_rad,angle_deg,state,range_m,free_m,confidence,range_sd_m\n"
            "7,-0.008727,-0.5000,obstacle,12.346,11.500,0.876543,\n"
            "7,0.000000,0.0000,free,,30.000,0.5,\n"
            "7,0.008727,0.5000,unknown,,0.000,0,\n");
  EXPECT_EQ(scan_csv_rows({}), "");
}

TEST(PlyText, HoldsEveryFiniteFlyWithItsColour) {
  Population flies;
  flies.push_back({10, 1, 0.5}, 0.0F);
  flies.push_back({20, -1, 1.5}, 8.0F);
  flies.push_back({kNan, 0, 0}, 1.0F);
  const std::string ply = ply_text(flies);
  EXPECT_THAT(ply, StartsWith("ply\nformat ascii 1.0\n"));
  EXPECT_THAT(ply, HasSubstr("element vertex 2\n"));
  const auto body = ply.substr(ply.find("end_header\n") + 11);
  EXPECT_THAT(body, StartsWith("10.0000 1.0000 0.5000 0 0 255 0\n"));
  EXPECT_EQ(std::count(body.begin(), body.end(), '\n'), 2);
}

TEST(PlyText, OfNoFliesIsAnEmptyCloud) { EXPECT_THAT(ply_text({}), HasSubstr("element vertex 0\n")); }

TEST(FitnessColor, RunsFromBlueOverGreenToRed) {
  EXPECT_EQ(fitness_color(0.0), (Rgb{0, 0, 255}));
  EXPECT_EQ(fitness_color(0.5), (Rgb{0, 255, 0}));
  EXPECT_EQ(fitness_color(1.0), (Rgb{255, 0, 0}));
  EXPECT_EQ(fitness_color(9.0), (Rgb{255, 0, 0}));
  EXPECT_EQ(fitness_color(kNan), (Rgb{0, 0, 255}));
}

TEST(FullScaleFitness, IsNotMovedByAFewGiants) {
  std::vector<float> fitness(1000, 1.0F);
  fitness[3] = 1e9F;
  fitness[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(full_scale_fitness(fitness), 1.0F);
  EXPECT_EQ(full_scale_fitness({}), 0.0F);
}

}  // namespace
}  // namespace flies
