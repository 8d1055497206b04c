#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

/// @throws ValueError in Python when a pickle is not of so many values: of another version, most likely
inline void check_pickle(const pybind11::tuple& state, std::size_t expected) {
  if (state.size() != expected)
    throw pybind11::value_error(fmt::format("the pickle holds {} values, expected {}: was it made by another version?",
                                            state.size(), expected));
}

/// For `class_::def`: pickles and copies hold these members, in this order.
template <class T, auto... members>
auto pickled() {
  return pybind11::pickle(
      [](const T& value) { return pybind11::make_tuple(value.*members...); },
      [](const pybind11::tuple& state) {
        check_pickle(state, sizeof...(members));
        T value;
        std::size_t i = 0;
        ((value.*members = state[i++].template cast<std::remove_cvref_t<decltype(value.*members)>>()), ...);
        return value;
      });
}

/// @param what cannot be done, for errors, which say what to do instead
template <class... Class>
void refuse_pickles(pybind11::class_<Class...>& bound, const std::string& what, const std::string& instead) {
  const std::string name = pybind11::str(bound.attr("__name__"));
  bound.def("__reduce_ex__",
            [text = fmt::format("a flies.{} cannot be {}: {}", name, what, instead)](
                const pybind11::object& /*self*/, int /*protocol*/) -> pybind11::object {
              throw pybind11::type_error(text);
            });
}
/// Of what has copies of its own; they are the thing itself where it never changes.
template <class... Class>
void cannot_be_pickled(pybind11::class_<Class...>& bound, const std::string& instead) {
  refuse_pickles(bound, "pickled", instead);
}
/// Python copies by pickles.
template <class... Class>
void cannot_be_copied_or_pickled(pybind11::class_<Class...>& bound, const std::string& instead) {
  refuse_pickles(bound, "copied or pickled", instead);
}
template <class... Class>
void is_its_own_copy(pybind11::class_<Class...>& bound) {
  bound.def("__copy__", [](const pybind11::object& self) { return self; });
  bound.def("__deepcopy__", [](const pybind11::object& self, const pybind11::object& /*memo*/) { return self; });
}
