#pragma once

#include <pybind11/pybind11.h>

/// Each adds the classes and functions of one subject to the module.
void bind_camera(pybind11::module_& module);
void bind_scan(pybind11::module_& module);
void bind_results(pybind11::module_& module);
void bind_tracks(pybind11::module_& module);
void bind_pipeline(pybind11::module_& module);
