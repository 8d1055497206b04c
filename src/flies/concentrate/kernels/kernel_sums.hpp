#pragma once

#include <cstddef>
#include <cstdint>

namespace flies::kernels {

/// Weighted points of the image, a structure of arrays, of which some runs are meant. Run r are the points from
/// `starts[r * stride]` up to, and without, `starts[r * stride + cells]`. `kPadding` entries after the last point can
/// be read.
struct PointRuns {
  const double* u_px = nullptr;
  const double* v_px = nullptr;
  const double* weight = nullptr;
  const std::uint32_t* starts = nullptr;
  std::size_t stride = 0, cells = 0;
  std::size_t runs = 0;

  /// Calls `use` with the index and the coordinates of each point of the runs.
  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t run = 0; run < runs; ++run)
      for (std::size_t i = starts[run * stride]; i < starts[run * stride + cells]; ++i) use(i, u_px[i], v_px[i]);
  }
};
constexpr std::size_t kPadding = 8;

/// The Gaussian kernel is cut off where it has fallen to exp(-4.5) = 1 %: what lies beyond moves a mean by less than
/// a tenth of a pixel and would make every sample point visit every fly.
constexpr double kKernelReach = 3.0;

/// Sums over points p_i of weight f_i around p of w_i = f_i exp(-|p_i - p|^2 / 2h^2).
struct KernelSums {
  double weight = 0.0;              ///< of w_i
  double du_px = 0.0, dv_px = 0.0;  ///< of w_i (p_i - p)
};

/// Sums within `kKernelReach` bandwidths of (u, v). The same numbers on every CPU; the exponential is within 3e-14 of
/// its value.
KernelSums sum_kernel(const PointRuns& points, double u_px, double v_px, double bandwidth_px);

}  // namespace flies::kernels
