#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#include "flies/core/gray_view.hpp"
#include "flies/io/gray_image.hpp"

/// The pixels of a numpy array, not copied: uint8, shape (height, width), pixels of a row side by side; rows may lie
/// apart, so that each half of a side-by-side picture will do. The array must outlive the view.
/// @param name of the image in errors
/// @throws InputError when it is something else
flies::GrayView gray_view(const pybind11::object& image, const std::string& name);

/// Both images of a pair.
flies::RectifiedPair pair_view(const pybind11::object& left, const pybind11::object& right);

/// A copy that owns its pixels.
flies::GrayImage owned(const flies::GrayView& view);

/// The image as a numpy array, shape (height, width), that owns it; nothing is copied.
pybind11::array as_array(flies::GrayImage image);
