#include <fmt/format.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "flies/core/error.hpp"
#include "flies/core/stereo_camera.hpp"
#include "flies/io/calibration.hpp"
#include "flies/io/images.hpp"
#include "flies/io/pair_source.hpp"
#include "images.hpp"
#include "module.hpp"
#include "pickles.hpp"
#include "text.hpp"

namespace py = pybind11;
using py::literals::operator""_a;

namespace {

flies::StereoCamera make_camera(double fx_px, double fy_px, double cx_px, double cy_px, double baseline_m, int width_px,
                                int height_px, std::optional<double> cx_right_px, double camera_height_m,
                                double camera_pitch_rad, double camera_roll_rad) {
  const flies::StereoCamera camera{fx_px,
                                   fy_px,
                                   cx_px,
                                   cx_right_px.value_or(cx_px),
                                   cy_px,
                                   baseline_m,
                                   width_px,
                                   height_px,
                                   {camera_height_m, camera_pitch_rad, camera_roll_rad}};
  flies::check_camera(camera, "camera");
  return camera;
}

void bind_stereo_camera(py::module_& module) {
  using flies::StereoCamera;
  py::class_<StereoCamera>(module, "StereoCamera",
                           "A rectified stereo camera: two ideal pinholes with parallel axes, the right one displaced "
                           "to the right by the baseline.")
      .def(
          py::init(&make_camera), "fx_px"_a, "fy_px"_a, "cx_px"_a, "cy_px"_a, "baseline_m"_a, "width_px"_a = 0,
          "height_px"_a = 0, "cx_right_px"_a = py::none(), "camera_height_m"_a = flies::CameraMount{}.height_m,
          "camera_pitch_rad"_a = 0.0, "camera_roll_rad"_a = 0.0,
          "Focal lengths and principal point in pixels, baseline in metres. `width_px` and `height_px` of the images,\n"
          "both 0 when not known. `cx_right_px` where it differs from `cx_px`. The mount: height of the left camera "
          "above\n"
          "the ground in metres, pitch (positive looks down) and roll (positive leans to the right) in radians.\n"
          "Raises InputError when a number is out of range.")
      .def_readonly("fx_px", &StereoCamera::fx_px, "Focal length along rows, pixels.")
      .def_readonly("fy_px", &StereoCamera::fy_px, "Focal length along columns, pixels.")
      .def_readonly("cx_px", &StereoCamera::cx_px, "Principal point of the left image, column, pixels.")
      .def_readonly("cx_right_px", &StereoCamera::cx_right_px, "Principal point of the right image, column, pixels.")
      .def_readonly("cy_px", &StereoCamera::cy_px, "Principal point of both images, row, pixels.")
      .def_readonly("baseline_m", &StereoCamera::baseline_m, "Distance of the two cameras, metres.")
      .def_readonly("width_px", &StereoCamera::width_px, "Of the images, pixels; 0: not known.")
      .def_readonly("height_px", &StereoCamera::height_px, "Of the images, pixels; 0: not known.")
      .def_property_readonly(
          "camera_height_m", [](const StereoCamera& c) { return c.mount.height_m; },
          "Of the left camera above the ground, metres.")
      .def_property_readonly(
          "camera_pitch_rad", [](const StereoCamera& c) { return c.mount.pitch_rad; },
          "Radians, positive when it looks down.")
      .def_property_readonly(
          "camera_roll_rad", [](const StereoCamera& c) { return c.mount.roll_rad; },
          "Radians, positive when it leans to the right.")
      .def(py::pickle(
          [](const StereoCamera& c) {
            return py::make_tuple(c.fx_px, c.fy_px, c.cx_px, c.cx_right_px, c.cy_px, c.baseline_m, c.width_px,
                                  c.height_px, c.mount.height_m, c.mount.pitch_rad, c.mount.roll_rad);
          },
          [](const py::tuple& state) {
            check_pickle(state, 11);
            const auto number = [&](std::size_t i) { return state[i].cast<double>(); };
            const StereoCamera camera{number(0),
                                      number(1),
                                      number(2),
                                      number(3),
                                      number(4),
                                      number(5),
                                      state[6].cast<int>(),
                                      state[7].cast<int>(),
                                      {number(8), number(9), number(10)}};
            flies::check_camera(camera, "camera");
            return camera;
          }))
      .def("__repr__", [](const StereoCamera& c) {
        return fmt::format("<flies.StereoCamera f {:.1f} px, baseline {:.3f} m, {} x {} px, {:.2f} m above the ground>",
                           c.fx_px, c.baseline_m, c.width_px, c.height_px, c.mount.height_m);
      });
}

py::tuple rectify(const flies::Calibration& calibration, const py::object& left, const py::object& right) {
  const flies::RectifiedPair view = pair_view(left, right);
  flies::GrayPair pair;
  {
    const py::gil_scoped_release release;
    flies::check_pair(view);
    flies::check_camera_fits(calibration.camera, view.left.width_px, view.left.height_px, "calibration");
    pair.left = owned(view.left);
    pair.right = owned(view.right);
    if (calibration.rectifier) pair = calibration.rectifier->rectify(pair);
  }
  return py::make_tuple(as_array(std::move(pair.left)), as_array(std::move(pair.right)));
}

/// Two numbers that Python gives in any sequence.
std::optional<std::array<int, 2>> two_of(const std::optional<std::vector<int>>& numbers, const std::string& source,
                                         const char* field, const char* expected) {
  if (!numbers) return std::nullopt;
  if (numbers->size() != 2)
    throw flies::InputError(source, field, fmt::format("found {} numbers, expected {}", numbers->size(), expected));
  return std::array{(*numbers)[0], (*numbers)[1]};
}

flies::Calibration load_calibration(const PathArgument& path, const PathArgument& right_path,
                                    const std::optional<std::vector<int>>& cameras,
                                    const std::optional<std::pair<py::object, py::object>>& images, int width_px,
                                    int height_px, const std::optional<std::vector<int>>& calibrated_size_px,
                                    std::optional<double> camera_height_m, std::optional<double> camera_pitch_rad,
                                    std::optional<double> camera_roll_rad, bool images_are_raw, bool images_are_resized,
                                    std::optional<double> baseline_m, double disparity_shift_px) {
  flies::CalibrationRequest request;
  request.right_path = right_path.text;
  request.cameras = two_of(cameras, path.text, "cameras", "two: left and right");
  request.width_px = width_px;
  request.height_px = height_px;
  if (images) flies::ask_for_images(request, pair_view(images->first, images->second));
  if (const auto size_px = two_of(calibrated_size_px, path.text, "calibrated size", "two: width and height")) {
    request.calibrated_width_px = (*size_px)[0];
    request.calibrated_height_px = (*size_px)[1];
  }
  request.camera_height_m = camera_height_m;
  request.camera_pitch_rad = camera_pitch_rad;
  request.camera_roll_rad = camera_roll_rad;
  request.images_are_raw = images_are_raw;
  request.images_are_resized = images_are_resized;
  request.baseline_m = baseline_m;
  request.disparity_shift_px = disparity_shift_px;
  const py::gil_scoped_release release;
  return flies::load_calibration(path.text, request);
}

void bind_calibration(py::module_& module) {
  using flies::Calibration;
  auto bound = py::class_<Calibration>(module, "Calibration",
                                       "What was understood of a calibration file; see `load_calibration`.");
  is_its_own_copy(bound);
  cannot_be_pickled(bound, "pickle its camera, or load it anew in each process");
  bound.def_readonly("camera", &Calibration::camera, "The camera after rectification: a StereoCamera.")
      .def_readonly("format", &Calibration::format, "Name of the file's format.")
      .def_property_readonly(
          "notes",
          [](const Calibration& calibration) {
            py::list notes;
            for (const auto& note : calibration.notes) notes.append(sentence_str(note.text));
            return notes;
          },
          "List of sentences on what was ignored or assumed.")
      .def_property_readonly(
          "is_raw", [](const Calibration& c) { return c.rectifier.has_value(); },
          "True: the calibration is of raw images, which must go through `rectify` first.")
      .def("rectify", &rectify, "left"_a, "right"_a,
           "Rectified copies of a pair, (left, right): uint8, shape (height, width). Plain copies when the\n"
           "calibration is of rectified images. Raises InputError when the images are not of the size that the\n"
           "calibration is for; of a rectified one that tells no size, when its principal point is not in them.")
      .def("__repr__", [](const Calibration& c) {
        return fmt::format("<flies.Calibration {}, {}>", c.format, c.rectifier ? "raw images" : "rectified images");
      });
  module.def(
      "load_calibration", &load_calibration, "path"_a, py::kw_only(), "right_path"_a = "", "cameras"_a = py::none(),
      "images"_a = py::none(), "width_px"_a = 0, "height_px"_a = 0, "calibrated_size_px"_a = py::none(),
      "camera_height_m"_a = py::none(), "camera_pitch_rad"_a = py::none(), "camera_roll_rad"_a = py::none(),
      "images_are_raw"_a = false, "images_are_resized"_a = false, "baseline_m"_a = py::none(),
      "disparity_shift_px"_a = 0.0,
      "Reads a calibration: KITTI, OpenCV (rectified or raw), ROS camera_info, Kalibr, EuRoC, ORB-SLAM, ZED,\n"
      "RealSense, DepthAI, Basalt, MATLAB, Middlebury, plain YAML and others, recognised from the content. Paths are\n"
      "str, bytes or os.PathLike.\n\n"
      "- `right_path`: the second file, where the right camera has its own and it is not found beside the first.\n"
      "- `cameras`: (left, right), of a file that may have more than two.\n"
      "- `images`: (left, right), as they were read: tells their size and, other than the next two, whether they were\n"
      "  padded.\n"
      "- `width_px`, `height_px`: of the images, where the file does not say or was made at another scale; 0 and 0:\n"
      "  as the file says.\n"
      "- `calibrated_size_px`: (width, height) that a file without a size is for.\n"
      "- `images_are_raw`: matters where a file is of raw and of rectified images.\n"
      "- `images_are_resized`: whole ones, by any two scales from the file's size to `width_px` and `height_px`.\n"
      "- `baseline_m`, `camera_height_m`, `camera_pitch_rad`, `camera_roll_rad`: overrule the file's.\n"
      "- `disparity_shift_px`: added to every disparity, for cameras that are turned against each other\n"
      "  (`EgoMotion.disparity_shift_px` tells by how much).\n\n"
      "Returns a Calibration. Raises InputError naming file and key.");
}

}  // namespace

