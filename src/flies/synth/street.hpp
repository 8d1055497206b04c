#pragma once

#include <cstdint>
#include <vector>

#include "flies/synth/scene.hpp"

namespace flies::synth {

/// Random streams of the scene, one per kind of thing, so that asking for one more car leaves the people as they are.
inline constexpr std::uint32_t kPeoplePurpose = 101;
inline constexpr std::uint32_t kCarsPurpose = 102;
inline constexpr std::uint32_t kPolesPurpose = 103;
inline constexpr std::uint32_t kTreesPurpose = 104;
inline constexpr std::uint32_t kHousesPurpose = 105;
inline constexpr std::uint32_t kMoversPurpose = 106;
inline constexpr std::uint32_t kThingsPurpose = 107;
inline constexpr std::uint32_t kShelvesPurpose = 108;

/// The kerbs of the street, right and left of the lane in whose middle the camera drives (y = 0), and their height.
inline constexpr float kKerbRight_m = -3.8F, kKerbLeft_m = 7.1F, kKerbHeight_m = 0.15F;

/// Puts a mesh made around its own origin into the scene and measures it.
SceneObject stand(ObjectClass kind, const Mesh& mesh, const Placement& placement);

/// A mesh that is seen but stands nowhere: ground and backdrop.
SceneObject scenery(Mesh mesh, ObjectClass kind = ObjectClass::ground);

/// Road between kerbs, pavements, houses on both sides, and the cars, poles, trees and people asked for. With
/// `SceneKind::crossing` a zebra crossing lies across the road and half the people walk on it.
std::vector<SceneObject> street(const SceneOptions& options);

/// The same street without people and with parked cars only. One of them stands before the place, at `crossing_x_m`,
/// where somebody steps onto the road from the right; nothing else stands on his way.
std::vector<SceneObject> standing_street(const SceneOptions& options, float crossing_x_m);

/// Road with lane markings between flat verges; nothing stands on it.
std::vector<SceneObject> country_road(const SceneOptions& options);

}  // namespace flies::synth
