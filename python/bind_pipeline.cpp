#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "flies/core/error.hpp"
#include "flies/pipeline/engine.hpp"
#include "images.hpp"
#include "module.hpp"
#include "options.hpp"
#include "pickles.hpp"
#include "text.hpp"

namespace py = pybind11;
using py::literals::operator""_a;

namespace {

constexpr const char* kMakeDoc =
    "`preset`: \"default\" (works best on roads), \"paper\" (as published), \"robot\" (low, over floors) or\n"
    "\"handheld\" (carried, any height and tilt). `options`: a mapping such as {\"evolve.flies\": 3000, \"threads\": "
    "2}\n"
    "or {\"evolve\": {\"flies\": 3000}}, names as `options()` lists them; those that begin with `ego.` and `track.` "
    "are\n"
    "of following: a Tracker and an Engine have them, a Detector has not. `model` of people: a name that `flies info`\n"
    "lists or the path of a file; None: the preset's; \"\": nobody is looked for. Raises InputError when the camera "
    "or\n"
    "an option is out of range.";

constexpr const char* kMakeAnother = "make another one, in each process its own";

std::shared_ptr<const flies::PeopleClassifier> classifier_of(const std::string& preset,
                                                             const std::optional<PathArgument>& model) {
  if (model) return model->text.empty() ? nullptr : flies::people_classifier(model->text);
  return flies::preset_classifier(flies::preset_named(preset, "arguments"));
}

/// One call at a time, whatever threads Python has: the others wait, without the interpreter's lock.
template <class T>
struct OneCallAtATime {
  T object;
  std::mutex mutex;

