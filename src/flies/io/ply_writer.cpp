#include <fmt/format.h>

#include <cmath>

#include "flies/io/fitness_color.hpp"
#include "flies/io/writers.hpp"

namespace flies {

std::string ply_text(const Population& flies) {
  const double full_scale = full_scale_fitness(flies.fitness);
  std::string vertices;
  std::size_t count = 0;
  for (std::size_t i = 0; i < flies.size(); ++i) {
    if (!std::isfinite(flies.x_m[i]) || !std::isfinite(flies.y_m[i]) || !std::isfinite(flies.z_m[i])) continue;
    const float fitness = std::isfinite(flies.fitness[i]) ? flies.fitness[i] : 0.0F;
    const auto [red, green, blue] = fitness_color(full_scale > 0.0 ? fitness / full_scale : 0.0);
    vertices += fmt::format("{:.4f} {:.4f} {:.4f} {} {} {} {:.6g}\n", flies.x_m[i], flies.y_m[i], flies.z_m[i], red,
                            green, blue, fitness);
    ++count;
  }
  return fmt::format(
             "ply\nformat ascii 1.0\n"
             "comment flies in the vehicle frame: x forward, y left, z up, metres; {:.6g} and more is red\n"
             "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float fitness\nend_header\n",
             full_scale, count) +
         vertices;
}

}  // namespace flies
