#include "images.hpp"

#include <fmt/format.h>

#include <cstring>
#include <memory>
#include <utility>

#include "flies/core/error.hpp"

namespace py = pybind11;

namespace {

std::string shape_text(const py::array& image) { return py::str(image.attr("shape")); }

/// A mask that hides something would be passed over.
void refuse_masked(const py::object& image, const std::string& name) {
  const py::module_ masked = py::module_::import("numpy.ma");
  if (py::isinstance(image, masked.attr("MaskedArray")) && py::bool_(masked.attr("is_masked")(image)))
    throw flies::InputError(name, "mask", "hides pixels, expected an array without one: what is to be seen there?");
}

}  // namespace

flies::GrayView gray_view(const py::object& image, const std::string& name) {
  if (!py::isinstance<py::array>(image))
    throw flies::InputError(name, "type",
                            fmt::format("found {}, expected a numpy array of uint8",
                                        std::string(py::str(py::type::of(image).attr("__name__")))));
  refuse_masked(image, name);
  const auto array = py::reinterpret_borrow<py::array>(image);
  if (!py::isinstance<py::array_t<std::uint8_t>>(array))
    throw flies::InputError(name, "dtype",
                            fmt::format("found {}, expected uint8", std::string(py::str(array.dtype()))));
  if (array.ndim() != 2)
    throw flies::InputError(name, "shape",
                            fmt::format("found {}, expected (height, width): a grey image", shape_text(array)));
  constexpr py::ssize_t kMost = 100000;
  if (array.shape(0) > kMost || array.shape(1) > kMost)
    throw flies::InputError(name, "shape", fmt::format("found {}, expected at most 100000 each", shape_text(array)));
  if (array.size() > 0 &&
      ((array.shape(1) > 1 && array.strides(1) != 1) || (array.shape(0) > 1 && array.strides(0) < array.shape(1))))
    throw flies::InputError(name, "strides",
                            "pixels of a row are not side by side, or rows run backwards; numpy.ascontiguousarray "
                            "makes a copy that will do");
  return {static_cast<const std::uint8_t*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.shape(0) > 1 ? array.strides(0) : array.shape(1)};
}

flies::RectifiedPair pair_view(const py::object& left, const py::object& right) {
  return {gray_view(left, "left image"), gray_view(right, "right image")};
}

flies::GrayImage owned(const flies::GrayView& view) {
  flies::GrayImage image{view.width_px, view.height_px, {}};
  const auto width = static_cast<std::size_t>(view.width_px);
  image.pixels.resize(width * static_cast<std::size_t>(view.height_px));
  for (int v = 0; v < view.height_px; ++v)
    std::memcpy(image.pixels.data() + static_cast<std::size_t>(v) * width, view.row(v), width);
  return image;
}

py::array as_array(flies::GrayImage image) {
  auto* owner = new flies::GrayImage(std::move(image));
  const py::capsule capsule(owner, [](void* pointer) { delete static_cast<flies::GrayImage*>(pointer); });
  return py::array(py::dtype::of<std::uint8_t>(), {owner->height_px, owner->width_px}, {owner->width_px, 1},
                   owner->pixels.data(), capsule);
}
