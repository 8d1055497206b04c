#pragma once

#include <span>
#include <vector>

#include "flies/core/results.hpp"
#include "flies/core/road.hpp"
#include "flies/core/scan.hpp"
#include "flies/propose/propose.hpp"

namespace flies {

/// Stretches of the scan's surfaces that boxes of the obstacles do not cover: where few flies are, at the ends of
/// things wider than `max_lateral_m`, and before a thing that became one with what stands behind it.
/// @param scan of the same pair; empty: there are none
/// @returns from right to left, each as wide as boxes of one obstacle can be laid, as high as a person may be
std::vector<Obstacle> scan_stretches(std::span<const Obstacle> obstacles, const Scan& scan, const RoadPlane& road,
                                     const ProposeOptions& options);

}  // namespace flies
