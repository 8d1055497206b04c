#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "flies/core/people_obstacles.hpp"
#include "flies/core/results.hpp"
#include "flies/pipeline/detector.hpp"
#include "module.hpp"
#include "pickles.hpp"

namespace py = pybind11;

namespace {

/// A person with the index of the obstacle that he is, as the program's JSON has it.
struct NumberedPedestrian : flies::Pedestrian {
  std::optional<std::size_t> obstacle;
};

std::vector<NumberedPedestrian> people_of(const flies::Detection& detection) {
  const auto own = flies::obstacles_of_people(detection.obstacles, detection.pedestrians);
  std::vector<NumberedPedestrian> people;
  for (std::size_t i = 0; i < own.size(); ++i) people.push_back({detection.pedestrians[i], own[i]});
  return people;
}

/// Rows of the arrays: all attributes of the objects, under their names; the box by its four numbers.
struct ObstacleRow {
  double x_m, y_m, range_m, range_sd_m, width_m, middle_offset_m, depth_m, height_m, ground_z_m, score;
  double u_px, v_px, width_px, height_px;
};
struct PedestrianRow {
  double x_m, y_m, range_m, range_sd_m, height_m, probability;
  double u_px, v_px, width_px, height_px;
  std::int64_t obstacle;  ///< -1: none
};

ObstacleRow row_of(const flies::Obstacle& o) {
  return {.x_m = o.x_m,
          .y_m = o.y_m,
          .range_m = o.range_m,
          .range_sd_m = o.range_sd_m,
          .width_m = o.width_m,
          .middle_offset_m = o.middle_offset_m,
          .depth_m = o.depth_m,
          .height_m = o.height_m,
          .ground_z_m = o.ground_z_m,
          .score = o.score,
          .u_px = o.box.u_px,
          .v_px = o.box.v_px,
          .width_px = o.box.width_px,
          .height_px = o.box.height_px};
}
PedestrianRow row_of(const NumberedPedestrian& p) {
  return {.x_m = p.x_m,
          .y_m = p.y_m,
          .range_m = p.range_m,
          .range_sd_m = p.range_sd_m,
          .height_m = p.height_m,
          .probability = p.probability,
          .u_px = p.box.u_px,
          .v_px = p.box.v_px,
          .width_px = p.box.width_px,
          .height_px = p.box.height_px,
          .obstacle = p.obstacle ? static_cast<std::int64_t>(*p.obstacle) : -1};
}

template <class Row, class Item>
py::array rows_of(const std::vector<Item>& items) {
  py::array_t<Row> rows(static_cast<py::ssize_t>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) rows.mutable_data()[i] = row_of(items[i]);
  return rows;
}

py::array_t<float> flies_of(const flies::Detection& detection) {
  const auto& flies = detection.evolved.flies;
  py::array_t<float> points({static_cast<py::ssize_t>(flies.size()), py::ssize_t{4}});
  auto at = points.mutable_unchecked<2>();
  for (std::size_t i = 0; i < flies.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    at(row, 0) = flies.x_m[i];
    at(row, 1) = flies.y_m[i];
    at(row, 2) = flies.z_m[i];
    at(row, 3) = flies.fitness[i];
  }
  return points;
}

/// What Python sees of a detection; the other intermediate results are left behind.
py::tuple state_of(const flies::Detection& d) {
  const auto& plane = d.road.plane;
  const auto& flies = d.evolved.flies;
  return py::make_tuple(d.obstacles, people_of(d), d.scan, d.stage_ms,
                        std::array{plane.height_m, plane.slope, plane.bank}, d.road.found, flies.x_m, flies.y_m,
                        flies.z_m, flies.fitness);
}

flies::Detection detection_of(const py::tuple& state) {
  check_pickle(state, 10);
  flies::Detection d;
  d.obstacles = state[0].cast<std::vector<flies::Obstacle>>();
  const auto people = state[1].cast<std::vector<NumberedPedestrian>>();
  d.pedestrians.assign(people.begin(), people.end());
  d.scan = state[2].cast<flies::Scan>();
  d.stage_ms = state[3].cast<flies::StageTimes_ms>();
  const auto plane = state[4].cast<std::array<double, 3>>();
  d.road.plane = {plane[0], plane[1], plane[2]};
  d.road.found = state[5].cast<bool>();
  auto& flies = d.evolved.flies;
  flies.x_m = state[6].cast<std::vector<float>>();
  flies.y_m = state[7].cast<std::vector<float>>();
  flies.z_m = state[8].cast<std::vector<float>>();
  flies.fitness = state[9].cast<std::vector<float>>();
  for (const auto* values : {&flies.y_m, &flies.z_m, &flies.fitness})
    if (values->size() != flies.size()) throw py::value_error("the pickle has not all numbers of every fly");
  return d;
}

py::dict times_of(const flies::Detection& detection) {
  py::dict times;
  for (std::size_t i = 0; i < flies::kStageCount; ++i)
    times[py::str(std::string(flies::kStageNames[i]))] = detection.stage_ms[i];
  return times;
}

void bind_box(py::module_& module) {
  using flies::ImageBox;
  py::class_<ImageBox>(module, "ImageBox",
                       "A box in the left image, pixels; (u_px, v_px) is its top-left corner. It may reach beyond the "
                       "image.")
      .def_readonly("u_px", &ImageBox::u_px, "Left edge, pixels to the right.")
      .def_readonly("v_px", &ImageBox::v_px, "Upper edge, pixels down.")
      .def_readonly("width_px", &ImageBox::width_px, "Pixels.")
      .def_readonly("height_px", &ImageBox::height_px, "Pixels.")
      .def(pickled<ImageBox, &ImageBox::u_px, &ImageBox::v_px, &ImageBox::width_px, &ImageBox::height_px>())
      .def("__repr__", [](const ImageBox& b) {
        return fmt::format("<flies.ImageBox u {:.1f} v {:.1f}, {:.1f} x {:.1f} px>", b.u_px, b.v_px, b.width_px,
                           b.height_px);
      });
}

void bind_obstacle(py::module_& module) {
  using flies::Obstacle;
  py::class_<Obstacle>(module, "Obstacle",
                       "Something that stands on the ground ahead. Vehicle frame: x forward, y left, metres, origin on "
                       "the ground\nbelow the left camera. Its position is on its near face.")
      .def_readonly("x_m", &Obstacle::x_m, "Forward, metres.")
      .def_readonly("y_m", &Obstacle::y_m, "To the left, metres.")
      .def_readonly("range_m", &Obstacle::range_m, "Horizontal distance, metres.")
      .def_readonly("range_sd_m", &Obstacle::range_sd_m, "Standard deviation of the range, metres.")
      .def_readonly("width_m", &Obstacle::width_m, "Across the line of sight, metres.")
      .def_readonly("middle_offset_m", &Obstacle::middle_offset_m,
                    "Of the middle of its width from its position, across the line of sight, to the left, metres.")
      .def_readonly("depth_m", &Obstacle::depth_m, "Seen along the line of sight, metres; 0: only its face is seen.")
      .def_readonly("height_m", &Obstacle::height_m, "Of its top above the road under it, metres.")
      .def_readonly("ground_z_m", &Obstacle::ground_z_m, "Height of the road under it in the vehicle frame, metres.")
      .def_readonly("score", &Obstacle::score, "Summed fitness of its flies; comparable for equal options.")
      .def_readonly("box", &Obstacle::box, "In the left image: an ImageBox.")
      .def(pickled<Obstacle, &Obstacle::x_m, &Obstacle::y_m, &Obstacle::range_m, &Obstacle::range_sd_m,
                   &Obstacle::width_m, &Obstacle::middle_offset_m, &Obstacle::depth_m, &Obstacle::height_m,
                   &Obstacle::ground_z_m, &Obstacle::score, &Obstacle::box>())
      .def("__repr__", [](const Obstacle& o) {
        return fmt::format("<flies.Obstacle {:.2f} m ahead, {:.2f} m to the left, {:.2f} m wide>", o.x_m, o.y_m,
                           o.width_m);
      });
}

void bind_pedestrian(py::module_& module) {
  using Pedestrian = NumberedPedestrian;
  py::class_<Pedestrian>(module, "Pedestrian", "A person. Vehicle frame as of Obstacle.")
      .def_readonly("x_m", &Pedestrian::x_m, "Forward, metres.")
      .def_readonly("y_m", &Pedestrian::y_m, "To the left, metres.")
      .def_readonly("range_m", &Pedestrian::range_m, "Horizontal distance, metres.")
      .def_readonly("range_sd_m", &Pedestrian::range_sd_m, "Standard deviation of the range, metres.")
      .def_readonly("height_m", &Pedestrian::height_m, "Head above feet, metres.")
      .def_readonly("probability", &Pedestrian::probability, "That this is a person, 0 to 1.")
      .def_readonly("box", &Pedestrian::box, "Tight around the person in the left image: an ImageBox.")
      .def_readonly("obstacle", &Pedestrian::obstacle,
                    "Index of the obstacle that this person is in the list of the Detection; None: of none.")
      .def(pickled<Pedestrian, &Pedestrian::x_m, &Pedestrian::y_m, &Pedestrian::range_m, &Pedestrian::range_sd_m,
                   &Pedestrian::height_m, &Pedestrian::probability, &Pedestrian::box, &Pedestrian::obstacle>())
      .def("__repr__", [](const Pedestrian& p) {
        return fmt::format("<flies.Pedestrian {:.2f} m ahead, {:.2f} m to the left, probability {:.2f}>", p.x_m, p.y_m,
                           p.probability);
      });
}

}  // namespace

