#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "flies/core/options.hpp"
#include "flies/pipeline/tracker.hpp"
#include "module.hpp"
#include "pickles.hpp"

namespace py = pybind11;

namespace {

/// A row of the array: all attributes of a track, under their names; the class as `is_person`, the box by its four
/// numbers.
struct TrackRow {
  std::uint64_t id;
  bool is_person;
  double probability, person_log_odds, x_m, y_m, vx_mps, vy_mps, moving_probability;
  flies::Covariance4 covariance;
  double width_m, height_m, age_s, unseen_s;
  int sightings;
  double u_px, v_px, width_px, height_px;
};

TrackRow row_of(const flies::Track& t) {
  return {.id = t.id,
          .is_person = t.kind == flies::TrackClass::person,
          .probability = t.probability,
          .person_log_odds = t.person_log_odds,
          .x_m = t.state.x_m,
          .y_m = t.state.y_m,
          .vx_mps = t.velocity.vx_mps,
          .vy_mps = t.velocity.vy_mps,
          .moving_probability = t.velocity.moving_probability,
          .covariance = t.state.covariance,
          .width_m = t.width_m,
          .height_m = t.height_m,
          .age_s = t.age_s,
          .unseen_s = t.unseen_s,
          .sightings = t.sightings,
          .u_px = t.box.u_px,
          .v_px = t.box.v_px,
          .width_px = t.box.width_px,
          .height_px = t.box.height_px};
}

py::array rows_of(const std::vector<flies::Track>& tracks) {
  py::array_t<TrackRow> rows(static_cast<py::ssize_t>(tracks.size()));
  for (std::size_t i = 0; i < tracks.size(); ++i) rows.mutable_data()[i] = row_of(tracks[i]);
  return rows;
}

py::array_t<double> covariance_of(const flies::Track& track) {
  py::array_t<double> matrix({4, 4});
  auto at = matrix.mutable_unchecked<2>();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      at(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(j)) = track.state.covariance[i][j];
  return matrix;
}

py::tuple state_of(const flies::Track& t) {
  const auto& s = t.state;
  return py::make_tuple(t.id, t.kind == flies::TrackClass::person, t.person_log_odds, t.probability,
                        std::array{s.x_m, s.y_m, s.vx_mps, s.vy_mps}, s.covariance,
                        std::array{t.velocity.vx_mps, t.velocity.vy_mps, t.velocity.moving_probability}, t.width_m,
                        t.height_m, t.age_s, t.unseen_s, t.sightings, t.moving_sightings, t.box);
}

flies::Track track_of(const py::tuple& state) {
  check_pickle(state, 14);
  flies::Track t;
  t.id = state[0].cast<std::uint64_t>();
  t.kind = state[1].cast<bool>() ? flies::TrackClass::person : flies::TrackClass::other;
  t.person_log_odds = state[2].cast<double>();
  t.probability = state[3].cast<double>();
  const auto at = state[4].cast<std::array<double, 4>>();
  t.state = {at[0], at[1], at[2], at[3], state[5].cast<flies::Covariance4>()};
  const auto velocity = state[6].cast<std::array<double, 3>>();
  t.velocity = {velocity[0], velocity[1], velocity[2]};
  t.width_m = state[7].cast<double>();
  t.height_m = state[8].cast<double>();
  t.age_s = state[9].cast<double>();
  t.unseen_s = state[10].cast<double>();
  t.sightings = state[11].cast<int>();
  t.moving_sightings = state[12].cast<int>();
  t.box = state[13].cast<flies::ImageBox>();
  return t;
}

void bind_track(py::module_& module) {
  using flies::Track;
  py::class_<Track>(module, "Track",
                    "A thing followed over time. Positions in the vehicle frame of now, velocities over ground in its "
                    "axes.")
      .def_readonly("id", &Track::id, "Counts from 1, never given twice.")
      .def_property_readonly(
          "kind", [](const Track& t) { return std::string(flies::enum_name(t.kind)); }, "\"person\" or \"other\".")
      .def_readonly("probability", &Track::probability, "That it exists, 0 to 1.")
      .def_readonly("person_log_odds", &Track::person_log_odds,
                    "Evidence of all pairs that it is a person: a log odds, above 0 for.")
      .def_property_readonly(
          "x_m", [](const Track& t) { return t.state.x_m; }, "Forward, metres.")
      .def_property_readonly(
          "y_m", [](const Track& t) { return t.state.y_m; }, "To the left, metres.")
      .def_property_readonly(
          "vx_mps", [](const Track& t) { return t.velocity.vx_mps; },
          "Velocity over ground, forward, metres a second; 0 until it has seemed to move for several pairs.")
      .def_property_readonly(
          "vy_mps", [](const Track& t) { return t.velocity.vy_mps; },
          "Velocity over ground, to the left, metres a second.")
      .def_property_readonly(
          "moving_probability", [](const Track& t) { return t.velocity.moving_probability; }, "That it moves, 0 to 1.")
      .def_property_readonly("covariance", &covariance_of, "Of x, y, vx, vy, shape (4, 4), in m and m/s.")
      .def_readonly("width_m", &Track::width_m, "Across the line of sight, metres.")
      .def_readonly("height_m", &Track::height_m, "Of its top above the road, metres.")
      .def_readonly("age_s", &Track::age_s, "Since it was first seen, seconds.")
      .def_readonly("unseen_s", &Track::unseen_s, "Since it was last seen, seconds; 0: in this pair.")
      .def_readonly("sightings", &Track::sightings, "Pairs in which it was seen.")
      .def_readonly("box", &Track::box, "In the left image, seen or predicted: an ImageBox.")
      .def(py::pickle(&state_of, &track_of))
      .def("__repr__", [](const Track& t) {
        return fmt::format("<flies.Track {} {}, {:.2f} m ahead, {:.2f} m to the left>", t.id, flies::enum_name(t.kind),
                           t.state.x_m, t.state.y_m);
      });
}

std::optional<double> shift_px(const flies::EgoMotion& ego) {
  return ego.disparity_shift ? std::optional(ego.disparity_shift->px) : std::nullopt;
}

void bind_ego_motion(py::module_& module) {
  using flies::EgoMotion;
  py::class_<EgoMotion>(module, "EgoMotion", "How the camera moved over ground since the pair before.")
      .def_readonly("is_known", &EgoMotion::is_known, "False: the first pair, or lost; velocities are zero then.")
      .def_readonly("dt_s", &EgoMotion::dt_s, "Time since the pair before, seconds.")
      .def_readonly("vx_mps", &EgoMotion::vx_mps, "Forward, metres a second.")
      .def_readonly("vy_mps", &EgoMotion::vy_mps, "To the left, metres a second.")
      .def_readonly("yaw_rate_rps", &EgoMotion::yaw_rate_rps, "Radians a second, positive to the left.")
      .def_property_readonly("disparity_shift_px", &shift_px,
                             "All disparities are too small by this, by how corners moved since the pair before; "
                             "negative: too large. None\n"
                             "where they do not tell. One pair may be wrong by 2 px: take the median of ten and more.")
      .def(py::pickle(
          [](const EgoMotion& e) {
            return py::make_tuple(e.is_known, e.dt_s, e.vx_mps, e.vy_mps, e.yaw_rate_rps, shift_px(e));
          },
          [](const py::tuple& state) {
            check_pickle(state, 6);
            EgoMotion e;
            e.is_known = state[0].cast<bool>();
            e.dt_s = state[1].cast<double>();
            e.vx_mps = state[2].cast<double>();
            e.vy_mps = state[3].cast<double>();
            e.yaw_rate_rps = state[4].cast<double>();
            if (!state[5].is_none()) e.disparity_shift = {state[5].cast<double>(), 0.0};
            return e;
          }))
      .def("__repr__", [](const EgoMotion& e) {
        return e.is_known ? fmt::format("<flies.EgoMotion {:.2f} m/s forward, {:.2f} m/s to the left, {:.3f} rad/s>",
                                        e.vx_mps, e.vy_mps, e.yaw_rate_rps)
                          : std::string("<flies.EgoMotion not known>");
      });
}

}  // namespace

