#pragma once

#include <optional>
#include <span>
#include <vector>

#include "flies/core/ground_point.hpp"
#include "flies/core/results.hpp"

namespace flies {

/// For each of the people the obstacle that he is: the one whose middle is nearest to him, and near enough. No obstacle
/// is two people; who stands before a wall, or is no obstacle of his own, has none.
/// @returns one index into `obstacles` per person
std::vector<std::optional<std::size_t>> obstacles_of_people(std::span<const Obstacle> obstacles,
                                                            std::span<const Pedestrian> people);

/// The middle of an obstacle, at the range of its near face, vehicle frame.
GroundPoint middle_of(const Obstacle& obstacle);

}  // namespace flies
