#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

#include "flies/pipeline/tracker.hpp"

bool is_mapping(PyObject* object);

/// A dict or what else has names and values: any collections.abc.Mapping.
class OptionsMapping : public pybind11::object {
  PYBIND11_OBJECT_DEFAULT(OptionsMapping, object, is_mapping)
};

namespace pybind11::detail {
template <>
struct handle_type_name<OptionsMapping> {
  static constexpr auto name = const_name("Mapping[str, Any]");
};
}  // namespace pybind11::detail

/// Options of the method and of following, as Python gives them.
struct PythonOptions {
  flies::DetectorOptions detector;
  flies::TrackerOptions following;
};

/// The preset, made for the camera (not `paper`), overruled by a mapping: dotted names (`{"evolve.flies": 3000}`),
/// nested ones (`{"evolve": {"flies": 3000}}`) or both. Names below `ego` and `track` are those of following.
/// @param may_follow false: those are unknown
/// @throws InputError on an unknown preset or option (with the nearest known one) or a value that is not allowed
PythonOptions python_options(const flies::StereoCamera& camera, const std::string& preset,
                             const OptionsMapping& options, bool may_follow);
