#include "module.hpp"

#include <exception>

#include "flies/core/error.hpp"
#include "flies/version.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_flies, module) {
  module.doc() = "The compiled part of the package flies.";
  module.attr("__version__") = FLIES_VERSION;
  auto& input_error = py::register_exception<flies::InputError>(module, "InputError", PyExc_ValueError);
  input_error.doc() =
      "A fault of the input: a file, an image, a calibration, an option. Its text is one line that names the source\n"
      "and the field, what was found and what is allowed; the command `flies` prints the same.";
  // In this order, so that signatures name the classes they take.
  bind_camera(module);
  bind_scan(module);
  bind_results(module);
  bind_tracks(module);
  bind_pipeline(module);
}
