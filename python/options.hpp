#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

#include "flies/pipeline/tracker.hpp"

/// Options of the method and of following, as Python gives them.
struct PythonOptions {
  flies::DetectorOptions detector;
  flies::TrackerOptions following;
};

/// The preset, made for the camera (not `paper`), overruled by a dict: dotted names (`{"evolve.flies": 3000}`), nested
/// ones (`{"evolve": {"flies": 3000}}`) or both. Names below `ego` and `track` are those of following.
/// @param may_follow false: those are unknown
/// @throws InputError on an unknown preset or option (with the nearest known one) or a value that is not allowed
PythonOptions python_options(const flies::StereoCamera& camera, const std::string& preset,
                             const pybind11::dict& options, bool may_follow);
