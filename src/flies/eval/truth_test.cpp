#include "flies/eval/truth.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <string>

#include "flies/core/error.hpp"
#include "flies/eval/foot_truth.hpp"
#include "flies/eval/kitti_truth.hpp"
#include "flies/eval/scene_truth.hpp"

namespace flies {
namespace {

constexpr double kExact = 1e-9;        // sums of a few doubles
constexpr double kRoadNoise_m = 0.03;  // quantiles over 1 m cells of a smooth slope

StereoCamera level_camera() {
  StereoCamera camera;
  camera.fx_px = camera.fy_px = 700.0;
  camera.cx_px = camera.cx_right_px = 600.0;
  camera.cy_px = 180.0;
  camera.baseline_m = 0.5;
  camera.width_px = 1200;
  camera.height_px = 360;
  return camera;
}

const std::string kTracklets = R"(<?xml version="1.0"?>
<!DOCTYPE boost_serialization>
<boost_serialization signature="serialization::archive" version="9"><tracklets version="0"><count>2</count>
<item><objectType>Van</objectType><h>2</h><w>1.8</w><l>4.4</l><first_frame>3</first_frame>
  <poses><count>2</count><item_version>2</item_version>
    <item><tx>13.5</tx><ty>4.5</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.5</rz><state>2</state>
      <occlusion>0</occlusion><truncation>0</truncation></item>
    <item><tx>14.5</tx><ty>4.5</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.5</rz><state>1</state>
      <occlusion>2</occlusion><truncation>99</truncation></item></poses></item>
<item><objectType>Cyclist</objectType><h>1.7</h><w>0.8</w><l>1.8</l><first_frame>0</first_frame>
  <poses><item><tx> 6 </tx><ty>-1</ty><tz>-1.6</tz><rz>0</rz><occlusion>-1</occlusion><truncation>-1</truncation></item>
  </poses></item>
</tracklets></boost_serialization>)";

TEST(ParseTracklets, CountsFramesFromTheFirst) {
  const auto poses = parse_tracklets(kTracklets, "tracklet_labels.xml");
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].type, "Van");
  EXPECT_EQ(poses[0].frame, 3);
  EXPECT_EQ(poses[1].frame, 4);
  EXPECT_EQ(poses[1].bottom_centre.x_m, 14.5);
  EXPECT_EQ(poses[1].occlusion, 2);
  EXPECT_EQ(poses[1].truncation, 99);
  EXPECT_EQ(poses[2].type, "Cyclist");
  EXPECT_EQ(poses[2].track, 1);
  EXPECT_EQ(poses[2].frame, 0);
  EXPECT_EQ(poses[2].bottom_centre.x_m, 6.0);
  EXPECT_EQ(poses[2].length_m, 1.8);
}

std::string complaint(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ParseTracklets, NamesFileAndField) {
  EXPECT_THAT(complaint([] { parse_tracklets("<a><b>", "t.xml"); }), testing::HasSubstr("t.xml: not XML"));
  EXPECT_THAT(complaint([] { parse_tracklets("<a/>", "t.xml"); }), testing::HasSubstr("t.xml: tracklets"));
  std::string bad = kTracklets;
  bad.replace(bad.find("13.5"), 4, "nan!");
  EXPECT_THAT(complaint([&] { parse_tracklets(bad, "t.xml"); }), testing::HasSubstr("t.xml: tx: found \"nan!\""));
  bad = kTracklets;
  bad.replace(bad.find("<h>2"), 4, "<h>0");
  EXPECT_THAT(complaint([&] { parse_tracklets(bad, "t.xml"); }), testing::HasSubstr("t.xml: h, w, l"));
}

