#include "options.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "flies/core/error.hpp"
#include "flies/core/options.hpp"

namespace py = pybind11;

namespace {

constexpr const char* kSource = "options";

using Settings = std::vector<std::pair<std::string, std::string>>;

/// Options nest three deep: a mapping that holds itself comes to an end, too.
constexpr std::ptrdiff_t kDeepest = 20;

bool is_array_of_one(const py::handle& value) {
  return py::isinstance<py::array>(value) && py::reinterpret_borrow<py::array>(value).ndim() == 0;
}

void refuse_twice(Settings settings) {
  std::ranges::sort(settings);
  const auto same_path = [](const auto& a, const auto& b) { return a.first == b.first; };
  const auto twice = std::ranges::adjacent_find(settings, same_path);
  if (twice != settings.end())
    throw flies::InputError(kSource, twice->first,
                            fmt::format("is given twice, as {} and as {}", twice->second, std::next(twice)->second));
}

/// As it would be written on a command line.
std::string value_text(const py::object& given, const std::string& path) {
  const py::object value = is_array_of_one(given) ? py::object(given.attr("item")()) : given;
  if (is_array_of_one(value))  // it may hold itself
    throw flies::InputError(kSource, path, "found an array in an array, expected a number, a bool or a name");
  if (py::isinstance<py::bool_>(value) || py::isinstance(value, py::module_::import("numpy").attr("bool_")))
    return py::bool_(value) ? "true" : "false";
  if (value.is_none() || py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value))
    throw flies::InputError(kSource, path,
                            "found " + std::string(py::str(value)) + ", expected a number, a bool or a name");
  return py::str(value);
}

void flatten(const py::object& options, const std::string& prefix, Settings& settings) {
  if (std::ranges::count(prefix, '.') > kDeepest)
    throw flies::InputError(kSource, "", "mappings are nested too deeply");
  for (const auto& item : options.attr("items")()) {
    const auto [key, value] = item.cast<std::pair<py::object, py::object>>();
    if (!py::isinstance<py::str>(key))
      throw flies::InputError(kSource, prefix, "found the key " + std::string(py::str(key)) + ", expected a name");
    const std::string path = prefix + std::string(py::str(key));
    if (is_mapping(value.ptr()))
      flatten(value, path + ".", settings);
    else
      settings.emplace_back(path, value_text(value, path));
  }
}

}  // namespace

bool is_mapping(PyObject* object) {
  return PyDict_Check(object) != 0 || py::isinstance(object, py::module_::import("collections.abc").attr("Mapping"));
}

PythonOptions python_options(const flies::StereoCamera& camera, const std::string& preset,
                             const OptionsMapping& options, bool may_follow) {
  PythonOptions result;
  const flies::Preset named = flies::preset_named(preset, "arguments");
  result.detector = flies::preset_options(named);
  if (named != flies::Preset::paper) result.detector = flies::fitted_options(camera, result.detector);
  Settings settings;
  flatten(options, "", settings);
  refuse_twice(settings);
  for (const auto& [path, text] : settings)
    if (may_follow && flies::is_tracker_option(path))
      flies::set_option(result.following, path, text, kSource);
    else
      flies::set_option(result.detector, path, text, kSource);
  flies::check_detector_options(result.detector, kSource);
  return result;
}
