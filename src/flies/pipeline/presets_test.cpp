#include <gtest/gtest.h>

#include <cmath>

#include "flies/classify/people_classifier.hpp"
#include "flies/pipeline/detector.hpp"

namespace flies {
namespace {

TEST(PresetPeopleModel, IsWhatThePresetsClassifierIsMadeOf) {
  EXPECT_EQ(preset_people_model(Preset::paper), "flies-48x96-linear");
  EXPECT_EQ(preset_people_model(Preset::robot), "flies-48x96-network");
}

TEST(PresetClassifier, IsTheLinearMachineForThePaper) {
  EXPECT_FALSE(preset_classifier(Preset::paper)->looks_twice());
  EXPECT_TRUE(preset_classifier(Preset::standard)->looks_twice());
  EXPECT_EQ(preset_classifier(Preset::standard), default_people_classifier());
}

constexpr auto kPresets = {Preset::standard, Preset::paper, Preset::robot, Preset::handheld};

TEST(PresetOptions, KeepTheDeclaredRanges) {
  for (const auto preset : kPresets) EXPECT_NO_THROW(check_detector_options(preset_options(preset), "preset"));
}

StereoCamera kitti_camera() {
  return {.fx_px = 721.5,
          .fy_px = 721.5,
          .cx_px = 609.6,
          .cx_right_px = 609.6,
          .cy_px = 172.9,
          .baseline_m = 0.5372,
          .width_px = 1242,
          .height_px = 375,
          .mount = {}};
}

TEST(FittedOptions, LeaveACarsCameraAlone) {
  const auto fitted = list_options(fitted_options(kitti_camera(), {})), standard = list_options(DetectorOptions{});
  ASSERT_EQ(fitted.size(), standard.size());
  for (std::size_t i = 0; i < standard.size(); ++i) EXPECT_EQ(fitted[i].value, standard[i].value) << standard[i].path;
}

TEST(FittedOptions, LookNearerWhereTheRoadIsNearer) {
  StereoCamera low = kitti_camera();
  low.mount = {.height_m = 0.3, .pitch_rad = radians(10)};
  low.baseline_m = 0.12;
  const DetectorOptions fitted = fitted_options(low, {});
  const double road_m = 0.3 / std::tan(radians(10) + std::atan((374 - 172.9) / 721.5));
  EXPECT_LT(fitted.field.x_min_m, road_m);
  EXPECT_LT(fitted.scan.x_min_m, road_m);
  EXPECT_NEAR(fitted.road.x_min_m, road_m, 1e-9);
  EXPECT_LT(fitted.road.x_max_m, 10.0);
  EXPECT_GT(fitted.evolve.flies, DetectorOptions{}.evolve.flies);
}

TEST(FittedOptions, EndWhereRangesGetUnsure) {
  StereoCamera narrow = kitti_camera();
  narrow.baseline_m = 0.05;
  const DetectorOptions fitted = fitted_options(narrow, {});
  EXPECT_LT(fitted.field.x_max_m, 20.0);
  EXPECT_NEAR(range_deviation_m(narrow, fitted.field.x_max_m) / fitted.field.x_max_m, 0.15, 1e-6);
}

TEST(FittedOptions, DoNotLookWhereOnlyOneCameraSees) {
  StereoCamera wide = kitti_camera();
  wide.baseline_m = 2.0;
  EXPECT_GT(fitted_options(wide, preset_options(Preset::robot)).field.x_min_m, 2.0);
}

TEST(FittedOptions, LookAtADronesOwnHeight) {
  StereoCamera drone = kitti_camera();
  drone.width_px = 640;
  drone.height_px = 480;
  drone.cy_px = 240.0;
  drone.fx_px = drone.fy_px = 450.0;
  drone.mount = {.height_m = 7.0};
  const DetectorOptions handheld = preset_options(Preset::handheld);
  const DetectorOptions fitted = fitted_options(drone, handheld);
  EXPECT_DOUBLE_EQ(0.5 * (fitted.field.z_min_m + fitted.field.z_max_m), 7.0);
  EXPECT_DOUBLE_EQ(fitted.field.z_max_m - fitted.field.z_min_m, handheld.field.z_max_m - handheld.field.z_min_m);
  EXPECT_DOUBLE_EQ(0.5 * (fitted.scan.z_min_m + fitted.scan.z_max_m), 7.0);

  drone.mount.pitch_rad = radians(45);  // sees the ground below it
  EXPECT_EQ(fitted_options(drone, handheld).field.z_max_m, handheld.field.z_max_m);
  StereoCamera mast = kitti_camera();  // a car's field begins where a mast sees the road
  mast.mount = {.height_m = 3.0, .pitch_rad = radians(10)};
  EXPECT_EQ(fitted_options(mast, {}).field.z_max_m, DetectorOptions{}.field.z_max_m);
}

TEST(FittedOptions, KeepTheNearEndWhereNoRoadIsInView) {
  StereoCamera up = kitti_camera(), unsized = kitti_camera();
  up.baseline_m = unsized.baseline_m = 0.06;
  up.mount = {.height_m = 0.4, .pitch_rad = radians(-25)};
  unsized.width_px = unsized.height_px = 0;
  const DetectorOptions robot = preset_options(Preset::robot);
  for (const auto& camera : {up, unsized}) {
    const DetectorOptions fitted = fitted_options(camera, robot);
    EXPECT_EQ(fitted.field.x_min_m, robot.field.x_min_m);
    EXPECT_EQ(fitted.scan.x_min_m, robot.scan.x_min_m);
    EXPECT_NEAR(fitted_options(camera, {}).field.x_max_m, range_of_deviation_m(camera, 0.15), 1e-9);
  }
}

TEST(FittedOptions, LookAsFarToTheSidesAsTheCamera) {
  StereoCamera wide = kitti_camera();
  wide.fx_px = wide.fy_px = 400.0;
  const ConcentrateOptions fitted = fitted_options(wide, {}).concentrate;
  EXPECT_NEAR(fitted.half_field_deg, degrees(std::atan(631.4 / 400.0)) + 0.25 * fitted.view_angle_deg,
              0.25 * fitted.view_angle_deg);
  EXPECT_EQ(fitted_options(kitti_camera(), {}).concentrate.half_field_deg, 45.0);
}

TEST(FittedOptions, KeepTheDeclaredRangesForAnyCamera) {
  for (const auto preset : kPresets)
    for (const double focal_px : {100.0, 700.0, 5000.0})
      for (const double baseline_m : {0.01, 0.1, 1.0, 10.0})
        for (const double height_m : {0.05, 0.3, 3.0, 100.0})
          for (const double pitch_deg : {-45.0, 0.0, 45.0})
            for (const int size_px : {0, 1, 2000}) {
              StereoCamera camera = kitti_camera();
              camera.fx_px = camera.fy_px = focal_px;
              camera.baseline_m = baseline_m;
              camera.mount = {height_m, radians(pitch_deg), 0.0};
              camera.width_px = camera.height_px = size_px;
              EXPECT_NO_THROW(check_detector_options(fitted_options(camera, preset_options(preset)), "fitted"))
                  << focal_px << ' ' << baseline_m << ' ' << height_m << ' ' << pitch_deg << ' ' << size_px;
            }
}

TEST(PresetOptions, PaperIsThePapers) {
  const auto paper = preset_options(Preset::paper);
  EXPECT_EQ(paper.fitness.function, FitnessFunction::covariance);
  EXPECT_EQ(paper.evolve.flies, 3000);
  EXPECT_EQ(paper.evolve.generations, 3);
  EXPECT_FALSE(paper.evolve.uniqueness.enforce);
  EXPECT_FALSE(paper.road.estimate);
  EXPECT_FALSE(paper.concentrate.assemble.merge);
}

}  // namespace
}  // namespace flies