void bind_results(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(ObstacleRow, x_m, y_m, range_m, range_sd_m, width_m, middle_offset_m, depth_m, height_m,
                       ground_z_m, score, u_px, v_px, width_px, height_px);
  PYBIND11_NUMPY_DTYPE(PedestrianRow, x_m, y_m, range_m, range_sd_m, height_m, probability, u_px, v_px, width_px,
                       height_px, obstacle);
  bind_box(module);
  bind_obstacle(module);
  bind_pedestrian(module);
  using flies::Detection;
  py::class_<Detection, std::shared_ptr<Detection>>(module, "Detection", "What was found in one pair.")
      .def_readonly("obstacles", &Detection::obstacles,
                    "List of Obstacle, nearest first; made anew at every call, as are the arrays.")
      .def_property_readonly("pedestrians", &people_of, "List of Pedestrian, nearest first.")
      .def_readonly("scan", &Detection::scan, "The nearest obstacle in every direction: a Scan.")
      .def_property_readonly(
          "obstacle_array", [](const Detection& d) { return rows_of<ObstacleRow>(d.obstacles); },
          "The obstacles as a structured array, shape (n,), with all their attributes as float64 fields; the box as\n"
          "u_px, v_px, width_px, height_px.")
      .def_property_readonly(
          "pedestrian_array", [](const Detection& d) { return rows_of<PedestrianRow>(people_of(d)); },
          "The pedestrians as a structured array, shape (n,), as `obstacle_array`, and `obstacle` as int64; -1: of "
          "none.")
      .def_property_readonly("flies", &flies_of,
                             "The flies after the last generation, float32, shape (n, 4): x, y, z in metres, fitness.")
      .def_property_readonly(
          "road",
          [](const Detection& d) {
            return py::make_tuple(d.road.plane.height_m, d.road.plane.slope, d.road.plane.bank);
          },
          "The road as (height, slope, bank): z = height + slope * x + bank * y, metres.")
      .def_property_readonly(
          "road_found", [](const Detection& d) { return d.road.found; },
          "False: `road` is the nominal ground, all zero: too little of it was seen, or it was not asked for.")
      .def_property_readonly(
          "stage_ms", &times_of,
          "Dict of the time that each stage took, milliseconds: road, evolve, scan, concentrate, propose, classify.")
      .def(py::pickle(&state_of, &detection_of))
      .def("__repr__", [](const Detection& d) {
        return fmt::format("<flies.Detection {} obstacles, {} pedestrians>", d.obstacles.size(), d.pedestrians.size());
      });
}
