#include "flies/synth/bicycle.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace flies::synth {
namespace {

constexpr float kWheelRadius_m = 0.34F, kWheel_m = 0.54F;  ///< size, and where it stands from the middle
constexpr float kPedals_m = 0.14F;                         ///< the lower foot over the ground
constexpr Vec3 kLeft{0, 1, 0};

Mesh wheel(float x_m, const Material& tyre, const Material& spokes) {
  constexpr int kSegments = 24;
  std::vector<LimbPoint> rim;
  for (int i = 0; i <= kSegments; ++i) {
    const float angle_rad = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / kSegments;
    rim.push_back({{x_m + (kWheelRadius_m - 0.02F) * std::sin(angle_rad), 0.0F,
                    kWheelRadius_m - (kWheelRadius_m - 0.02F) * std::cos(angle_rad)},
                   0.018F,
                   0.02F});
  }
  Mesh mesh = limb(rim, kLeft, tyre, 8);
  for (int i = 0; i < 5; ++i) {
    const float angle_rad = std::numbers::pi_v<float> * static_cast<float>(i) / 5.0F;
    const Vec3 hub{x_m, 0.0F, kWheelRadius_m};
    const Vec3 out{0.32F * std::sin(angle_rad), 0.0F, 0.32F * std::cos(angle_rad)};
    mesh.add(cylinder(hub - out, hub + out, 0.004F, spokes, 6));
  }
  return mesh;
}

}  // namespace

Mesh cyclist(const PersonLook& look) {
  const Material& paint = look.bag;
  const Vec3 pedals{-0.08F, 0, 0.28F}, saddle{-0.22F, 0, 0.86F}, head{0.36F, 0, 0.84F}, rear{-kWheel_m, 0, 0.34F},
      front{kWheel_m, 0, 0.34F}, bar{0.33F, 0, 1.0F};
  Mesh mesh = wheel(-kWheel_m, look.shoes, look.hair);
  mesh.add(wheel(kWheel_m, look.shoes, look.hair));
  for (const auto& [from, to] :
       {std::pair{pedals, saddle}, std::pair{pedals, head}, std::pair{saddle, head}, std::pair{pedals, rear},
        std::pair{saddle, rear}, std::pair{head, front}, std::pair{head, bar}})
    mesh.add(cylinder(from, to, 0.018F, paint, 8));
  mesh.add(cylinder(bar - kLeft * 0.28F, bar + kLeft * 0.28F, 0.014F, look.hair, 8));
  mesh.add(box(saddle + Vec3{-0.13F, -0.07F, 0}, saddle + Vec3{0.13F, 0.07F, 0.05F}, look.hair));
  mesh.add(placed(person(look), {{-0.08F, 0, kPedals_m}, 0.0F}));
  return mesh;
}

}  // namespace flies::synth
