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

/// Pickles say what to do instead; copies of what never changes are the thing itself.
template <class... Class>
void cannot_be_pickled(pybind11::class_<Class...>& bound, const std::string& instead) {
  const std::string name = pybind11::str(bound.attr("__name__"));
  bound.def("__reduce_ex__",
            [text = fmt::format("a flies.{} cannot be copied or pickled: {}", name, instead)](
                const pybind11::object& /*self*/, int /*protocol*/) -> pybind11::object {
              throw pybind11::type_error(text);
            });
}
template <class... Class>
void is_its_own_copy(pybind11::class_<Class...>& bound) {
  bound.def("__copy__", [](const pybind11::object& self) { return self; });
  bound.def("__deepcopy__", [](const pybind11::object& self, const pybind11::object& /*memo*/) { return self; });
}
