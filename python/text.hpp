#pragma once

#include <pybind11/pybind11.h>

#include <string>

/// A path as `open` takes it: str, bytes or os.PathLike, by the bytes that the system knows it by.
struct PathArgument {
  std::string text;
};

/// The path as str: names that are not UTF-8 survive the way to Python and back.
inline pybind11::str path_str(const std::string& path) {
  PyObject* text = PyUnicode_DecodeFSDefaultAndSize(path.data(), static_cast<Py_ssize_t>(path.size()));
  if (text == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::str>(text);
}

/// A sentence to print, which may name files: bytes that are not UTF-8 are written as `\xff`.
inline pybind11::str sentence_str(const std::string& sentence) {
  PyObject* text = PyUnicode_DecodeUTF8(sentence.data(), static_cast<Py_ssize_t>(sentence.size()), "backslashreplace");
  if (text == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::str>(text);
}

namespace pybind11::detail {

template <>
struct type_caster<PathArgument> {
  PYBIND11_TYPE_CASTER(PathArgument, const_name("Union[str, bytes, os.PathLike]"));

  bool load(handle source, bool /*convert*/) {
    PyObject* path = nullptr;
    if (PyUnicode_FSConverter(source.ptr(), &path) == 0) {
      if (PyErr_ExceptionMatches(PyExc_TypeError) == 0) throw error_already_set();  // a NUL in it, as `open` says
      PyErr_Clear();
      return false;
    }
    value.text = reinterpret_steal<bytes>(path);
    return true;
  }
};

}  // namespace pybind11::detail