TEST(ParseLabels, ReadsSizesInTheOrderHeightWidthLength) {
  const auto labels = parse_labels(
      "Pedestrian 0.25 1 0.15 389.42 179.08 424.76 303.37 1.87 0.64 0.65 -3.21 1.97 11.22 -0.13\n"
      "DontCare -1 -1 -10 553 181 587 200 -1 -1 -1 -1000 -1000 -1000 -10\n",
      "000274.txt");
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[1].type, "DontCare");
  EXPECT_EQ(labels[1].box.u_px, 553.0);
  EXPECT_EQ(labels[1].box.width_px, 34.0);
  EXPECT_EQ(labels[0].type, "Pedestrian");
  EXPECT_EQ(labels[0].box.v_px, 179.08);
  EXPECT_NEAR(labels[0].box.height_px, 124.29, 1e-9);
  EXPECT_EQ(labels[0].truncation, 0.25);
  EXPECT_EQ(labels[0].occlusion, 1);
  EXPECT_EQ(labels[0].height_m, 1.87);
  EXPECT_EQ(labels[0].width_m, 0.64);
  EXPECT_EQ(labels[0].length_m, 0.65);
  EXPECT_EQ(labels[0].bottom_centre.x_m, -3.21);
  EXPECT_EQ(labels[0].bottom_centre.z_m, 11.22);
  EXPECT_EQ(labels[0].rotation_y_rad, -0.13);
}

TEST(ParseLabels, NamesTheLine) {
  EXPECT_THAT(complaint([] { parse_labels("\nCar 0 0 1\n", "7.txt"); }),
              testing::HasSubstr("7.txt: line 2: found 4 fields, expected 15"));
}

TEST(ParseLabels, RefusesMoreThanAPictureCanHave) {
  std::string labels;
  for (int i = 0; i < 2001; ++i) labels += "Car 0 3 1 0 0 9 9 1 1 1 1 1 9 0\n";
  EXPECT_THAT(complaint([&] { parse_labels(labels, "7.txt"); }),
              testing::HasSubstr("7.txt: line 2001: there are more than 2000 labels of one picture"));
}

TEST(ParseFootPoints, PlacesPeopleInTheVehicleFrame) {
  StereoCamera camera = level_camera();
  camera.mount.height_m = 1.0;
  const auto frames =
      parse_foot_points("# header\n2,7,10,20,30,140,1,-1.0,0.9,8.75\n2,8,1,2,3,4,0,2,0.9,30\n", "t.csv", camera);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_TRUE(frames[0].objects.empty());
  EXPECT_EQ(frames[1].frame, 1);
  ASSERT_EQ(frames[1].objects.size(), 2u);
  const auto& person = frames[1].objects[0];
  EXPECT_EQ(person.track, 7);
  EXPECT_NEAR(near_face_range_m(person.footprint, std::atan2(1.0, 8.75)).value(), std::hypot(8.75, 1.0), kExact)
      << "the foot point is the near face";
  EXPECT_NEAR(std::atan2(person.footprint.y_m, person.footprint.x_m), std::atan2(1.0, 8.75), kExact);
  EXPECT_EQ(person.box.u_px, 10.0);
  EXPECT_EQ(person.box.height_px, 140.0);
  EXPECT_NEAR(person.bottom_z_m, 0.1, kExact);
  EXPECT_NEAR(person.height_m, 140.0 * 8.75 / 700.0, kExact);
  EXPECT_TRUE(person.visible);
  EXPECT_FALSE(frames[1].objects[1].visible);
}

TEST(ParseFootPoints, NamesTheLine) {
  const auto camera = level_camera();
  const auto parse = [&](const char* text) { return complaint([&] { parse_foot_points(text, "t.csv", camera); }); };
  EXPECT_THAT(parse("1,2,3\n"), testing::HasSubstr("t.csv: line 1: found 3 fields"));
  EXPECT_THAT(parse("0,1,1,1,1,1,1,1,1,1\n"), testing::HasSubstr("found frame 0"));
  EXPECT_THAT(parse("1,1,1,1,1,1,1,1,1,-3\n"), testing::HasSubstr("found Z -3"));
}

