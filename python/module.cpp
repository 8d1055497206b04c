#include "module.hpp"

#include <cstddef>
#include <exception>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/version.hpp"
#include "text.hpp"

namespace py = pybind11;

namespace {

PyObject* input_error_type = nullptr;  // lives as long as the process

void raise_input_error(std::exception_ptr exception) {
  try {
    std::rethrow_exception(std::move(exception));
  } catch (const flies::InputError& error) {
    PyErr_SetObject(input_error_type, sentence_str(error.what()).ptr());
  }
}

/// pybind11 gives an object that was made by __new__, without __init__, raw memory when something is asked of it. Where
/// that would come from, it is refused.
void refuse_empty_objects(const py::module_& module) {
  for (const auto& item : module.attr("__dict__").cast<py::dict>()) {
    if (!py::isinstance<py::type>(item.second)) continue;
    auto* const type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(item.second.ptr()));
    if (type == nullptr) continue;
    type->operator_new = [](std::size_t /*bytes*/) -> void* {
      throw py::type_error("an object of flies was made by __new__ alone and holds nothing: __init__ was not called");
    };
  }
}

}  // namespace

PYBIND11_MODULE(_flies, module) {
  module.doc() = "The compiled part of the package flies.";
  module.attr("__version__") = FLIES_VERSION;
  // Classes and functions belong to the package: so help, error messages and pickles say where they are found.
  const py::object own_name = module.attr("__name__");
  module.attr("__name__") = "flies";
  auto& input_error = py::register_exception<flies::InputError>(module, "InputError", PyExc_ValueError);
  input_error.doc() =
      "A fault of the input: a file, an image, a calibration, an option. Its text is one line that names the source\n"
      "and the field, what was found and what is allowed; the command `flies` prints the same.";
  input_error_type = input_error.inc_ref().ptr();
  py::register_exception_translator(&raise_input_error);
  // In this order, so that signatures name the classes they take.
  bind_camera(module);
  bind_scan(module);
  bind_results(module);
  bind_tracks(module);
  bind_pipeline(module);
  refuse_empty_objects(module);
  module.attr("__name__") = own_name;
}
