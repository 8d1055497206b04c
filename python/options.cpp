#include "options.hpp"

#include <pybind11/pybind11.h>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"

namespace py = pybind11;

namespace {

constexpr const char* kSource = "options";

using Settings = std::vector<std::pair<std::string, std::string>>;

/// As it would be written on a command line.
std::string value_text(const py::handle& value, const std::string& path) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (value.is_none() || py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value))
    throw flies::InputError(kSource, path,
                            "found " + std::string(py::str(value)) + ", expected a number, a bool or a name");
  return py::str(value);
}

void flatten(const py::dict& options, const std::string& prefix, Settings& settings) {
  for (const auto& [key, value] : options) {
    if (!py::isinstance<py::str>(key))
      throw flies::InputError(kSource, prefix, "found the key " + std::string(py::str(key)) + ", expected a name");
    const std::string path = prefix + std::string(py::str(key));
    if (py::isinstance<py::dict>(value))
      flatten(py::reinterpret_borrow<py::dict>(value), path + ".", settings);
    else
      settings.emplace_back(path, value_text(value, path));
  }
}

bool is_of_following(const std::string& path) { return path.starts_with("ego.") || path.starts_with("track."); }

}  // namespace

PythonOptions python_options(const flies::StereoCamera& camera, const std::string& preset, const py::dict& options,
                             bool may_follow) {
  PythonOptions result;
  const flies::Preset named = flies::preset_named(preset, "preset");
  result.detector = flies::preset_options(named);
  if (named != flies::Preset::paper) result.detector = flies::fitted_options(camera, result.detector);
  Settings settings;
  flatten(options, "", settings);
  for (const auto& [path, text] : settings)
    if (may_follow && is_of_following(path))
      flies::set_option(result.following, path, text, kSource);
    else
      flies::set_option(result.detector, path, text, kSource);
  flies::check_detector_options(result.detector, kSource);
  return result;
}