void bind_camera(py::module_& module) {
  bind_stereo_camera(module);
  bind_calibration(module);
  module.def(
      "load_pair",
      [](const PathArgument& left, const PathArgument& right) {
        flies::GrayPair pair;
        {
          const py::gil_scoped_release release;
          pair = flies::load_pair(left.text, right.text);
        }
        return py::make_tuple(as_array(std::move(pair.left)), as_array(std::move(pair.right)));
      },
      "left"_a, "right"_a,
      "Reads two images (PNG, JPEG, PGM, PPM, TIFF, WebP, BMP; colour or grey, 8 to 16 bits) as grey:\n"
      "(left, right), uint8, shape (height, width). Raises InputError naming the file.");
  module.def(
      "find_pairs",
      [](const PathArgument& left, const PathArgument& right) {
        const auto found = [&] {
          const py::gil_scoped_release release;
          return flies::find_pairs(left.text, right.text);
        }();
        py::list pairs;
        for (const auto& paths : found) pairs.append(py::make_tuple(path_str(paths.left), path_str(paths.right)));
        return pairs;
      },
      "left"_a, "right"_a,
      "The images of two folders (or two image files) as a list of pairs of paths, (left, right), all str: by equal\n"
      "names, else by times that the names are, else in name order, in which numbers count as numbers. Raises\n"
      "InputError when they do not pair up.");
}