constexpr const char* kScene = R"({"seed": 1, "objects": [
  {"class": "pedestrian", "x_m": 9.0, "y_m": -1.0, "z_m": 0.1, "yaw_rad": 0.2, "length_m": 0.5, "width_m": 0.6,
   "height_m": 1.7, "truncation": 0.0, "occlusion": 0.2, "visible_px": 900},
  {"class": "car", "x_m": 19.0, "y_m": 1.0, "z_m": 0.0, "yaw_rad": 0.0, "length_m": 4.0, "width_m": 1.8,
   "height_m": 1.5, "truncation": 0.0, "occlusion": 0.7, "visible_px": 800},
  {"class": "wall", "x_m": 30.0, "y_m": 9.0, "z_m": 0.0, "yaw_rad": 0.0, "length_m": 40.0, "width_m": 0.5,
   "height_m": 8.0, "truncation": 0.0, "occlusion": 0.0, "visible_px": 9000}]})";

TEST(ParseSceneTruth, DoesNotAskForWhatGoesOnAlongTheView) {
  const auto is_asked_for = [](const std::string& type) {
    const std::string object = R"("x_m": 3.0, "y_m": 0.0, "length_m": 1.0, "width_m": 1.0, "height_m": 1.0}]})";
    return parse_scene_truth(R"({"objects": [{"class": ")" + type + "\", " + object, "t.json").objects[0].visible;
  };
  for (const char* type : {"wall", "hedge", "shelf", "kerb"}) EXPECT_FALSE(is_asked_for(type)) << type;
  for (const char* type : {"box", "furniture", "pallet", "tree"}) EXPECT_TRUE(is_asked_for(type)) << type;
}

TEST(ParseSceneTruth, AsksForRoadUsersThatAreMostlySeen) {
  const FrameTruth truth = parse_scene_truth(kScene, "truth.json");
  ASSERT_EQ(truth.objects.size(), 3u);
  EXPECT_EQ(truth.objects[0].type, "Pedestrian");
  EXPECT_EQ(truth.objects[0].footprint.y_m, -1.0);
  EXPECT_EQ(truth.objects[0].footprint.width_m, 0.6);
  EXPECT_EQ(truth.objects[0].bottom_z_m, 0.1);
  EXPECT_EQ(truth.objects[0].height_m, 1.7);
  EXPECT_EQ(truth.objects[0].occlusion, 1);
  EXPECT_TRUE(truth.objects[0].visible);
  EXPECT_EQ(truth.objects[1].type, "Car");
  EXPECT_FALSE(truth.objects[1].visible);  // 70 % hidden
  EXPECT_FALSE(truth.objects[2].visible);  // a wall may be reported, but where along it is nobody's fault
}

TEST(ParseSceneTruth, NamesFileAndObject) {
  EXPECT_THAT(complaint([] { parse_scene_truth("{", "s.json"); }), testing::HasSubstr("s.json: not JSON"));
  EXPECT_THAT(complaint([] { parse_scene_truth("[1]", "s.json"); }), testing::HasSubstr("s.json: objects"));
  EXPECT_THAT(complaint([] { parse_scene_truth(R"({"objects": [{"class": "car"}]})", "s.json"); }),
              testing::HasSubstr("s.json: objects[0].x_m"));
}

TEST(ParseSceneTruth, RefusesWhatNoObjectCanBe) {
  const auto complaint_of = [](const std::string& key, const std::string& value) {
    std::map<std::string, std::string> numbers = {
        {"x_m", "9"}, {"y_m", "0"}, {"length_m", "1"}, {"width_m", "1"}, {"height_m", "1"}};
    numbers[key] = value;
    std::string object = R"("class": "car")";
    for (const auto& [name, number] : numbers) object += ", \"" + name + "\": " + number;
    return complaint([&] { parse_scene_truth("{\"objects\": [{" + object + "}]}", "s.json"); });
  };
  for (const char* size : {"length_m", "width_m", "height_m", "visible_px"})
    EXPECT_EQ(complaint_of(size, "-1"), fmt::format("s.json: objects[0].{}: found -1, expected a number from 0", size));
  for (const char* share : {"occlusion", "truncation"})
    for (const char* value : {"2", "-0.5"})
      EXPECT_EQ(complaint_of(share, value),
                fmt::format("s.json: objects[0].{}: found {}, expected a number from 0 to 1", share, value));
  EXPECT_THAT(complaint_of("id", "0.5"), testing::HasSubstr("s.json: objects[0].id: found 0.5"));
  for (const char* share : {"0", "1"}) EXPECT_EQ(complaint_of("occlusion", share), "nothing was thrown");
}