  template <class... Arguments>
  explicit OneCallAtATime(Arguments&&... arguments) : object(std::forward<Arguments>(arguments)...) {}
};
using SharedDetector = OneCallAtATime<flies::Detector>;
using SharedTracker = OneCallAtATime<flies::Tracker>;

void bind_detector(py::module_& module) {
  auto detector = py::class_<SharedDetector>(
      module, "Detector",
      "Finds obstacles and pedestrians in rectified pairs of one camera. Steers by the pair before, so give it\n"
      "the pairs of a sequence in order, and each camera its own. May be called from several threads: one waits\n"
      "for the other.");
  cannot_be_copied_or_pickled(detector, kMakeAnother);
  detector
      .def(py::init([](const flies::StereoCamera& camera, const OptionsMapping& options, const std::string& preset,
                       const std::optional<PathArgument>& model) {
             const auto all = python_options(camera, preset, options, false);
             const py::gil_scoped_release release;
             return std::make_unique<SharedDetector>(camera, all.detector, classifier_of(preset, model));
           }),
           "camera"_a, "options"_a = py::dict(), "preset"_a = "default", "model"_a = py::none(), kMakeDoc)
      .def(
          "process",
          [](SharedDetector& self, const py::object& left, const py::object& right) {
            const flies::RectifiedPair pair = pair_view(left, right);
            const py::gil_scoped_release release;
            const std::lock_guard lock(self.mutex);
            return std::make_shared<flies::Detection>(self.object.process(pair));
          },
          "left"_a, "right"_a,
          "A rectified pair, uint8 arrays of shape (height, width), not copied; rows may lie apart, so halves of a\n"
          "side-by-side picture will do. Other threads run meanwhile; do not write to the images until it returns.\n"
          "Returns a Detection. Raises InputError when the images do not fit the camera or are no pair: one picture\n"
          "twice, or left and right swapped (every 32nd pair is asked).");
}

void bind_tracker(py::module_& module) {
  auto tracker = py::class_<SharedTracker>(
      module, "Tracker",
      "Follows things through the pairs of one camera: its own motion, detection, tracks. May be "
      "called from\nseveral threads: one waits for the other.");
  cannot_be_copied_or_pickled(tracker, kMakeAnother);
  tracker
      .def(py::init([](const flies::StereoCamera& camera, const OptionsMapping& options, const std::string& preset,
                       const std::optional<PathArgument>& model) {
             const auto all = python_options(camera, preset, options, true);
             const py::gil_scoped_release release;
             return std::make_unique<SharedTracker>(camera, all.detector, all.following, classifier_of(preset, model));
           }),
           "camera"_a, "options"_a = py::dict(), "preset"_a = "default", "model"_a = py::none(), kMakeDoc)
      .def(
          "process",
          [](SharedTracker& self, const py::object& left, const py::object& right, double time_s) {
            const flies::RectifiedPair pair = pair_view(left, right);
            const py::gil_scoped_release release;
            const std::lock_guard lock(self.mutex);
            return std::make_shared<flies::Tracking>(self.object.process(pair, time_s));
          },
          "left"_a, "right"_a, "time_s"_a,
          "A rectified pair as for Detector.process, and its time in seconds, later than that of the one before.\n"
          "Returns a Tracking. Raises InputError as Detector.process, and when time does not advance.");
}

std::shared_ptr<flies::Tracking> tracking_of(const std::shared_ptr<flies::Snapshot>& snapshot) {
  return {snapshot, &snapshot->tracking};
}

void bind_snapshot(py::module_& module) {
  using flies::Snapshot;
  auto snapshot = py::class_<Snapshot, std::shared_ptr<Snapshot>>(
      module, "Snapshot", "What an engine knows at a moment; but for its age it never changes.");
  is_its_own_copy(snapshot);
  cannot_be_pickled(snapshot, "pickle its tracking and what else is wanted of it");
  snapshot.def_property_readonly("tracking", &tracking_of, "After the newest pair that could be used: a Tracking.")
      .def_readonly("number", &Snapshot::number, "Counts the pairs that are done, from 1; 0: none is yet.")
      .def_readonly("submitted", &Snapshot::submitted, "Pairs that had been submitted when it was made.")
      .def_readonly("dropped", &Snapshot::dropped, "Those of them that were overtaken by a newer one.")
      .def_readonly("latency_ms", &Snapshot::latency_ms,
                    "From `submit` of the newest pair that is done to its result, milliseconds.")
      .def_property_readonly(
          "error", [](const Snapshot& s) { return sentence_str(s.error); },
          "Why the newest pair that is done could not be used; \"\": it could.")
      .def_property_readonly(
          "age_s", &Snapshot::age_s,
          "Time since the pair of `tracking` was submitted, seconds; NaN as long as no pair could be "
          "used.")
      .def("__repr__", [](const Snapshot& s) {
        return fmt::format("<flies.Snapshot {}, {} tracks, {} of {} pairs dropped>", s.number, s.tracking.tracks.size(),
                           s.dropped, s.submitted);
      });
}

std::chrono::milliseconds timeout_of(double timeout_s) {
  constexpr double kMost_s = 1e6;
  if (!(timeout_s >= 0.0 && timeout_s <= kMost_s))
    throw flies::InputError("wait", "timeout_s", fmt::format("found {}, expected 0..{}", timeout_s, kMost_s));
  return std::chrono::milliseconds(std::llround(timeout_s * 1e3));
}

/// As `Engine::wait`, in short pieces, between which Python may say that it was interrupted (Ctrl-C). Called with the
/// interpreter's lock, which is not held during a piece.
std::shared_ptr<flies::Snapshot> wait(const flies::Engine& engine, std::int64_t after, double timeout_s) {
  constexpr std::chrono::milliseconds kPiece{50};
  if (after < 0) throw flies::InputError("wait", "after", fmt::format("found {}, expected 0 or more", after));
  const auto number = static_cast<std::uint64_t>(after);
  const auto end = std::chrono::steady_clock::now() + timeout_of(timeout_s);
  while (true) {
    std::shared_ptr<const flies::Snapshot> newest;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    {
      const py::gil_scoped_release release;
      newest = engine.wait(number, std::clamp(left, std::chrono::milliseconds::zero(), kPiece));
    }
    if (newest->number > number || left <= kPiece) return std::const_pointer_cast<flies::Snapshot>(newest);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

/// An engine ends after the pair that is being worked on: other threads of Python run meanwhile.
struct EndWithoutLock {
  void operator()(flies::Engine* engine) const {
    const py::gil_scoped_release release;
    delete engine;
  }
};
using OwnedEngine = std::unique_ptr<flies::Engine, EndWithoutLock>;

void bind_engine(py::module_& module) {
  using flies::Engine;
  using flies::Snapshot;
  auto bound = py::class_<Engine, OwnedEngine>(
      module, "Engine",
      "A tracker with a thread of its own, for a living camera: pairs go in whenever they come, the newest result is\n"
      "read whenever it is wanted. A pair that was overtaken before its turn is dropped and counted. All members may "
      "be\n"
      "called from any threads.");
  cannot_be_copied_or_pickled(bound, kMakeAnother);
  bound
      .def(py::init([](const flies::StereoCamera& camera, const OptionsMapping& options, const std::string& preset,
                       const std::optional<PathArgument>& model) {
             const auto all = python_options(camera, preset, options, true);
             const py::gil_scoped_release release;
             return OwnedEngine(new Engine(camera, all.detector, all.following, classifier_of(preset, model)));
           }),
           "camera"_a, "options"_a = py::dict(), "preset"_a = "default", "model"_a = py::none(), kMakeDoc)
      .def(
          "submit",
          [](Engine& self, const py::object& left, const py::object& right, double time_s) {
            const flies::RectifiedPair pair = pair_view(left, right);
            const py::gil_scoped_release release;
            self.submit(pair, time_s);
          },
          "left"_a, "right"_a, "time_s"_a,
          "Hands over a rectified pair as for Tracker.process; it is copied, and the call returns at once. Raises\n"
          "InputError when images do not fit the camera or time does not advance; what is found wrong later is the\n"
          "`error` of a Snapshot.")
      .def(
          "snapshot", [](const Engine& self) { return std::const_pointer_cast<Snapshot>(self.snapshot()); },
          "The newest result, at once: a Snapshot.")
      .def("wait", &wait, "after"_a, "timeout_s"_a = 1.0,
           "Waits for a result newer than number `after`, up to `timeout_s` seconds, or until Ctrl-C. Returns it, or\n"
           "the newest there is when the time is over. Raises InputError for a number below 0 or a time that is\n"
           "not between 0 and a million seconds.");
}

template <class Options>
void list_into(py::list& list, const Options& options) {
  for (const auto& option : flies::list_options(options))
    list.append(py::make_tuple(option.path, option.value, option.allowed, option.meaning));
}

}  // namespace

void bind_pipeline(py::module_& module) {
  bind_detector(module);
  bind_tracker(module);
  bind_snapshot(module);
  bind_engine(module);
  module.def(
      "options",
      [](const std::string& preset) {
        py::list list;
        list_into(list, flies::preset_options(flies::preset_named(preset, "arguments")));
        list_into(list, flies::TrackerOptions{});
        return list;
      },
      "preset"_a = "default",
      "Every option of the method and of following: a list of (name, value, what is allowed, meaning), all str. Values "
      "are\n"
      "those of the preset, before a Detector, Tracker or Engine fits it to its camera.");
}
