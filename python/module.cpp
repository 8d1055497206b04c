#include "module.hpp"

#include <algorithm>
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

/// By pickles of protocols 0 and 1 Python makes an object of the base of all bound classes, of which pybind11 ends the
/// process. Protocol 2 knows how these classes are made, and its pickles may be written in older protocols.
void reduce_as_by_protocol_2(const py::module_& module) {
  for (const auto& item : module.attr("__dict__").cast<py::dict>()) {
    if (!py::isinstance<py::type>(item.second)) continue;
    const auto type = py::reinterpret_borrow<py::type>(item.second);
    if (py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(type.ptr())) == nullptr) continue;
    if (type.attr("__dict__").contains("__reduce_ex__")) continue;  // which refuses them
    type.attr("__reduce_ex__") = py::cpp_function(
        [](const py::object& self, int protocol) -> py::object {
          constexpr int kKnowsHowToMake = 2;
          const py::object base = py::module_::import("builtins").attr("object");
          return base.attr("__reduce_ex__")(self, std::max(protocol, kKnowsHowToMake));
        },
        py::name("__reduce_ex__"), py::is_method(type));
  }
}

/// What calling a class does, as pybind11 has it; of the base of all bound classes it would end the process.
PyObject* called_class(PyObject* type, PyObject* arguments, PyObject* named) {
  auto* const called = reinterpret_cast<PyTypeObject*>(type);
  if (!py::detail::all_type_info(called).empty()) return py::detail::pybind11_meta_call(type, arguments, named);
  PyErr_Format(PyExc_TypeError, "cannot create '%.200s' instances", called->tp_name);
  return nullptr;
}

void refuse_objects_of_the_base() { py::detail::get_internals().default_metaclass->tp_call = &called_class; }

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
  reduce_as_by_protocol_2(module);
  refuse_objects_of_the_base();
  module.attr("__name__") = own_name;
}