// Numbers that fit into a double and into nothing else.

TEST(ParseLabels, RefusesNumbersThatOverflow) {
  const std::string rest = " -0.20 712 143 810 307 1.89 0.48 1.20 1.84 1.47 8.41 0.01\n";
  EXPECT_THAT(complaint([&] { parse_labels("Pedestrian 0.00 1e30" + rest, "7.txt"); }),
              testing::HasSubstr("7.txt: line 1: found 1e+30, expected a number within"));
  EXPECT_THAT(complaint([&] { parse_labels("Pedestrian 0.00 0.5" + rest, "7.txt"); }),
              testing::HasSubstr("expected a whole number"));
  EXPECT_THAT(complaint([&] { parse_labels("Pedestrian 1e300 0" + rest, "7.txt"); }), testing::HasSubstr("line 1"));
}

TEST(ParseTracklets, RefusesNumbersThatOverflow) {
  const auto complaint_of = [](const std::string& first_frame, const std::string& occlusion) {
    return complaint([&] {
      parse_tracklets(
          "<boost_serialization><tracklets><item><objectType>Car</objectType><h>1</h><w>1</w><l>4</l>"
          "<first_frame>" +
              first_frame + "</first_frame><poses><item><tx>15</tx><ty>2</ty><tz>-1</tz><rz>1</rz><occlusion>" +
              occlusion +
              "</occlusion><truncation>0</truncation></item></poses></item></tracklets>"
              "</boost_serialization>",
          "t.xml");
    });
  };
  for (const char* frame : {"1e30", "2147483647", "-1", "0.5"})
    EXPECT_THAT(complaint_of(frame, "0"), testing::HasSubstr("t.xml: first_frame: found")) << frame;
  EXPECT_THAT(complaint_of("0", "1e300"), testing::HasSubstr("t.xml: occlusion: found"));
}

TEST(ParseFootPoints, RefusesNumbersThatOverflow) {
  const auto camera = level_camera();
  const auto parse = [&](const char* text) { return complaint([&] { parse_foot_points(text, "t.csv", camera); }); };
  EXPECT_THAT(parse("1,1e300,100,50,30,90,1,1.0,0.9,8.0\n"), testing::HasSubstr("t.csv: line 1: found"));
  EXPECT_THAT(parse("1,0.5,100,50,30,90,1,1.0,0.9,8.0\n"), testing::HasSubstr("found person 0.5"));
  EXPECT_THAT(parse("1e30,1,100,50,30,90,1,1.0,0.9,8.0\n"), testing::HasSubstr("t.csv: line 1: found"));
}

TEST(ParseSceneTruth, RefusesNumbersThatOverflow) {
  for (const char* x_m : {"1e300", "-1e300", "1e10"})
    EXPECT_THAT(complaint([&] {
                  parse_scene_truth(
                      std::string(R"({"objects": [{"class": "car", "y_m": 0, "length_m": 4, "width_m": 2,)") +
                          R"( "height_m": 2, "x_m": )" + x_m + "}]}",
                      "s.json");
                }),
                testing::HasSubstr("s.json: objects[0].x_m: found"))
        << x_m;
}

TEST(VehicleFromLeftCamera, SwapsTheAxesAndAddsTheHeight) {
  const auto camera = level_camera();
  const Point3 point = vehicle_from_left_camera(camera, Projection(camera), {2.0, 1.65, 10.0});
  EXPECT_NEAR(point.x_m, 10.0, kExact);
  EXPECT_NEAR(point.y_m, -2.0, kExact);
  EXPECT_NEAR(point.z_m, 0.0, kExact);
}

