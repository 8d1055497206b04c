#pragma once

#include <cstddef>
#include <vector>

#include "flies/core/stereo_camera.hpp"

namespace flies {

/// One fly: a hypothesis that a visible surface passes through this point of the vehicle frame.
struct Fly {
  Point3 point;
  float fitness = 0.0F;
};

/// The flies, a structure of arrays: one entry per fly in each, all of equal length.
struct Population {
  std::vector<float> x_m, y_m, z_m;  ///< vehicle frame
  std::vector<float> fitness;        ///< >= 0 once scored; its scale depends on the fitness function

  std::size_t size() const { return x_m.size(); }
  bool empty() const { return x_m.empty(); }

  void resize(std::size_t count) {
    x_m.resize(count);
    y_m.resize(count);
    z_m.resize(count);
    fitness.resize(count);
  }

  Point3 point(std::size_t i) const { return {x_m[i], y_m[i], z_m[i]}; }
  Fly fly(std::size_t i) const { return {point(i), fitness[i]}; }

  void set(std::size_t i, const Point3& point, float fly_fitness = 0.0F) {
    x_m[i] = static_cast<float>(point.x_m);
    y_m[i] = static_cast<float>(point.y_m);
    z_m[i] = static_cast<float>(point.z_m);
    fitness[i] = fly_fitness;
  }
  void push_back(const Point3& point, float fly_fitness = 0.0F) {
    resize(size() + 1);
    set(size() - 1, point, fly_fitness);
  }
};

/// Flies by their image coordinates, a structure of arrays: what evolution works on. Disparity is u_left - u_right.
struct ImagePopulation {
  std::vector<float> u_px, v_px;  ///< left projection
  std::vector<float> disparity_px;
  std::vector<float> fitness;  ///< >= 0 once scored

  std::size_t size() const { return u_px.size(); }

  void resize(std::size_t count) {
    u_px.resize(count);
    v_px.resize(count);
    disparity_px.resize(count);
    fitness.resize(count);
  }

  StereoPoint point(std::size_t i) const { return {u_px[i], v_px[i], disparity_px[i]}; }

  void set(std::size_t i, const StereoPoint& point, float fly_fitness = 0.0F) {
    u_px[i] = static_cast<float>(point.u_px);
    v_px[i] = static_cast<float>(point.v_px);
    disparity_px[i] = static_cast<float>(point.disparity_px);
    fitness[i] = fly_fitness;
  }
};

}  // namespace flies
