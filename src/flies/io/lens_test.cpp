#include "flies/io/lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "flies/core/error.hpp"
#include "flies/io/formats/toy_rig.hpp"
#include "flies/io/rectifier.hpp"

namespace flies {
namespace {

constexpr double kExact = 1e-9;

const std::array<std::array<double, 3>, 4> kPoints = {
    {{0.0, 0.0, 2.0}, {0.7, -0.4, 1.0}, {-1.5, 0.3, 1.2}, {0.1, 1.1, 0.6}}};

RawCamera camera_of(Lens lens, std::vector<double> distortion) {
  return {{400, 0, 320, 0, 410, 240, 0, 0, 1}, std::move(distortion), lens};
}

void expect_same(const RawCamera& a, const RawCamera& b) {
  for (const auto& point : kPoints) {
    const auto first = project(a, point), second = project(b, point);
    ASSERT_TRUE(first && second);
    EXPECT_NEAR((*first)[0], (*second)[0], kExact);
    EXPECT_NEAR((*first)[1], (*second)[1], kExact);
  }
}

TEST(Lens, ModelsWithoutBendingArePinholes) {
  const auto pinhole = camera_of(Lens::brown, {0, 0, 0, 0});
  expect_same(camera_of(Lens::double_sphere, {0, 0}), pinhole);
  expect_same(camera_of(Lens::unified, {0, 1}), pinhole);
  expect_same(camera_of(Lens::mei, {0}), pinhole);
  expect_same(camera_of(Lens::fov, {0}), pinhole);
}

TEST(Lens, ModelsThatContainEachOtherAgree) {
  // One sphere at the centre is the unified model, and so is Mei's with xi = alpha / (1 - alpha) and its scale.
  constexpr double kAlpha = 0.6;
  expect_same(camera_of(Lens::double_sphere, {0, kAlpha}), camera_of(Lens::unified, {kAlpha, 1}));
  RawCamera mei = camera_of(Lens::mei, {kAlpha / (1 - kAlpha)});
  mei.matrix[0] /= 1 - kAlpha;
  mei.matrix[4] /= 1 - kAlpha;
  expect_same(mei, camera_of(Lens::unified, {kAlpha, 1}));
  expect_same(camera_of(Lens::mei, {0, -0.1, 0.02, 0.001, -0.002}),
              camera_of(Lens::brown, {-0.1, 0.02, 0.001, -0.002}));
}

TEST(Lens, FovBendsAnglesInProportion) {
  // In an ideal lens of this kind the radius is the angle over w.
  constexpr double kW = 0.9;
  for (const double angle : {0.2, 0.5, 0.9}) {
    const auto pixel = project(camera_of(Lens::fov, {kW}), {std::tan(angle), 0.0, 1.0});
    EXPECT_NEAR(((*pixel)[0] - 320) / 400, std::atan(2 * std::tan(angle) * std::tan(kW / 2)) / kW, kExact);
  }
}

TEST(Lens, DoubleSphereComesBackByItsClosedForm) {
  constexpr double kXi = -0.24, kAlpha = 0.57;
  for (const auto& point : kPoints) {
    const auto pixel = project(camera_of(Lens::double_sphere, {kXi, kAlpha}), point);
    const double x = ((*pixel)[0] - 320) / 400, y = ((*pixel)[1] - 240) / 410, r2 = x * x + y * y;
    const double z = (1 - kAlpha * kAlpha * r2) / (kAlpha * std::sqrt(1 - (2 * kAlpha - 1) * r2) + 1 - kAlpha);
    const double scale = (z * kXi + std::sqrt(z * z + (1 - kXi * kXi) * r2)) / (z * z + r2);
    const double length = std::hypot(point[0], point[1], point[2]);
    EXPECT_NEAR(scale * x, point[0] / length, kExact);
    EXPECT_NEAR(scale * y, point[1] / length, kExact);
    EXPECT_NEAR(scale * z - kXi, point[2] / length, kExact);
  }
}

TEST(Lens, AgreesWithOpenCv) {
  for (const auto& rig : {flies::testing::ToyRig(), flies::testing::ToyRig::fisheye()})
    for (const auto& [x, y, z] : kPoints) {
      const auto& m = rig.m1;
      const auto ours = project({{m(0, 0), 0, m(0, 2), 0, m(1, 1), m(1, 2), 0, 0, 1}, rig.d1, rig.lens}, {x, y, z});
      const auto theirs = rig.pixel({x, y, z}, false);
      EXPECT_NEAR((*ours)[0], theirs.x, 1e-6);
      EXPECT_NEAR((*ours)[1], theirs.y, 1e-6);
    }
}

TEST(Lens, DoesNotSeeWhatIsBehind) {
  EXPECT_FALSE(project(camera_of(Lens::brown, {0, 0, 0, 0}), {0.1, 0.1, -1.0}));
  EXPECT_FALSE(project(camera_of(Lens::double_sphere, {-0.24, 0.57}), {0.0, 0.1, -1.0}));
  EXPECT_FALSE(project(camera_of(Lens::mei, {0.5}), {0.0, 0.1, -1.0}));
  EXPECT_FALSE(project(camera_of(Lens::unified, {0.4, 1.0}), {0.0, 0.1, -1.0}));
}

TEST(Lens, SeesNothingWithoutItsCoefficients) {
  for (const Lens lens : {Lens::equidistant, Lens::double_sphere, Lens::unified, Lens::mei, Lens::fov}) {
    std::vector<double> few(least_coefficients(lens) - 1, 0.1);
    few.shrink_to_fit();
    const RawCamera camera = camera_of(lens, few);
    EXPECT_FALSE(project(camera, {0.1, 0.1, 1.0})) << lens_name(lens);
    const RawStereo raw{640, 480, camera, camera, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {-0.1, 0, 0}};
    EXPECT_THAT([&] { Rectifier(raw, "rig.yaml"); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("rig.yaml: distortion: found")))
        << lens_name(lens);
  }
  EXPECT_TRUE(project(camera_of(Lens::brown, {}), {0.1, 0.1, 1.0}));
}

}  // namespace
}  // namespace flies