std::vector<Point3> sloping_road(double height_m, double slope, double bank) {
  std::vector<Point3> points;
  for (int i = 0; i <= 120; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const double x = 3.0 + 0.25 * i, y = 0.25 * j;
      points.push_back({x, y, height_m + slope * x + bank * y});
    }
  }
  return points;
}

TEST(MeasureAboveRoad, FollowsASlope) {
  auto points = sloping_road(-0.1, 0.02, -0.01);
  points.push_back({20.0, 3.0, -0.1 + 0.4 - 0.03 + 1.5});
  const auto measured = measure_above_road(points);
  ASSERT_EQ(measured.size(), points.size());
  EXPECT_NEAR(measured.back().above_road_m, 1.5, kRoadNoise_m);
  for (std::size_t i = 0; i + 1 < measured.size(); ++i) EXPECT_NEAR(measured[i].above_road_m, 0.0, kRoadNoise_m);
}

TEST(MeasureAboveRoad, FollowsAPavementHigherThanTheRoad) {
  constexpr double kPavement_m = 0.25;
  auto points = sloping_road(0.0, 0.0, 0.0);
  for (auto& p : points) p.z_m = p.y_m > 4.0 ? kPavement_m : 0.0;
  points.push_back({15.0, 8.5, 1.25});
  EXPECT_NEAR(measure_above_road(points).back().above_road_m, 1.0, kRoadNoise_m);
}

TEST(MeasureAboveRoad, IsNotLiftedByAWall) {
  auto points = sloping_road(0.0, 0.0, 0.0);
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 25; ++k) points.push_back({10.0, -5.0 + 0.05 * i, 0.1 * k});
  }
  const auto measured = measure_above_road(points);
  ASSERT_EQ(measured.size(), points.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    EXPECT_NEAR(measured[i].above_road_m, points[i].z_m, kRoadNoise_m);
  }
}

TEST(MeasureAboveRoad, BearsPointsFarOutAndThoseThatAreNone) {
  auto points = sloping_road(0.0, 0.0, 0.0);
  const std::size_t count = points.size();
  for (const double far : {1e10, 1e30, 1e300, -1e300, HUGE_VAL, std::nan("")})
    for (const Point3& point : {Point3{far, 0.0, 1.0}, Point3{5.0, far, 1.0}, Point3{5.0, 0.0, far}})
      points.push_back(point);
  const auto measured = measure_above_road(points);
  ASSERT_EQ(measured.size(), points.size());
  for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(measured[i].above_road_m, 0.0, kRoadNoise_m);
}

TEST(MeasureAboveRoad, KeepsTheNominalGroundWithoutPoints) {
  EXPECT_TRUE(measure_above_road({}).empty());
  EXPECT_NEAR(measure_above_road(std::vector<Point3>{{10.0, 0.0, 1.0}})[0].above_road_m, 1.0, kExact);
}

LabelledObject post_at(double x_m, double y_m) {
  LabelledObject object;
  object.footprint = {x_m, y_m, 0.0, 1.0, 1.0};
  object.height_m = 1.65;
  return object;
}

TEST(MeasureVisibility, HalvesAtTheImageBorder) {
  const auto camera = level_camera();
  FrameTruth truth;
  // The left border is at y = 6/7 x; a thin post centred on it is half in view.
  truth.objects = {post_at(20.0, 0.0), post_at(21.0, 18.0), post_at(20.0, 30.0)};
  truth.objects[1].footprint.length_m = truth.objects[1].footprint.width_m = 0.01;
  truth.lidar = {{{19.5, 0.0, 1.0}, 1.0}, {{19.5, 0.0, 0.1}, 0.1}, {{18.0, 0.0, 1.0}, 1.0}};
  measure_visibility(camera, truth);
  EXPECT_NEAR(truth.objects[0].in_view_fraction, 1.0, kExact);
  EXPECT_NEAR(truth.objects[1].in_view_fraction, 0.5, 0.01);
  EXPECT_EQ(truth.objects[2].in_view_fraction, 0.0);
  EXPECT_EQ(truth.objects[0].lidar_points, 1);  // neither the road before it nor the point 1.5 m nearer
}

