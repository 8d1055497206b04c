#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "flies/core/free_space.hpp"
#include "flies/core/scan.hpp"
#include "module.hpp"
#include "pickles.hpp"

namespace py = pybind11;

namespace {

/// The vector's memory as a numpy array, shape (n,), that cannot be written to and keeps its owner alive.
py::array borrowed(const std::vector<double>& values, const py::object& owner) {
  py::array_t<double> array(static_cast<py::ssize_t>(values.size()), values.data(), owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

template <std::vector<double> flies::Scan::*values>
py::array borrow(const py::object& self) {
  return borrowed(self.cast<const flies::Scan&>().*values, self);
}

py::array_t<std::uint8_t> states_of(const flies::Scan& scan) {
  py::array_t<std::uint8_t> states(static_cast<py::ssize_t>(scan.size()));
  std::ranges::transform(scan.states, states.mutable_data(),
                         [](flies::SectorState state) { return static_cast<std::uint8_t>(state); });
  return states;
}

py::array_t<double> angles_of(const flies::Scan& scan) {
  py::array_t<double> angles(static_cast<py::ssize_t>(scan.size()));
  for (std::size_t i = 0; i < scan.size(); ++i) angles.mutable_data()[i] = scan.angle_rad(i);
  return angles;
}

py::array_t<double> free_space_of(const flies::Scan& scan) {
  const auto polygon = flies::free_space(scan);
  py::array_t<double> points({static_cast<py::ssize_t>(polygon.size()), py::ssize_t{2}});
  auto at = points.mutable_unchecked<2>();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    at(static_cast<py::ssize_t>(i), 0) = polygon[i].x_m;
    at(static_cast<py::ssize_t>(i), 1) = polygon[i].y_m;
  }
  return points;
}

flies::Scan scan_of(const py::tuple& state) {
  check_pickle(state, 6);
  flies::Scan scan;
  scan.angle_min_rad = state[0].cast<double>();
  scan.angle_increment_rad = state[1].cast<double>();
  scan.ranges_m = state[2].cast<std::vector<double>>();
  scan.free_m = state[3].cast<std::vector<double>>();
  scan.confidence = state[4].cast<std::vector<double>>();
  for (const int index : state[5].cast<std::vector<int>>()) {
    if (index < 0 || index > static_cast<int>(flies::SectorState::unknown))
      throw py::value_error("the pickle has a state that no sector has");
    scan.states.push_back(static_cast<flies::SectorState>(index));
  }
  for (const auto* values : {&scan.ranges_m, &scan.free_m, &scan.confidence})
    if (values->size() != scan.size()) throw py::value_error("the pickle has not all numbers of every sector");
  return scan;
}

}  // namespace

void bind_scan(py::module_& module) {
  using flies::Scan;
  auto scan = py::class_<Scan>(
      module, "Scan",
      "What a laser scanner on the left camera would have measured: one entry a sector in every array, all of shape\n"
      "(n,). Sectors run from right to left; angles are radians from straight ahead, positive to the left.\n"
      "`ranges_m`, `free_m` and `confidence` are views that cannot be written to and keep the scan alive; "
      "`angles_rad`,\n"
      "`states` and `free_space()` are made anew at every call.");
  scan.attr("OBSTACLE") = static_cast<int>(flies::SectorState::obstacle);
  scan.attr("FREE") = static_cast<int>(flies::SectorState::free);
  scan.attr("UNKNOWN") = static_cast<int>(flies::SectorState::unknown);
  scan.def_readonly("angle_min_rad", &Scan::angle_min_rad, "Middle of the first sector, the rightmost, radians.")
      .def_readonly("angle_increment_rad", &Scan::angle_increment_rad,
                    "From one sector to the next, and their width, radians.")
      .def_property_readonly("angles_rad", &angles_of, "Middles of the sectors, radians, shape (n,).")
      .def_property_readonly("ranges_m", &borrow<&Scan::ranges_m>,
                             "Range of the nearest obstacle, metres, shape (n,); NaN where there is none.")
      .def_property_readonly("free_m", &borrow<&Scan::free_m>,
                             "Range up to which the ground was seen free, metres, shape (n,); 0 where none was.")
      .def_property_readonly("confidence", &borrow<&Scan::confidence>, "Of the state, 0 to 1, shape (n,).")
      .def_property_readonly(
          "states", &states_of,
          "OBSTACLE, FREE or UNKNOWN of each sector, uint8, shape (n,). Unknown is neither free nor\n"
          "an obstacle.")
      .def("free_space", &free_space_of,
           "The ground that was seen free as a polygon, float64, shape (m, 2): x forward and y left in metres.")
      .def("__len__", &Scan::size)
      .def(py::pickle(
          [](const Scan& s) {
            std::vector<int> states;
            for (const auto state : s.states) states.push_back(static_cast<int>(state));
            return py::make_tuple(s.angle_min_rad, s.angle_increment_rad, s.ranges_m, s.free_m, s.confidence, states);
          },
          &scan_of))
      .def("__repr__", [](const Scan& s) {
        return fmt::format("<flies.Scan {} sectors of {:.4f} rad, {} with an obstacle, {} unknown>", s.size(),
                           s.angle_increment_rad, std::ranges::count(s.states, flies::SectorState::obstacle),
                           std::ranges::count(s.states, flies::SectorState::unknown));
      });
}
