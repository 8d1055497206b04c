#pragma once

#include <vector>

#include "flies/core/results.hpp"
#include "flies/core/stereo_camera.hpp"

namespace flies {

/// What detectors say that look at one image alone.
struct PeopleSearch {
  std::vector<Pedestrian> people;  ///< nearest first
  double time_ms = 0.0;            ///< of the search, without the suppression of doubles
};

/// A person in a box of the left image, head to feet. The box has no range of its own: he is put where a person of 1.7
/// m looks as high.
/// @param probability 0..1
Pedestrian person_in_box(const ImageBox& box, double probability, const Projection& projection);

/// Of two people whose boxes' intersection over union is larger than `max_overlap` the surer; nearest first.
std::vector<Pedestrian> keep_surest(std::vector<Pedestrian> people, double max_overlap);

}  // namespace flies