void bind_tracks(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(TrackRow, id, is_person, probability, person_log_odds, x_m, y_m, vx_mps, vy_mps,
                       moving_probability, covariance, width_m, height_m, age_s, unseen_s, sightings, u_px, v_px,
                       width_px, height_px);
  bind_track(module);
  bind_ego_motion(module);
  using flies::Tracking;
  py::class_<Tracking, std::shared_ptr<Tracking>>(module, "Tracking", "What is known after one pair of a sequence.")
      .def_readonly("time_s", &Tracking::time_s, "Of the pair, seconds.")
      .def_readonly("ego", &Tracking::ego, "The camera's motion: an EgoMotion.")
      .def_readonly("tracks", &Tracking::tracks, "List of Track, nearest first.")
      .def_property_readonly(
          "track_array", [](const Tracking& t) { return rows_of(t.tracks); },
          "The tracks as a structured array, shape (n,), with all their attributes as fields: `is_person` for `kind`,\n"
          "the box as u_px, v_px, width_px, height_px, the covariance of shape (n, 4, 4).")
      .def_readonly("detection", &Tracking::detection, "Of this pair alone: a Detection.")
      .def_readonly(
          "ego_ms", &Tracking::ego_ms,
          "Time that the camera's motion took, milliseconds; with several threads the detection begins beside it.")
      .def_readonly("track_ms", &Tracking::track_ms, "Time that the tracks took, milliseconds.")
      .def(pickled<Tracking, &Tracking::time_s, &Tracking::ego, &Tracking::tracks, &Tracking::detection,
                   &Tracking::ego_ms, &Tracking::track_ms>())
      .def("__repr__", [](const Tracking& t) {
        return fmt::format("<flies.Tracking at {:.3f} s, {} tracks>", t.time_s, t.tracks.size());
      });
}