TEST(FreeFraction, FallsBehindNearerObjects) {
  const auto camera = level_camera();
  FrameTruth truth;
  truth.objects = {post_at(10.0, 0.0), post_at(20.0, 0.0), post_at(20.0, 8.0)};
  EXPECT_EQ(free_fraction(camera, truth, truth.objects[0]), 1.0);
  EXPECT_EQ(free_fraction(camera, truth, truth.objects[1]), 0.0);
  EXPECT_EQ(free_fraction(camera, truth, truth.objects[2]), 1.0);
}

TEST(ReadKittiObject, PlacesLabelsBesideTheLeftColourCamera) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "flies_eval_kitti_object";
  std::filesystem::create_directories(folder / "calib");
  std::filesystem::create_directories(folder / "label_2");
  // Camera 2 sits 0.06 m to the left of camera 0: P2 = K [I | (0.06, 0, 0)].
  std::ofstream(folder / "calib" / "000001.txt") << "P2: 700 0 600 42 0 700 180 0 0 0 1 0\n"
                                                    "R0_rect: 1 0 0 0 1 0 0 0 1\n"
                                                    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";
  std::ofstream(folder / "label_2" / "000001.txt")
      << "Car 0.00 0 0 0 0 1 1 1.5 1.6 4.0 1.00 1.65 20.00 -1.57079632679\n"
         "Car 0.00 2 0 0 0 1 1 1.5 1.6 4.0 -3.00 1.65 20.00 0.0\n";
  const FrameTruth truth = read_kitti_object(folder, "000001", level_camera());
  ASSERT_EQ(truth.objects.size(), 2u);
  EXPECT_EQ(truth.frame, 1);
  EXPECT_NEAR(truth.objects[0].footprint.x_m, 20.0, kExact);
  EXPECT_NEAR(truth.objects[0].footprint.y_m, -1.06, kExact);
  EXPECT_NEAR(truth.objects[0].footprint.yaw_rad, 0.0, 1e-6);  // faces ahead
  EXPECT_NEAR(truth.objects[0].bottom_z_m, 0.0, kExact);
  EXPECT_TRUE(truth.objects[0].visible);
  EXPECT_NEAR(truth.objects[1].footprint.yaw_rad, -std::numbers::pi / 2, 1e-6);  // faces right
  EXPECT_FALSE(truth.objects[1].visible);                                        // labelled largely occluded
  EXPECT_THROW(read_kitti_object(folder, "000002", level_camera()), InputError);
  StereoCamera without_size = level_camera();
  without_size.width_px = 0;
  EXPECT_THROW(read_kitti_object(folder, "000001", without_size), InputError);
}

/// As Windows programs write it: with a mark, in units of two bytes.
std::string utf16(const std::string& text) {
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += std::string{c, '\0'};
  return wide;
}

TEST(ReadersOfTruth, BearMarksWideLettersBlanksAndComments) {
  const std::string label = "Car 0 0 -10 100 50 200 150 1.5 1.6 3.9 1 1.6 20 0.1\r\n";
  for (const auto& text : {"\xEF\xBB\xBF" + label, "# one\r\n\r\n  " + label, utf16(label)}) {
    const auto labels = parse_labels(text, "a.txt");
    ASSERT_EQ(labels.size(), 1U);
    EXPECT_EQ(labels[0].type, "Car");
  }
  const std::string scene = R"({"objects": []})";
  for (const auto& text : {"\xEF\xBB\xBF" + scene, "// drawn\n" + scene, utf16(scene)})
    EXPECT_TRUE(parse_scene_truth(text, "a.json").objects.empty());
  std::string tracklets = "<boost_serialization><tracklets></tracklets></boost_serialization>";
  for (const auto& text : {"\xEF\xBB\xBF" + tracklets, utf16(tracklets)})
    EXPECT_TRUE(parse_tracklets(text, "a.xml").empty());
}

}  // namespace
}  // namespace flies
