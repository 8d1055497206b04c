#pragma once

#include <vector>

#include "flies/synth/scene.hpp"

namespace flies::synth {

/// A room 4 to 8 m deep: walls with pictures, ceiling, and on its floor tables, chairs, cupboards, boxes, lamps,
/// people.
std::vector<SceneObject> room(const SceneOptions& options);

/// The aisle of a store, 2 to 2.8 m wide between racks, closed by a wall 14 to 18 m ahead: pallets, cartons, people.
std::vector<SceneObject> aisle(const SceneOptions& options);

/// Tall trees whose trunks and crowns stand 5 to 25 m ahead, on open ground.
std::vector<SceneObject> woods(const SceneOptions& options);

/// Asphalt between kerbs with a pavement and houses to the left and a hedge to the right; a traffic island, cartons
/// from 5 cm on, bollards, tables and chairs, people.
std::vector<SceneObject> pavement(const SceneOptions& options);

}  // namespace flies::synth
